#include "motion/junction.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

/// Two lines of 10 mm with an angle of `degrees` between them.
Trajectory drive_corner(double degrees, const PlannerSettings& settings, const MoveOptions& first) {
  const double angle = degrees * std::numbers::pi / 180.0;
  Planner planner(settings, {});
  Path path({});
  add_line(planner, path, xyz(10, 0), first);
  add_line(planner, path, xyz(10 + 10 * std::cos(angle), 10 * std::sin(angle)), feed_of(100));
  Trajectory trajectory = draw_all(planner);
  CHECK(path.deviation_of(trajectory, 0.0001) < 1.01 * kExactPathTolerance);
  return trajectory;
}

int stops_of(const Trajectory& trajectory) {
  int stops = 0;
  for (const Setpoint& setpoint : trajectory.setpoints) {
    if (setpoint.velocity == Position{}) ++stops;
  }
  return stops;
}

}  // namespace

TEST_CASE("A corner below the LAF angle is passed, one above is stopped at", "[MOT-1][MOT-2]") {
  const PlannerSettings settings = reference_settings();  // LAF angle 1°
  CHECK(stops_of(drive_corner(0.99, settings, feed_of(100))) == 1);
  CHECK(stops_of(drive_corner(1.01, settings, feed_of(100))) == 2);
  CHECK(stops_of(drive_corner(180.0, settings, feed_of(100))) == 2);
}

TEST_CASE("Exact stop and the angle of a move overrule the LAF angle", "[MOT-1][MOT-2]") {
  MoveOptions stop = feed_of(100);
  stop.stop_at_end = true;
  CHECK(stops_of(drive_corner(0.0, reference_settings(), stop)) == 2);
  MoveOptions strict = feed_of(100);
  strict.laf_angle = 0.5;
  CHECK(stops_of(drive_corner(0.9, reference_settings(), strict)) == 2);
  PlannerSettings generous = reference_settings();
  generous.laf_angle = 30.0;
  CHECK(stops_of(drive_corner(29.0, generous, feed_of(100))) == 1);
}

TEST_CASE("A line that touches an arc is passed without a blend", "[MOT-1][MOT-4]") {
  const Line line({}, xyz(10, 0));
  const auto arc = make_arc(xyz(10, 0), {xyz(20, 10), Plane::xy, 10.0, 10.0, 1});
  REQUIRE(arc.has_value());
  CHECK(judge_junction(line, 10.0, *arc, {1e-4, 1.0, 4.0, 4.0}).kind == JunctionKind::smooth);
}

TEST_CASE("Blends at arcs stay within the tolerance of both curves", "[MOT-2][MOT-4]") {
  // The arc begins 0.5° off the direction of the line, as rounded programs have it.
  for (const double radius : {0.05, 1.0, 20.0, 1000.0}) {
    const double off = 0.5 * std::numbers::pi / 180.0;
    Path path({});
    Planner planner(reference_settings(), {});
    add_line(planner, path, xyz(10, 0), feed_of(100));
    const double cx = 10 - radius * std::sin(off);
    const double cy = radius * std::cos(off);
    add_arc(planner, path, {xyz(cx + radius, cy), Plane::xy, cx, cy, 1}, feed_of(100));
    add_line(planner, path, xyz(cx + radius + 0.001, cy + 10), feed_of(100));
    const Trajectory trajectory = draw_all(planner);
    CHECK(stops_of(trajectory) == 1);
    CHECK(path.deviation_of(trajectory, 0.0001) < 1.01 * kExactPathTolerance);
  }
}

TEST_CASE("A turn from linear into rotary motion is stopped at", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(10, 0), feed_of(50)).has_value());
  Position end = xyz(10, 0);
  end[Axis::A] = 30.0;
  REQUIRE(planner.add_line(end, feed_of(50)).has_value());
  CHECK(stops_of(draw_all(planner)) == 2);
}

}  // namespace cnc::motion::test
