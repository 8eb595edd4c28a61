#include "motion/jog.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "motion/extents.h"
#include "tests/motion/dice.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

constexpr double kTick = 0.001;

JogPlanner jog_at(double x) { return {reference_limits(), kTick, xyz(x, 0)}; }

Trajectory draw(JogPlanner& jog, int count) {
  Trajectory trajectory{jog.position(), {}};
  for (int i = 0; i < count; ++i) {
    const auto setpoint = jog.next();
    if (!setpoint) break;
    trajectory.setpoints.push_back(*setpoint);
  }
  return trajectory;
}

}  // namespace

TEST_CASE("Jog reaches its speed at the axis' acceleration and stops at it", "[MAN-1]") {
  JogPlanner jog = jog_at(0);
  REQUIRE(jog.set_velocity(Axis::X, 50).has_value());
  draw(jog, 100);  // 50/500 = 0.1 s
  CHECK(jog.velocity()[Axis::X] == Approx(50.0));
  CHECK(jog.position()[Axis::X] == Approx(2.5));
  draw(jog, 100);
  CHECK(jog.position()[Axis::X] == Approx(7.5));
  jog.stop();
  const Trajectory braking = draw(jog, 1000);
  CHECK(braking.setpoints.size() == 100);
  CHECK(jog.position()[Axis::X] == Approx(10.0));
  CHECK(jog.standing());
  CHECK_FALSE(jog.next().has_value());
}

