#include "motion/setpoint_check.h"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

Setpoint to(double x, double v, double duration) {
  Setpoint setpoint;
  setpoint.duration = duration;
  setpoint.position = xyz(x, 0);
  setpoint.velocity = xyz(v, 0);
  return setpoint;
}

Extents travel_of_x(double min, double max) {
  const double infinity = std::numeric_limits<double>::infinity();
  Extents travel{Position::filled(-infinity), Position::filled(infinity)};
  travel.min[Axis::X] = min;
  travel.max[Axis::X] = max;
  return travel;
}

ErrorCode refused(SetpointCheck& check, const Setpoint& setpoint) {
  const auto result = check.check(setpoint);
  REQUIRE_FALSE(result.has_value());
  return result.error().code;
}

}  // namespace

TEST_CASE("Motion at the limits passes, one and a half thousandths more does not", "[MOT-1]") {
  SetpointCheck check(reference_limits(), travel_of_x(-100, 100), {});
  // From rest with 500 mm/s²: 100 mm/s after 0.2 s and 10 mm.
  CHECK(check.check(to(10.0, 100.0, 0.2)).has_value());
  CHECK(check.check(to(20.0, 100.0, 0.1)).has_value());
  check.restart({});
  // (6 · 10.005 / 0.2 − 2 · 100) / 0.2 = 500.75 mm/s².
  CHECK(refused(check, to(10.005, 100.0, 0.2)) == ErrorCode::setpoint_acceleration_too_high);
  check.restart({});
  CHECK(check.check(to(10.0, 100.0, 0.2)).has_value());
  // The mean is 100 mm/s, but the ends are slower: faster in between.
  CHECK(refused(check, to(20.0, 98.0, 0.1)) == ErrorCode::setpoint_too_fast);
}

TEST_CASE("A setpoint beyond the travel is refused, also when only its middle is outside",
          "[MOT-1][HOM-4]") {
  SetpointCheck check(reference_limits(), travel_of_x(-1, 10), xyz(9, 0));
  // Up with 500 mm/s² for 0.02 s: 0.1 mm and 10 mm/s, to the limit's neighbourhood in steps.
  CHECK(check.check(to(9.1, 10.0, 0.02)).has_value());
  CHECK(check.check(to(9.95, 10.0, 0.085)).has_value());
  // 10 mm/s turned round at −500 mm/s² in 0.04 s: back at 9.95, but at 10.05 between.
  CHECK(refused(check, to(9.95, -10.0, 0.04)) == ErrorCode::setpoint_outside_travel);
  CHECK(refused(check, to(10.05, 10.0, 0.01)) == ErrorCode::setpoint_outside_travel);
}

TEST_CASE("An axis outside of its travel may come back but not go further", "[MOT-1]") {
  SetpointCheck check(reference_limits(), travel_of_x(0, 10), xyz(12, 0));
  CHECK(refused(check, to(12.1, 10.0, 0.02)) == ErrorCode::setpoint_outside_travel);
  CHECK(check.check(to(11.9, -10.0, 0.02)).has_value());
}

TEST_CASE("A setpoint without duration or with numbers that are not finite is refused", "[MOT-1]") {
  SetpointCheck check(reference_limits(), travel_of_x(-1, 1), {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(check, to(0.0, 0.0, 0.0)) == ErrorCode::setpoint_unusable);
  CHECK(refused(check, to(nan, 0.0, 0.1)) == ErrorCode::setpoint_unusable);
  CHECK(refused(check, to(0.0, nan, 0.1)) == ErrorCode::setpoint_unusable);
  CHECK(refused(check, to(0.0, 0.0, nan)) == ErrorCode::setpoint_unusable);
  // After refusals the check still stands at the start.
  CHECK(check.check(to(0.0001, 0.0, 0.1)).has_value());
}

}  // namespace cnc::motion::test
