#include "motion/compensation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/motion/dice.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

CompensationSettings settings_with_backlash(double play) {
  CompensationSettings settings{.joint_limits = reference_limits()};
  for (const Axis axis : kLinearAxes) settings.backlash[axis] = play;
  return settings;
}

Planner planner_for(const Compensation& compensation) {
  PlannerSettings settings = reference_settings();
  settings.limits = compensation.machine_limits();
  return {settings, Position{}};
}

/// What the motors do: every setpoint, and what remains to be added where the machine stands.
Trajectory motors_of(Compensation& compensation, const Trajectory& machine) {
  Trajectory motors{compensation.motors_at(machine.start), {}};
  for (const Setpoint& setpoint : machine.setpoints) {
    motors.setpoints.push_back(compensation.apply(setpoint));
    if (setpoint.velocity != Position{}) continue;
    while (const auto piece = compensation.settle()) motors.setpoints.push_back(*piece);
  }
  return motors;
}

void check_limits(const Trajectory& motors, const AxisLimits& limits) {
  const Usage usage = usage_of(motors, limits);
  CHECK(usage.velocity <= 1.0 + 1e-6);
  CHECK(usage.acceleration <= 1.0 + 1e-6);
}

std::shared_ptr<const HeightSurface> wave(double size, double height) {
  std::vector<double> heights;
  constexpr int kCount = 20;
  for (int row = 0; row < kCount; ++row)
    for (int column = 0; column < kCount; ++column)
      heights.push_back(height * std::sin(0.9 * column) * std::cos(0.7 * row));
  return std::make_shared<HeightSurface>(0.0, 0.0, size, kCount, kCount, heights);
}

}  // namespace

TEST_CASE("Without anything to compensate setpoints pass unchanged", "[MOT-5]") {
  Compensation compensation({.joint_limits = reference_limits()});
  CHECK(compensation.machine_limits().max_velocity == reference_limits().max_velocity);
  CHECK(compensation.machine_limits().max_acceleration == reference_limits().max_acceleration);
  Planner planner = planner_for(compensation);
  REQUIRE(planner.add_line(xyz(10, 20, -3), feed_of(50)));
  const Trajectory machine = draw_all(planner);
  const Trajectory motors = motors_of(compensation, machine);
  REQUIRE(motors.setpoints.size() == machine.setpoints.size());
  for (std::size_t i = 0; i < machine.setpoints.size(); ++i) {
    CHECK(motors.setpoints[i].position == machine.setpoints[i].position);
    CHECK(motors.setpoints[i].velocity == machine.setpoints[i].velocity);
  }
}

TEST_CASE("A circle with backlash: play is taken up behind each reversal, within the limits",
          "[MOT-5]") {
  constexpr double kPlay = 0.05;
  constexpr double kRadius = 20.0;
  Compensation compensation(settings_with_backlash(kPlay));
  Planner planner = planner_for(compensation);
  const ArcShape circle{xyz(0, 0), Plane::xy, kRadius, 0.0, -2};
  REQUIRE(planner.add_arc(circle, feed_of(30)));
  const Trajectory machine = draw_all(planner);
  const Trajectory motors = motors_of(compensation, machine);
  check_limits(motors, reference_limits());

  // 2 sqrt(b / a) with 3/5 of the quarter of 500 mm/s² that is kept for it.
  const double taking_up = 2.0 * std::sqrt(kPlay / (0.6 * 0.25 * 500.0));
  const double reversals = std::numbers::pi * kRadius / 30.0;  // s between two of an axis
  REQUIRE(taking_up < 0.06);
  double full[2] = {0.0, 0.0};
  double under_way = 0.0;
  double time = 0.0;
  for (std::size_t i = 0; i < machine.setpoints.size(); ++i) {
    const double h = machine.setpoints[i].duration;
    time += h;
    const double added =
        motors.setpoints[i].position[Axis::X] - machine.setpoints[i].position[Axis::X];
    const double direction = machine.setpoints[i].velocity[Axis::X];
    REQUIRE(added <= 1e-12);
    REQUIRE(added >= -kPlay - 1e-12);
    if (added == Approx(direction < 0.0 ? -kPlay : 0.0).margin(1e-12))
      full[direction < 0.0 ? 1 : 0] += h;
    else
      under_way += h;
  }
  // X turns at 0 (the start: none), then at each end of the diameter: 3 times in two turns.
  CHECK(under_way <= 3.0 * (taking_up + 0.015));
  CHECK(under_way >= 3.0 * (taking_up - 0.015));
  CHECK(full[0] == Approx(2.0 * reversals).margin(0.4));
  CHECK(full[1] == Approx(2.0 * reversals).margin(0.4));
}

