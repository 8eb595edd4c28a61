// Single lines (MAN-5).
#include <catch2/catch.hpp>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

TEST_CASE("A single line is executed to its end", "[MAN-5]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("G0 X12.5 Y3"));
  CHECK(rig.state() == State::ready);
  CHECK(rig.position()[Axis::X] == Approx(12.5).margin(1e-9));
  CHECK(rig.position()[Axis::Y] == Approx(3.0).margin(1e-9));
}

TEST_CASE("Modes of a single line hold for the next", "[MAN-5]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("G91"));
  REQUIRE(rig.mdi("G1 X1 F600"));
  REQUIRE(rig.mdi("X1"));
  CHECK(rig.position()[Axis::X] == Approx(2.0).margin(1e-9));
}

TEST_CASE("A wrong single line is refused with the place, and nothing moves", "[MAN-5][LNG-10]") {
  struct Wrong {
    const char* line;
    ErrorCode code;
    std::uint32_t column;
  };
  const auto [line, code, column] = GENERATE(values<Wrong>({
      {"G1 X5", ErrorCode::feed_not_set, 0},
      {"G0 X5 G77", ErrorCode::unknown_g_code, 7},
      {"G0 X[1+", ErrorCode::value_expected, 8},
      {"G0 X700", ErrorCode::travel_limit, 0},
      {"G0 A10", ErrorCode::axis_not_connected, 0},
  }));
  INFO(line);
  ReadyRig rig;
  const auto answer = rig.mdi(line);
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == code);
  REQUIRE(answer.error().place.has_value());
  CHECK(answer.error().place->line == 1);
  if (column != 0) CHECK(answer.error().place->column == column);
  CHECK(rig.position() == Position{});
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G0 X1"));
}

TEST_CASE("A spindle that a single line starts turns on until it is told otherwise",
          "[MAN-5][SPN-1]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("M3 S12000"));
  REQUIRE(rig.mdi("G0 X1"));
  const auto& outputs = rig.simulation.virtual_machine().outputs();
  CHECK(outputs.spindle_on);
  CHECK(outputs.tool_direction);
  // 12000 of 24000 rpm at 100 % PWM.
  CHECK(outputs.spindle_pwm == hal::cpu5::firmware::Outputs::kFullPwm / 2);
  REQUIRE(rig.mdi("M5"));
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().spindle_on);
}

TEST_CASE("A single line can be paused, resumed and stopped", "[MAN-5]") {
  ReadyRig rig;
  Result<void> answer;
  bool answered = false;
  rig.machine.mdi("G1 X40 F600", [&](Result<void> result) {
    answer = std::move(result);
    answered = true;
  });
  rig.run_for(1.0);
  REQUIRE(rig.pause());
  CHECK(rig.state() == State::paused);
  CHECK_FALSE(answered);
  REQUIRE(rig.machine.resume());
  CHECK(rig.state() == State::mdi);
  rig.run_for(0.5);
  REQUIRE(rig.stop());
  REQUIRE(answered);
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::command_interrupted);
  CHECK(rig.position()[Axis::X] < 40.0);
  CHECK(rig.state() == State::ready);
}

TEST_CASE("A single line does not disturb the loaded job", "[MAN-5]") {
  ReadyRig rig;
  REQUIRE(rig.load("G0 X5\n"));
  REQUIRE(rig.mdi("G0 X1"));
  CHECK(rig.shown()->job.path == "test.nc");
  CHECK(rig.shown()->job.line == 0);
  CHECK(rig.shown()->job.runs == 0);
}
