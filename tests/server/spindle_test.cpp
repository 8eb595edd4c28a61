// Feeds and threads that follow the spindle (GCO-7).
#include <catch2/catch.hpp>

#include "tests/server/macro_rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

TEST_CASE("Feed per revolution and constant surface speed follow the spindle", "[GCO-7]") {
  MacroRig macro("sub nothing\nendsub",
                 {"SPINDLE_0.spindleRampUpTime=0", "SPINDLE_0.spindleNmin=0"});
  REQUIRE(macro.run("M3 S600"));
  const double before = macro.rig.simulation.time();
  REQUIRE(macro.run("G95 G1 X20 F0.5"));  // 0.5 mm * 10 turns/s = 5 mm/s: 4 s
  CHECK(macro.rig.simulation.time() - before == Approx(4.0).margin(0.2));
  // 60 m/min at a radius of 20 mm: 60 / (2 pi 0.02) = 477.5 rpm
  REQUIRE(macro.run("G94 G96 S60 D2000"));
  macro.rig.run_for(0.5);
  CHECK(macro.rig.simulation.virtual_machine().outputs().spindle_pwm * 24000.0 / 65535.0 ==
        Approx(477.5).margin(24.0));
  REQUIRE(macro.run("G97 S1000"));
}

TEST_CASE("A thread follows the spindle from its index on, and a tap comes out again", "[GCO-7]") {
  MacroRig macro("sub nothing\nendsub",
                 {"SPINDLE_0.spindleRampUpTime=0.5", "SPINDLE_0.spindleNmin=0"});
  REQUIRE(macro.run("M3 S600"));
  const double before = macro.rig.simulation.time();
  REQUIRE(macro.run("G33 X20 K1"));  // 20 turns at 10 turns/s: 2 s and the wait for the index
  const double took = macro.rig.simulation.time() - before;
  CHECK(took > 2.0);
  CHECK(took < 3.5);
  CHECK(macro.rig.position()[Axis::X] == Approx(20.0));
  macro.rig.machine.set_overrides({.feed = 0.1});  // a thread does not follow the override
  const double second = macro.rig.simulation.time();
  REQUIRE(macro.run("G33 X0 K1"));
  CHECK(macro.rig.simulation.time() - second < 3.5);
  REQUIRE(macro.run("G84 X0 Y0 Z-10 R0 F1"));
  CHECK(macro.rig.position()[Axis::Z] == Approx(0.0).margin(1e-9));
  CHECK(macro.rig.shown()->spindle == interp::SpindleDirection::clockwise);
}

TEST_CASE("What waits for the index moves nothing: an emergency stop then costs no trust",
          "[GCO-7][LNK-4][STA-4]") {
  HomedRig rig({"SPINDLE_0.spindleRampUpTime=0.5", "SPINDLE_0.spindleNmin=0"});
  // Within 0.2 s from pulse to pulse.
  rig.start("M3 S300\nG33 Z-5 K1\n");
  const auto waits = [&] {
    return rig.shown()->job.line == 2 && rig.simulation.link().status().board.moving;
  };
  REQUIRE(rig.becomes(waits, 20.0));
  rig.simulation.virtual_machine().set_index_missing(true);
  rig.run_for(0.3);
  REQUIRE(rig.shown()->machine_position[Axis::Z] == Approx(10.0));
  rig.simulation.virtual_machine().press_estop(true);
  REQUIRE(rig.becomes(State::estop, 0.1));
  for (const Axis axis : kLinearAxes) CHECK(rig.homed(axis));
}

TEST_CASE("A thread needs a turning spindle and axes that can follow", "[GCO-7]") {
  MacroRig macro("sub nothing\nendsub",
                 {"SPINDLE_0.spindleRampUpTime=0", "SPINDLE_0.spindleNmin=0"});
  REQUIRE(macro.run("M3 S10"));  // slower than the index can tell
  const auto standing = macro.run("G33 X20 K1");
  REQUIRE_FALSE(standing);
  CHECK(standing.error().code == ErrorCode::spindle_not_steady);
  REQUIRE(macro.run("S6000"));
  const auto fast = macro.run("G33 X20 K2");  // 200 mm/s; the axis makes 100
  REQUIRE_FALSE(fast);
  CHECK(fast.error().code == ErrorCode::thread_too_fast);
  CHECK(macro.rig.position()[Axis::X] == Approx(0.0));
}