TEST_CASE("A move that is too short for taking up the play ends when it is taken up", "[MOT-5]") {
  Compensation compensation(settings_with_backlash(0.1));
  Planner planner = planner_for(compensation);
  REQUIRE(planner.add_line(xyz(1, 0), rapid()));
  MoveOptions back = rapid();
  back.stop_at_end = true;
  REQUIRE(planner.add_line(xyz(0.99, 0), back));
  const Trajectory motors = motors_of(compensation, draw_all(planner));
  check_limits(motors, reference_limits());
  CHECK(motors.end()[Axis::X] == Approx(0.89).margin(1e-12));
  CHECK(compensation.machine_at(motors.end())[Axis::X] == Approx(0.99).margin(1e-12));
  CHECK(motors.setpoints.back().velocity == Position{});
}

TEST_CASE("Rounding of a standing axis is no reversal", "[MOT-5]") {
  Compensation compensation(settings_with_backlash(0.1));
  for (int i = 0; i < 1000; ++i) {
    Setpoint setpoint;
    setpoint.duration = 0.005;
    setpoint.position = xyz(0.1 * i, (i % 2) * -1e-7);
    CHECK(compensation.apply(setpoint).position[Axis::Y] == setpoint.position[Axis::Y]);
  }
}

TEST_CASE("Z follows a wavy height map to 1 µm at full feed", "[MOT-5][LNG-5]") {
  Compensation compensation({.joint_limits = reference_limits()});
  const auto surface = wave(10.0, 0.2);
  compensation.use_surface(surface);
  while (compensation.settle()) {
  }
  Planner planner = planner_for(compensation);
  REQUIRE(planner.add_line(xyz(5, 5, -1), feed_of(60)));
  REQUIRE(planner.add_line(xyz(180, 140, -1), feed_of(60)));
  REQUIRE(planner.add_line(xyz(-40, 90, -1), rapid()));  // beyond the map too
  const Trajectory machine = draw_all(planner);
  const Trajectory motors = motors_of(compensation, machine);
  check_limits(motors, reference_limits());

  double worst = 0.0;
  Position machine_at = machine.start;
  Position machine_velocity;
  Position motors_at = motors.start;
  Position motors_velocity;
  for (std::size_t i = 0; i < machine.setpoints.size(); ++i) {
    const auto place = [&](Axis axis, double t) {
      return cubic_of(axis, machine_at, machine_velocity, machine.setpoints[i]).position(t);
    };
    const AxisCubic z = cubic_of(Axis::Z, motors_at, motors_velocity, motors.setpoints[i]);
    for (double t = 0.0; t <= z.duration; t += 0.0005) {
      const double wanted =
          place(Axis::Z, t) + surface->at(place(Axis::X, t), place(Axis::Y, t)).height;
      worst = std::max(worst, std::abs(z.position(t) - wanted));
    }
    machine_at = machine.setpoints[i].position;
    machine_velocity = machine.setpoints[i].velocity;
    motors_at = motors.setpoints[i].position;
    motors_velocity = motors.setpoints[i].velocity;
  }
  CHECK(worst < 0.001);
}

TEST_CASE("A height map is entered and left on a ramp while the machine stands", "[MOT-5][LNG-5]") {
  Compensation compensation({.joint_limits = reference_limits()});
  const std::vector<double> heights(9, 0.7);
  Trajectory motors{{}, {}};
  const auto settle = [&] {
    while (const auto piece = compensation.settle()) motors.setpoints.push_back(*piece);
  };
  compensation.use_surface(std::make_shared<HeightSurface>(0, 0, 10, 3, 3, heights));
  settle();
  CHECK(motors.end()[Axis::Z] == Approx(0.7));
  CHECK(compensation.machine_at(motors.end())[Axis::Z] == Approx(0.0).margin(1e-12));
  compensation.use_surface(nullptr);
  settle();
  CHECK(motors.end()[Axis::Z] == Approx(0.0).margin(1e-12));
  check_limits(motors, reference_limits());
}

