// Soft limits of a planned move (STA-6).
#include "server/job/travel_limits.h"

#include <algorithm>
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

TEST_CASE("A smoothed path along the end of the travel does not swing out of it",
          "[STA-6][MOT-2]") {
  const auto program = interp::Program::from_text(
      "G64 P0.5\nG0 X5 Y10\nF3000\n"
      "G1 X0 Y10.5\nX5 Y11\nX0 Y11.5\nX0 Y12\nX0.2 Y12.2\nX0 Y12.4\nX0 Y20\nX5 Y20\n",
      "edge.nc");
  REQUIRE(program);
  server::test::ReadyRig rig(server::test::free_machine());
  double least = 100.0;
  rig.machine.set_setpoint_listener([&](const motion::Setpoint& setpoint) {
    least = std::min(least, setpoint.position[Axis::X]);
  });
  REQUIRE(rig.machine.load(*program, "edge.nc"));
  REQUIRE(rig.machine.run());
  REQUIRE(rig.becomes([&] { return rig.state() != server::State::running; }, 60.0));
  CHECK(rig.shown()->job.ended_well);
  CHECK(least >= -1e-4);
  CHECK(least <= 1e-3);  // it does go there
}

TEST_CASE("The room beside a limit bounds the tolerance", "[STA-6][MOT-2]") {
  auto config = server::test::shipped_machine().config;  // X from 0 to 600
  motion::Extents extents;
  for (const Axis axis : kLinearAxes) {
    const auto& limits = config.axes[axis];
    extents.min[axis] = extents.max[axis] = 0.5 * (limits.negative_limit + limits.positive_limit);
  }
  CHECK(tolerance_within_travel(config, extents, 0.5) == 0.5);
  extents.max[Axis::X] = 599.8;
  CHECK(tolerance_within_travel(config, extents, 0.5) == Approx(0.2));
  extents.max[Axis::X] = 600.0;
  CHECK(tolerance_within_travel(config, extents, 0.5) == Approx(1e-4));
  CHECK(tolerance_within_travel(config, extents, 0.0) == 0.0);
}

TEST_CASE("Axes that cannot swing out leave the tolerance as it is", "[STA-6][MOT-2]") {
  // A slave of X, whose own coordinate stays 0, and a rotary axis that rests at an end.
  const std::string mode = GENERATE("AXIS_A.mode=slaveX", "AXIS_A.mode=rot");
  const auto config =
      server::test::shipped_machine({"AXIS_A.port=4", "AXIS_A.visible=1", mode,
                                     "AXIS_A.negativeLimit=0", "AXIS_A.positiveLimit=600"})
          .config;
  motion::Extents extents;
  for (const Axis axis : kLinearAxes) extents.min[axis] = extents.max[axis] = 5.0;
  CHECK(tolerance_within_travel(config, extents, 0.5) == 0.5);
}
