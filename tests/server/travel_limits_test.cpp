// Soft limits of a planned move (STA-6).
#include "server/job/travel_limits.h"

#include <catch2/catch.hpp>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using Catch::Contains;

namespace {

motion::Extents along(Axis axis, double low, double high) {
  motion::Extents extents;
  extents.min[axis] = low;
  extents.max[axis] = high;
  return extents;
}

}  // namespace

TEST_CASE("A move may touch its limits and not pass them", "[STA-6]") {
  // The shipped X axis goes from 0 to 600; a tenth of a micrometre is rounding.
  const auto config = server::test::shipped_machine().config;
  struct Row {
    double low;
    double high;
    bool inside;
  };
  const auto [low, high, inside] = GENERATE(values<Row>({{0.0, 600.0, true},
                                                         {-0.00009, 600.00009, true},
                                                         {-0.001, 10.0, false},
                                                         {0.0, 600.001, false}}));
  const auto answer = check_travel(config, along(Axis::X, low, high));
  CHECK(answer.has_value() == inside);
  if (!answer) CHECK(answer.error().code == ErrorCode::travel_limit);
}

TEST_CASE("A refusal names axis, place and limits", "[STA-6]") {
  const auto config = server::test::shipped_machine().config;
  const auto answer = check_travel(config, along(Axis::Z, -151.25, 0.0));
  REQUIRE_FALSE(answer);
  CHECK_THAT(answer.error().message,
             Contains("Z") && Contains("-151.250") && Contains("-150.000") && Contains("10.000"));
}

TEST_CASE("An axis that is not connected may stand anywhere but not move", "[STA-6]") {
  const auto config = server::test::shipped_machine().config;
  CHECK(check_travel(config, along(Axis::A, 7.0, 7.0)));
  const auto answer = check_travel(config, along(Axis::A, 0.0, 1.0));
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::axis_not_connected);
}
