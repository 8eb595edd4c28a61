// Whole programs within limits of jerk: times, limits, path, prediction.
#include "motion/jerk_profile.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/motion/dice.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

constexpr double kJerk = 20'000.0;

PlannerSettings jerk_settings(double jerk = kJerk) {
  PlannerSettings settings = reference_settings();
  settings.limits.max_jerk = Position::filled(jerk);
  return settings;
}

void require_limits(const Trajectory& driven, const AxisLimits& limits) {
  const Usage usage = usage_of(driven, limits);
  CHECK(usage.velocity <= 1.0);
  CHECK(usage.acceleration <= 1.0);
  CHECK(usage.jerk <= 1.0);
}

/// The lowest speed at the ends of setpoints while X is between these.
double slowest_between(const Trajectory& driven, double from, double to) {
  double slowest = 1e9;
  for (const Setpoint& setpoint : driven.setpoints) {
    const double x = setpoint.position[Axis::X];
    if (x > from && x < to) slowest = std::min(slowest, norm(setpoint.velocity));
  }
  return slowest;
}

double predicted_time(const PlannerSettings& settings, const std::function<void(Planner&)>& fill) {
  Planner planner(settings, {});
  fill(planner);
  double time = 0.0;
  while (const auto stretch = planner.skip()) time += stretch->duration;
  return time;
}

/// Moves of all kinds; the same for each planner.
void add_program(Planner& planner, Path& path, std::uint32_t seed) {
  Dice dice(seed);
  const double size = dice.scale(0.02, 30.0);
  const double tolerance = dice.chance(0.3) ? 0.0 : dice.scale(0.002, 0.2);
  double heading = 0.0;
  for (int i = 0; i < 60; ++i) {
    MoveOptions options = dice.chance(0.1) ? rapid() : feed_of(dice.scale(10.0, 150.0));
    options.tolerance = tolerance;
    options.stop_at_end = dice.chance(0.05);
    if (dice.chance(0.1)) {
      add_arc(planner, path, random_arc(dice, path.end(), size), options);
      continue;
    }
    heading += dice.between(-1.0, 1.0);
    const double length = dice.scale(size * 0.02, size);
    Position end = path.end();
    end[Axis::X] += length * std::cos(heading);
    end[Axis::Y] += length * std::sin(heading);
    end[Axis::Z] += length * dice.between(-0.3, 0.3);
    if (dice.chance(0.1)) end[Axis::A] += dice.between(-20.0, 20.0);
    if (dice.chance(0.03)) end = path.end(), end[Axis::B] += dice.between(-90.0, 90.0);
    add_line(planner, path, end, options);
  }
}

}  // namespace

TEST_CASE("A rapid takes the seven phases of jerk, acceleration and velocity", "[MOT-3]") {
  Planner planner(jerk_settings(), {});
  REQUIRE(planner.add_line(xyz(100, 0), rapid()).has_value());
  const Trajectory driven = draw_all(planner);
  // 100 mm at 100 mm/s, and a ramp of v/a + a/j = 0.2 + 0.025 s.
  CHECK(driven.duration() >= 1.225);
  CHECK(driven.duration() <= 1.225 * 1.01);
  CHECK(driven.end() == xyz(100, 0));
  require_limits(driven, jerk_settings().limits);
}

