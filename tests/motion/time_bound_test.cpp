// The measure itself, where the least time is known.
#include "tests/motion/time_bound.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

double bound_of(const Trajectory& trajectory, const AxisLimits& limits) {
  TimeBound bound(limits, trajectory.start);
  for (const Setpoint& setpoint : trajectory.setpoints) bound.take(setpoint);
  return bound.seconds();
}

/// A planner that uses `part` of the acceleration.
Planner planner_with(double part, AxisLimits limits = reference_limits()) {
  limits.max_acceleration *= part;
  return Planner({.limits = limits}, {});
}

}  // namespace

TEST_CASE("The bound of lines between stops is that of trapezoids", "[MOT-1][JOB-5]") {
  // 100 mm at 100 mm/s with 500 mm/s²: 100/100 + 100/500 = 1.2 s a side, however slowly driven.
  for (const double part : {1.0, 0.5, 0.1}) {
    CAPTURE(part);
    Planner planner = planner_with(part);
    for (const Position& corner : {xyz(100, 0), xyz(100, 100), xyz(0, 100), xyz(0, 0)}) {
      REQUIRE(planner.add_line(corner, feed_of(100)));
    }
    CHECK(bound_of(draw_all(planner), reference_limits()) == Approx(4.8).epsilon(1e-5));
  }
}

TEST_CASE("The bound obeys the feed and the diagonal of the limits", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  // 30 mm at a feed of 20 mm/s: 30/20 + 20/500 = 1.54 s.
  REQUIRE(planner.add_line(xyz(30, 0), feed_of(20)));
  CHECK(bound_of(draw_all(planner), reference_limits()) == Approx(1.54).epsilon(1e-5));
  // A rapid along the diagonal of X and Y: 100/100 + 100/500 s, whatever its length in space.
  REQUIRE(planner.add_line(xyz(130, 100), rapid()));
  CHECK(bound_of(draw_all(planner), reference_limits()) == Approx(1.2).epsilon(1e-5));
}

TEST_CASE("The bound does not stop where the path does not ask for it", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  MoveOptions stopping = feed_of(100);
  stopping.stop_at_end = true;
  REQUIRE(planner.add_line(xyz(50, 0), stopping));
  REQUIRE(planner.add_line(xyz(100, 0), stopping));
  const Trajectory trajectory = draw_all(planner);
  // Driven: twice 50/100 + 100/500 = 1.4 s.
  CHECK(trajectory.duration() == Approx(1.4).epsilon(1e-5));
  CHECK(bound_of(trajectory, reference_limits()) == Approx(1.2).epsilon(1e-5));
}

TEST_CASE("The bound of curves depends on the path and not on how it was driven", "[MOT-1]") {
  // The circle of 100 mm of the reference figures: 3.340 s.
  for (const double part : {1.0, 0.5, 0.3}) {
    CAPTURE(part);
    Planner planner = planner_with(part);
    REQUIRE(planner.add_arc({xyz(0, 0), Plane::xy, 50.0, 0.0, 1}, feed_of(100)));
    CHECK(bound_of(draw_all(planner), reference_limits()) == Approx(3.34).epsilon(5e-4));
  }
}

TEST_CASE("The bound of a wave that acceleration limits goes with its square root", "[MOT-1]") {
  // y = 5 sin(x/5) at limits of velocity that nothing reaches. Driven with a part of the
  // acceleration, the optimal motion only goes slower everywhere, by the root of the part.
  AxisLimits limits = reference_limits();
  limits.max_velocity = Position::filled(1e4);
  std::vector<double> bounds;
  for (const double part : {1.0, 0.4}) {
    Planner planner = planner_with(part, limits);
    MoveOptions options = feed_of(1e4);
    options.tolerance = 0.001;
    for (int i = 1; i <= 8000; ++i) {
      const double x = 2.0 * std::numbers::pi * 5.0 * i / 400.0;
      REQUIRE(planner.add_line(xyz(x, 5.0 * std::sin(x / 5.0)), options));
    }
    const Trajectory trajectory = draw_all(planner);
    bounds.push_back(bound_of(trajectory, limits));
    CHECK(trajectory.duration() / bounds.back() == Approx(1.0 / std::sqrt(part)).epsilon(0.02));
    CHECK(trajectory.duration() > 0.9995 * bounds.back());
  }
  CHECK(bounds[0] == Approx(bounds[1]).epsilon(2e-3));
}

}  // namespace cnc::motion::test