TEST_CASE("Jog stops exactly at a soft limit and does not leave it", "[MAN-1]") {
  JogPlanner jog = jog_at(0);
  jog.set_travel(Axis::X, {-3.0, 12.345});
  REQUIRE(jog.set_velocity(Axis::X, 80).has_value());
  draw(jog, 10'000);
  CHECK(jog.position()[Axis::X] == 12.345);
  CHECK(jog.standing());
  REQUIRE(jog.set_velocity(Axis::X, -80).has_value());
  draw(jog, 10'000);
  CHECK(jog.position()[Axis::X] == -3.0);
}

TEST_CASE("Outside of its travel an axis can only be jogged back", "[MAN-1]") {
  JogPlanner jog = jog_at(20);
  jog.set_travel(Axis::X, {0.0, 10.0});
  REQUIRE(jog.set_velocity(Axis::X, 10).has_value());
  CHECK_FALSE(jog.next().has_value());
  REQUIRE(jog.set_velocity(Axis::X, -10).has_value());
  draw(jog, 10'000);
  CHECK(jog.position()[Axis::X] == 0.0);
}

TEST_CASE("A step jog ends exactly at its distance in the time of the trapezoid", "[MAN-2]") {
  for (const double distance : {0.0001, 0.001, 0.01, 0.1, 1.0, 12.3}) {
    JogPlanner jog = jog_at(1);
    REQUIRE(jog.move_by(Axis::X, distance, 100).has_value());
    const Trajectory trajectory = draw(jog, 100'000);
    CHECK(jog.position()[Axis::X] == 1 + distance);
    CHECK(jog.standing());
    // Triangle below 20 mm: 2 sqrt(d / a), and the ticks cost two of them at most.
    const double least = 2.0 * std::sqrt(distance / 500.0);
    CHECK(trajectory.duration() >= least * (1.0 - 1e-9));
    CHECK(trajectory.duration() <= least + 2.0 * kTick + 1e-9);
  }
}

TEST_CASE("Step jogs add up while the axis is still on its way", "[MAN-2]") {
  JogPlanner jog = jog_at(0);
  for (int i = 0; i < 5; ++i) {
    REQUIRE(jog.move_by(Axis::X, 1.0, 100).has_value());
    draw(jog, 7);
  }
  draw(jog, 10'000);
  CHECK(jog.position()[Axis::X] == 5.0);
}

TEST_CASE("Orders that void ticks have carried out are carried out again",
          "[MAN-1][MAN-2][LNK-8]") {
  JogPlanner jog = jog_at(0);
  REQUIRE(jog.move_by(Axis::X, 2.0, 100).has_value());
  draw(jog, 20);
  const Position position = jog.position();
  const Position velocity = jog.velocity();
  draw(jog, 10'000);
  REQUIRE(jog.position()[Axis::X] == 2.0);
  jog.go_back(position, velocity, {});
  CHECK_FALSE(jog.standing());
  REQUIRE(jog.move_by(Axis::X, 3.0, 100).has_value());
  CHECK_FALSE(jog.follows_velocity(Axis::X));
  draw(jog, 10'000);
  CHECK(jog.position()[Axis::X] == 5.0);
  REQUIRE(jog.set_velocity(Axis::X, 1.0).has_value());
  CHECK(jog.follows_velocity(Axis::X));
}

TEST_CASE("Jog values that are not usable are refused", "[MAN-1][MAN-2]") {
  AxisLimits limits = reference_limits();
  limits.max_velocity[Axis::B] = 0.0;
  JogPlanner jog(limits, kTick, {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(jog.set_velocity(Axis::X, nan).has_value());
  CHECK_FALSE(jog.move_by(Axis::X, nan, 10).has_value());
  CHECK_FALSE(jog.move_by(Axis::X, 1, 0).has_value());
  CHECK_FALSE(jog.move_to(Axis::X, 1, -5).has_value());
  CHECK_FALSE(jog.set_velocity(Axis::B, 1).has_value());
  CHECK_FALSE(jog.next().has_value());
}

TEST_CASE("Whatever the keys do, jogging keeps limits, travel and exact ends", "[MAN-1][MAN-2]") {
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    std::mt19937 engine(seed);
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(engine);
    };
    AxisLimits limits = reference_limits();
    limits.max_acceleration[Axis::X] = between(10, 3000);
    if (seed % 2 == 0) limits.max_jerk = Position::filled(std::exp(between(5.0, 13.0)));
    JogPlanner jog(limits, between(0.0005, 0.02), {});
    for (const Axis axis : kLinearAxes) jog.set_travel(axis, {-30.0, 40.0});
    Trajectory trajectory{{}, {}};
    double target = 0.0;
    for (int i = 0; i < 40; ++i) {
      const Axis axis = kLinearAxes[static_cast<std::size_t>(i % 3)];
      target = between(-60, 60);
      if (i % 5 < 3) {
        REQUIRE(jog.set_velocity(axis, between(-150, 150)).has_value());
      } else {
        REQUIRE(jog.move_to(axis, target, between(0.1, 150)).has_value());
      }
      const Trajectory part = draw(jog, static_cast<int>(between(0, 200)));
      trajectory.setpoints.insert(trajectory.setpoints.end(), part.setpoints.begin(),
                                  part.setpoints.end());
    }
    target = between(-30, 40);
    jog.stop();
    REQUIRE(jog.move_to(Axis::X, target, 100).has_value());
    const Trajectory last = draw(jog, 1'000'000);
    trajectory.setpoints.insert(trajectory.setpoints.end(), last.setpoints.begin(),
                                last.setpoints.end());
    CHECK(jog.position()[Axis::X] == target);
    CHECK(jog.standing());
    const Usage usage = usage_of(trajectory, limits);
    CHECK(usage.velocity <= 1.0 + 1e-6);
    CHECK(usage.acceleration <= 1.0 + 1e-6);
    CHECK(usage.jerk <= 1.0 + 1e-6);
    Extents reached{trajectory.start, trajectory.start};
    for (const Setpoint& setpoint : trajectory.setpoints) reached.include(setpoint.position);
    for (const Axis axis : kLinearAxes) {
      CHECK(reached.min[axis] >= -30.0);
      CHECK(reached.max[axis] <= 40.0);
    }
  }
}

TEST_CASE("Orders at any tick: limits and travel hold within every tick, targets are met exactly",
          "[MAN-1][MAN-2]") {
  for (std::uint32_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    AxisLimits limits = reference_limits();
    limits.max_acceleration[Axis::X] = dice.scale(10.0, 10'000.0);
    limits.max_velocity[Axis::X] = dice.scale(0.5, 300.0);
    if (seed % 4 == 0) limits.max_jerk[Axis::X] = dice.scale(1000.0, 1e6);
    JogPlanner jog(limits, dice.scale(0.0005, 0.02), {});
    const TravelRange travel{-dice.scale(0.001, 100.0), dice.scale(0.001, 100.0)};
    jog.set_travel(Axis::X, travel);
    Position position;
    Position velocity;
    const auto tick = [&] {
      const auto setpoint = jog.next();
      if (!setpoint) return false;
      const AxisCubic cubic = cubic_of(Axis::X, position, velocity, *setpoint);
      REQUIRE(cubic.fastest() <= limits.max_velocity[Axis::X] * (1.0 + 1e-9));
      const double hardest =
          std::max(std::abs(cubic.start_acceleration()), std::abs(cubic.end_acceleration()));
      // Positions have a last digit of 1e-14: 6/h² of it.
      REQUIRE(hardest <= limits.max_acceleration[Axis::X] * (1.0 + 1e-6) +
                             6e-14 / (cubic.duration * cubic.duration));
      if (const double most = limits.max_jerk[Axis::X]; most > 0.0) {
        REQUIRE(std::abs(cubic.jerk()) <=
                most * (1.0 + 1e-6) + 12e-14 / std::pow(cubic.duration, 3));
      }
      for (int part = 0; part <= 20; ++part) {
        const double x = cubic.position(cubic.duration * part / 20.0);
        REQUIRE(x >= travel.min - 1e-9);
        REQUIRE(x <= travel.max + 1e-9);
      }
      position = setpoint->position;
      velocity = setpoint->velocity;
      return true;
    };
    const double speed = limits.max_velocity[Axis::X];
    const double way = 0.3 * (travel.max - travel.min);
    for (int i = 0; i < 500; ++i) {
      switch (dice.pick(6)) {
        case 0:
          REQUIRE(jog.set_velocity(Axis::X, dice.between(-2.0, 2.0) * speed));
          break;
        case 1:
          REQUIRE(jog.move_by(Axis::X, dice.between(-way, way), dice.scale(0.01, 1.0) * speed));
          break;
        case 2:
          REQUIRE(jog.move_to(Axis::X, dice.between(-150.0, 150.0), speed));
          break;
        case 3:
          jog.stop();
          break;
        default:
          break;
      }
      for (int wait = dice.pick(12); wait > 0; --wait) tick();
    }
    // Steps that add up from wherever it is going.
    jog.stop();
    while (tick()) {
    }
    double target = position[Axis::X];
    for (int i = 0; i < 5; ++i) {
      const double step = dice.between(-way, way);
      target = std::min(std::max(target + step, travel.min), travel.max);
      REQUIRE(jog.move_by(Axis::X, step, speed));
      for (int wait = dice.pick(3); wait > 0; --wait) tick();
    }
    while (tick()) {
    }
    REQUIRE(position[Axis::X] == target);
    REQUIRE(velocity[Axis::X] == 0.0);
  }
}

}  // namespace cnc::motion::test