TEST_CASE("Programs of all kinds keep limits of jerk, tolerance and exact end, as predicted",
          "[MOT-3][MOT-1][MOT-5]") {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Dice dice(seed + 1000);
    PlannerSettings settings = jerk_settings(dice.scale(2000.0, 200'000.0));
    if (dice.chance(0.5)) settings.limits.max_jerk[Axis::Y] = dice.scale(2000.0, 200'000.0);
    if (dice.chance(0.3)) settings.limits.max_jerk[Axis::Z] = 0.0;
    if (dice.chance(0.5)) settings.limits.max_acceleration[Axis::X] = dice.scale(50.0, 5000.0);
    Path path({});
    Planner planner(settings, {});
    add_program(planner, path, seed);
    const Trajectory driven = draw_all(planner);
    CHECK(planner.idle());
    CHECK(driven.end() == path.end());
    require_limits(driven, settings.limits);
    const double predicted = predicted_time(settings, [&](Planner& other) {
      Path ignored({});
      add_program(other, ignored, seed);
    });
    // A plan made a setpoint later differs in its last digits.
    CHECK(predicted == Approx(driven.duration()).epsilon(1e-9).margin(1e-3));
  }
}

TEST_CASE("With limits of jerk the path stays within its tolerance, or a micrometre", "[MOT-3]") {
  for (const double tolerance : {0.0, 0.02, 0.2}) {
    CAPTURE(tolerance);
    Path path({});
    Planner planner(jerk_settings(), {});
    MoveOptions options = feed_of(80);
    options.tolerance = tolerance;
    add_line(planner, path, xyz(10, 0), options);
    add_arc(planner, path, {.end = xyz(20, 10), .first_centre = 10, .second_centre = 10}, options);
    for (int i = 1; i <= 60; ++i) {
      add_line(planner, path, xyz(20 + 0.5 * i, 10 + 3.0 * std::sin(0.2 * i)), options);
    }
    const Trajectory driven = draw_all(planner);
    CHECK(path.distance_both_ways(driven) <= std::max(tolerance, 1e-3) + 2e-4);
    require_limits(driven, jerk_settings().limits);
  }
}

TEST_CASE("An exact path is passed at corners below the LAF angle, and stops at others",
          "[MOT-3][GCO-6]") {
  const auto drive = [](double angle) {
    Planner planner(jerk_settings(), {});
    MoveOptions options = feed_of(50);
    options.laf_angle = 5.0;
    const double phi = angle * 3.14159265358979 / 180.0;
    REQUIRE(planner.add_line(xyz(20, 0), options).has_value());
    REQUIRE(
        planner.add_line(xyz(20 + 20 * std::cos(phi), 20 * std::sin(phi)), options).has_value());
    return draw_all(planner);
  };
  CHECK(slowest_between(drive(4.0), 15.0, 25.0) > 1.0);
  CHECK(slowest_between(drive(6.0), 15.0, 25.0) == 0.0);
}

TEST_CASE("A line into a tangent arc is not stopped at", "[MOT-3]") {
  Planner planner(jerk_settings(), {});
  REQUIRE(planner.add_line(xyz(20, 0), feed_of(50)).has_value());
  REQUIRE(
      planner.add_arc({.end = xyz(30, 10), .first_centre = 20, .second_centre = 10}, feed_of(50))
          .has_value());
  const double slowest = slowest_between(draw_all(planner), 15.0, 25.0);
  // (J L R)^(1/3) with the 0.49 mm on which a clothoid leaves line and circle of 10 mm by 1 µm, at
  // 20,000 mm/s³, is 46 mm/s.
  CHECK(slowest > 25.0);
}

TEST_CASE("An override of 0 holds and any other goes on, with limits of jerk", "[MOT-3][MAN-8]") {
  Planner planner(jerk_settings(), {});
  Path path({});
  add_line(planner, path, xyz(50, 0), feed_of(60));
  Trajectory driven{{}, {}};
  const auto draw = [&](int count) {
    for (; count > 0; --count) {
      const auto setpoint = planner.next();
      if (!setpoint) return;
      driven.setpoints.push_back(*setpoint);
    }
  };
  draw(60);
  planner.set_overrides(0.0, 1.0);
  draw(10'000);
  CHECK_FALSE(planner.idle());
  CHECK(driven.setpoints.back().velocity == Position{});
  planner.set_overrides(0.3, 1.0);
  draw(10'000);
  CHECK(planner.idle());
  CHECK(driven.end() == path.end());
  require_limits(driven, jerk_settings().limits);
}

TEST_CASE("A hold amid curves finds its plan at once", "[MOT-3][MAN-9][LNK-8]") {
  // One that finds none is tried again some cells later, and the motion goes on until then.
  PlannerSettings settings = jerk_settings();
  settings.most_taken_back = 4096;
  for (double until = 1.07; until < 1.12; until += 0.001) {
    CAPTURE(until);
    Planner planner(settings, {});
    MoveOptions options = feed_of(50);
    options.tolerance = 0.01;
    double time = 0.0;
    std::size_t waiting = 0;
    for (int i = 1; time < until;) {
      for (; i <= 2000 && !planner.full(); ++i)
        REQUIRE(planner.add_line(xyz(0.1 * i, 20.0 + 15.0 * std::sin(0.02 * i)), options));
      time += planner.next().value().duration;
      if (time > until - 0.24) ++waiting;
    }
    REQUIRE(planner.take_back(waiting));
    planner.hold();
    planner.confirm_take_back();
    // From 50 mm/s at 500 mm/s², 0.025 s to build that up and the same to undo what it was doing.
    CHECK(draw_all(planner).duration() < 0.1 + 2.0 * 0.025 + 0.02);
  }
}

TEST_CASE("A helix of very many turns is driven without room for all of it", "[MOT-3]") {
  Planner planner(jerk_settings(), {});
  REQUIRE(planner
              .add_arc({.end = xyz(0, 0, 50), .first_centre = 2, .second_centre = 0, .turns = 80},
                       feed_of(100))
              .has_value());
  const Trajectory driven = draw_all(planner);
  CHECK(driven.end() == xyz(0, 0, 50));
  // 80 · 2π · 2 mm; 500 mm/s² on a circle of 2 mm are 31.6 mm/s, and more where two axes share
  // them.
  const double steady = 80.0 * 2.0 * 3.14159265 * 2.0 / std::sqrt(500.0 * 2.0);
  CHECK(driven.duration() == Approx(steady).epsilon(0.1));
  require_limits(driven, jerk_settings().limits);
}

TEST_CASE("Tiny and very long moves keep limits of jerk", "[MOT-3]") {
  const double length = GENERATE(1e-5, 1e-3, 0.1, 1e4);
  CAPTURE(length);
  Planner planner(jerk_settings(), {});
  REQUIRE(planner.add_line(xyz(length, 0), feed_of(100)).has_value());
  REQUIRE(planner.add_line(xyz(length, length), feed_of(100)).has_value());
  double time = 0.0;
  Position at;
  Position velocity;
  while (const auto setpoint = planner.next()) {
    const AxisCubic x = cubic_of(Axis::X, at, velocity, *setpoint);
    // Positions of 1e4 have a last digit of 2e-12, seen over the cube of the duration.
    const double rounding = 1e-16 * length * 24.0 / std::pow(setpoint->duration, 3);
    REQUIRE(std::abs(x.jerk()) <= kJerk * (1.0 + 1e-3) + rounding);
    at = setpoint->position;
    velocity = setpoint->velocity;
    time += setpoint->duration;
  }
  CHECK(at == xyz(length, length));
  CHECK(planner.idle());
  CHECK(time >= 2.0 * length / 100.0);
}

TEST_CASE("Chords of a micrometre keep limits of jerk, however high", "[MOT-3]") {
  // At 50 mm/s each takes 20 microseconds, and the jerk may leap at every end.
  const auto [ratio, tolerance] =
      GENERATE(table<double, double>({{40.0, 0.0}, {330.0, 0.0}, {330.0, 0.01}, {900.0, 0.0}}));
  CAPTURE(ratio, tolerance);
  const PlannerSettings settings = jerk_settings(ratio * 500.0);
  Planner planner(settings, {});
  MoveOptions options = feed_of(50);
  options.tolerance = tolerance;
  Trajectory driven{{}, {}};
  for (int i = 1; i <= 1500; ++i) {
    const double x = 1e-3 * i;
    REQUIRE(planner.add_line(xyz(x, 0.2 * std::sin(3.0 * x)), options));
    while (planner.full()) driven.setpoints.push_back(planner.next().value());
  }
  while (const auto setpoint = planner.next()) driven.setpoints.push_back(*setpoint);
  CHECK(planner.idle());
  require_limits(driven, settings.limits);
}

TEST_CASE("A feed of next to nothing is driven, in as few steps as its time asks for", "[MOT-3]") {
  // mm/s: F0.5 and what no clock would see.
  const double feed = GENERATE(0.5 / 60.0, 1e-4, 2e-6, 1e-7);
  const double jerk = GENERATE(20'000.0, 1e6, 1e9);
  CAPTURE(feed, jerk);
  Planner planner(jerk_settings(jerk), {});
  REQUIRE(planner.add_line(xyz(0.02, 0), feed_of(feed)));
  REQUIRE(planner.add_line(xyz(0.04, 0), feed_of(100)));
  double time = 0.0;
  double x = 0.0;
  for (int i = 0; i < 300; ++i) {
    const auto setpoint = planner.next();
    REQUIRE(setpoint.has_value());
    REQUIRE(setpoint->position[Axis::X] >= x);
    x = setpoint->position[Axis::X];
    time += setpoint->duration;
  }
  CHECK(time > 300 * 0.001);
  CHECK(x <= feed * time);
  // Within a few cells, of which none is shorter than a picometre.
  planner.hold();
  time = 0.0;
  while (const auto setpoint = planner.next()) time += setpoint->duration;
  CHECK(time < 1.0);
  CHECK_FALSE(planner.idle());
  CHECK(planner.clear());
}

TEST_CASE("A way of a few picometres that a hold has left is driven", "[MOT-3][MAN-9]") {
  const double left = GENERATE(1.5e-9, 5e-9, 2e-8, 1e-7);
  CAPTURE(left);
  JerkPlan plan(jerk_limits(jerk_settings().limits));
  PathInterval interval;
  interval.length = left;
  interval.first = xyz(1, 0);
  interval.feed = 100.0;
  plan.append(interval);
  plan.stop_at_end();
  REQUIRE(plan.due());
  REQUIRE(plan.plan());
  plan.advance(1.0);
  CHECK(plan.idle());
}

TEST_CASE("No axis builds its acceleration up in less than a millisecond", "[MOT-3]") {
  // 500 mm/s² in 1 ms are 500,000 mm/s³, of which a plan uses 99 %.
  const auto [wanted, planned] =
      GENERATE(table<double, double>({{20'000.0, 19'800.0},
                                      {1e9, 495'000.0},
                                      {0.0, 495'000.0},
                                      {std::numeric_limits<double>::infinity(), 495'000.0},
                                      {std::numeric_limits<double>::quiet_NaN(), 495'000.0}}));
  CAPTURE(wanted);
  CHECK(jerk_limits(jerk_settings(wanted).limits).jerk[Axis::X] == Approx(planned));
}

TEST_CASE("A rotary move keeps its feed although rounding left something for X", "[MOT-3][GCO-5]") {
  const double residue = GENERATE(0.0, 1e-15, 5e-7);
  CAPTURE(residue);
  Planner planner(jerk_settings(), {});
  Position end = xyz(residue, 0);
  end[Axis::A] = 90.0;
  REQUIRE(planner.add_line(end, feed_of(30.0)));
  (void)planner.next();
  // 90 degrees at 30 a second, and less than half a second to speed up and to slow down.
  CHECK(planner.queued_time() >= 2.9);
  CHECK(planner.queued_time() <= 3.5);
  const double driven = draw_all(planner).duration();
  CHECK(driven >= 2.9);
  CHECK(driven <= 3.5);
}

TEST_CASE("The time of rotary moves that are not planned yet is known", "[MOT-3]") {
  Planner planner(jerk_settings(), {});
  Position end;
  for (int i = 0; i < 10; ++i) {
    end[Axis::A] += 90.0;
    MoveOptions options = feed_of(30.0);
    options.stop_at_end = true;
    REQUIRE(planner.add_line(end, options));
  }
  (void)planner.next();
  const double left = planner.queued_time();
  CHECK(left >= 29.0);
  CHECK(left <= 35.0);
}

}  // namespace cnc::motion::test
