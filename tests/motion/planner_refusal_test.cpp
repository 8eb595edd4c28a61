// What the planner refuses, and that a refusal changes nothing.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("Numbers that are not finite or too large are refused and name the axis", "[MOT-1]") {
  Planner planner(reference_settings(), xyz(1, 2, 3));
  for (const double bad : {kNan, kInf, -kInf, 1e300}) {
    const auto refused = planner.add_line(xyz(0, bad, 0), feed_of(10));
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == ErrorCode::move_number_unusable);
    CHECK(refused.error().message.find("axis Y") != std::string::npos);
    CHECK_FALSE(planner.add_arc({xyz(0, 0), Plane::xy, bad, 0.0, 1}, feed_of(10)).has_value());
    CHECK_FALSE(planner.add_arc({xyz(0, 0), Plane::xy, 0.0, bad, 1}, feed_of(10)).has_value());
    CHECK_FALSE(planner.add_arc({xyz(bad, 0), Plane::xy, 0.0, 0.0, 1}, feed_of(10)).has_value());
  }
  CHECK(planner.idle());
  CHECK(planner.queue_end() == xyz(1, 2, 3));
}

TEST_CASE("A feed that is not a positive number is refused", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  for (const double bad : {0.0, -1.0, kNan, kInf}) {
    const auto refused = planner.add_line(xyz(10, 0), feed_of(bad));
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == ErrorCode::move_feed_unusable);
  }
  CHECK(planner.add_line(xyz(10, 0), rapid()).has_value());
}

TEST_CASE("An axis without limits may be named but not moved", "[MOT-1]") {
  PlannerSettings settings = reference_settings();
  settings.limits.max_acceleration[Axis::Z] = 0.0;
  Planner planner(settings, {});
  CHECK(planner.add_line(xyz(10, 0), rapid()).has_value());
  const auto refused = planner.add_line(xyz(10, 0, 1), rapid());
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().code == ErrorCode::move_axis_without_limits);
  CHECK(refused.error().message.find("Axis Z") != std::string::npos);
  // An arc in XZ moves Z although its end does not differ in it.
  CHECK_FALSE(planner.add_arc({xyz(20, 0), Plane::xz, 0.0, 15.0, 1}, feed_of(10)).has_value());
  CHECK(draw_all(planner).end() == xyz(10, 0));
}

TEST_CASE("A hundred thousand tiny moves need bounded memory and are driven exactly", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  Position end;
  double duration = 0.0;
  int most_between = 0;
  int between = 0;
  for (int i = 1; i <= 100'000; ++i) {
    end = xyz(1e-3 * i, 1e-6 * (i % 2));
    REQUIRE(planner.add_line(end, feed_of(100)).has_value());
    most_between = std::max(most_between, ++between);
    while (planner.full()) {
      duration += planner.next().value().duration;
      between = 0;
    }
  }
  // Moves accepted before the planner had enough: its look-ahead of 30 mm in steps of 1 µm would be
  // 30,000 moves; the memory for steps bounds it earlier.
  CHECK(most_between < 8192);
  for (const Setpoint& setpoint : draw_all(planner).setpoints) duration += setpoint.duration;
  CHECK(planner.position() == end);
  CHECK(duration >= 1.2);
}

TEST_CASE("A helix of ten thousand turns is driven in bounded memory", "[MOT-4]") {
  Planner planner(reference_settings(), xyz(5, 0));
  REQUIRE(planner.add_arc({xyz(5, 0, 100), Plane::xy, 0.0, 0.0, 10'000}, feed_of(100)).has_value());
  for (int i = 0; i < 20'000; ++i) REQUIRE(planner.next().has_value());
  // 314 m take nearly two hours: it is enough to see that it goes on at its speed, which the
  // curvature bounds: v² / 5 <= 500 on each axis alone, 50 mm/s, and up to the 4th root of 2 more.
  const auto setpoint = planner.next();
  REQUIRE(setpoint.has_value());
  CHECK(linear_length(setpoint->velocity) > 45.0);
  planner.hold();
  CHECK_FALSE(draw_all(planner).setpoints.empty());
  CHECK(planner.clear());
}

TEST_CASE("Blends at a crawl behind a fast move find room", "[MOT-1]") {
  // The fast move makes the planner look far ahead, and the blends of nearly straight corners 3.6
  // mm long: steps of 5 ms at 0.08 mm/s would be 9,000 for each.
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(4, 0), feed_of(100)));
  Position end = xyz(4, 0);
  for (int i = 1; i <= 10; ++i) {
    end = end + 4.0 * xyz(std::cos(1e-4 * i), std::sin(1e-4 * i));
    REQUIRE(planner.add_line(end, feed_of(0.08)));
  }
  CHECK(draw_all(planner).end() == end);
}

}  // namespace cnc::motion::test