TEST_CASE("Everything at once keeps every motor's limits and can be undone", "[MOT-5]") {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    CompensationSettings settings{.joint_limits = reference_limits()};
    for (const Axis axis : kLinearAxes) {
      settings.joint_limits.max_velocity[axis] = dice.scale(10, 300);
      settings.joint_limits.max_acceleration[axis] = dice.scale(50, 5000);
      if (dice.chance(0.7)) settings.backlash[axis] = dice.scale(0.001, 0.2);
      if (dice.chance(0.3)) continue;
      std::vector<config::PitchPoint> table{{-300, -300.1}};
      while (table.back().machine < 400) {
        const double way = dice.scale(1.0, 100.0);
        table.push_back(
            {table.back().machine + way, table.back().calibrated + way * dice.between(0.99, 1.01)});
      }
      settings.pitch[axis] = PitchCurve(table);
    }
    settings.joint_limits.max_velocity[Axis::A] = 50.0;
    settings.joint_limits.max_acceleration[Axis::A] = 300.0;
    settings.motor_axes[Axis::A] = Axis::X;
    settings.backlash[Axis::A] = 0.02;
    settings.backlash_share = dice.between(0.05, 0.5);
    Compensation compensation(settings);
    Trajectory motors{compensation.motors_at({}), {}};
    if (dice.chance(0.7)) compensation.use_surface(wave(dice.scale(4, 20), dice.scale(0.01, 0.2)));
    while (const auto piece = compensation.settle()) motors.setpoints.push_back(*piece);

    Planner planner = planner_for(compensation);
    for (int i = 0; i < 30; ++i) {
      const Position end = xyz(dice.between(-10, 60), dice.between(-10, 60), dice.between(-5, 0));
      MoveOptions options = dice.chance(0.3) ? rapid() : feed_of(dice.scale(20.0, 300.0));
      options.stop_at_end = dice.chance(0.3);
      options.tolerance = dice.chance(0.3) ? 0.05 : 0.0;
      REQUIRE(planner.add_line(end, options));
    }
    const Trajectory machine = draw_all(planner);
    const Trajectory moving = motors_of(compensation, machine);
    motors.setpoints.insert(motors.setpoints.end(), moving.setpoints.begin(),
                            moving.setpoints.end());
    check_limits(motors, settings.joint_limits);
    const Position back = compensation.machine_at(motors.end());
    for (const Axis axis : kLinearAxes)
      REQUIRE(back[axis] == Approx(machine.end()[axis]).margin(1e-9));
    const Position again = compensation.motors_at(machine.end());
    for (const Axis axis : kLinearAxes)
      REQUIRE(again[axis] == Approx(motors.end()[axis]).margin(1e-9));
  }
}

TEST_CASE("Going back to an earlier state gives the same motors again", "[MOT-5][JOB-8]") {
  Compensation compensation(settings_with_backlash(0.05));
  Planner planner = planner_for(compensation);
  REQUIRE(planner.add_line(xyz(5, 3), feed_of(50)));
  REQUIRE(planner.add_line(xyz(-5, 8), feed_of(50)));
  const Trajectory machine = draw_all(planner);
  const std::size_t half = machine.setpoints.size() / 2;
  for (std::size_t i = 0; i < half; ++i)
    static_cast<void>(compensation.apply(machine.setpoints[i]));
  const Compensation::State kept = compensation.state();
  std::vector<Position> first;
  for (std::size_t i = half; i < machine.setpoints.size(); ++i)
    first.push_back(compensation.apply(machine.setpoints[i]).position);
  compensation.restore(kept);
  for (std::size_t i = half; i < machine.setpoints.size(); ++i)
    CHECK(compensation.apply(machine.setpoints[i]).position == first[i - half]);
}

}  // namespace cnc::motion::test
