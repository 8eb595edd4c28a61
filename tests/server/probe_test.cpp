// Probe moves, from G38.2 to the board's latch and back (GCO-8).
#include <catch2/catch.hpp>

#include "tests/server/macro_rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

TEST_CASE("A probe move ends at the surface, exactly, and stops within the limits", "[GCO-8]") {
  MacroRig macro("sub nothing\nendsub");
  REQUIRE(macro.run("G92 Z5"));
  REQUIRE(macro.run("G38.2 Z-120 F600"));
  // The height is known to one step of 1/200 mm: the board latches at the very step.
  REQUIRE(macro.run("msg \"touch \"#5053\" work \"#5063\" tripped \"#5067"));
  const std::string text = macro.messages();
  CAPTURE(text);
  double machine = 0.0;
  double work = 0.0;
  int tripped = 0;
  REQUIRE(std::sscanf(text.c_str() + text.find("touch"), "touch %lf work %lf tripped %d", &machine,
                      &work, &tripped) == 3);
  CHECK(machine == Approx(kStockTop).margin(1.0 / 200.0));
  CHECK(work == Approx(machine + 5.0).margin(1e-6));
  CHECK(tripped == 1);
  CHECK(macro.rig.position()[Axis::Z] < machine);
  // v^2 / 2a = 10 * 10 / (2 * 300) = 0.17 mm behind the touch.
  CHECK(macro.rig.position()[Axis::Z] > machine - 0.2);
  REQUIRE(macro.run("G0 Z0"));
  CHECK(macro.rig.position()[Axis::Z] == Approx(-5.0));
}

TEST_CASE("A probe move that touches nothing ends at its end with #5067 = 0", "[GCO-8]") {
  MacroRig macro("sub nothing\nendsub");
  REQUIRE(macro.run("G38.2 Z-20 F1200"));
  CHECK(macro.rig.position()[Axis::Z] == Approx(-20.0));
  REQUIRE(macro.run("msg \"tripped \"#5067"));
  CHECK_THAT(macro.messages(), Contains("tripped 0"));
  REQUIRE(macro.run("G38.2 Z-120 F1200"));  // the latch of before does not count
  CHECK(macro.rig.position()[Axis::Z] < kStockTop);
}

TEST_CASE("A probe that touches already refuses the move", "[GCO-8]") {
  MacroRig macro("sub nothing\nendsub");
  REQUIRE(macro.run("G0 Z-90"));
  const auto probed = macro.run("G38.2 Z-120 F600");
  REQUIRE_FALSE(probed);
  CHECK(probed.error().code == ErrorCode::probe_active);
  CHECK(macro.rig.position()[Axis::Z] == Approx(-90.0));
  REQUIRE(macro.run("G0 Z0"));
}

TEST_CASE("A probe move is paused, resumed and stopped like any other", "[GCO-8]") {
  MacroRig macro("sub nothing\nendsub");
  macro.rig.machine.mdi("G38.2 Z-120 F600", [](const Result<void>&) {});
  macro.rig.run_for(2.0);
  REQUIRE(macro.rig.pause());
  const double paused_at = macro.rig.position()[Axis::Z];
  CHECK(paused_at < 0.0);
  macro.rig.run_for(1.0);
  CHECK(macro.rig.position()[Axis::Z] == paused_at);
  REQUIRE(macro.rig.machine.resume());
  macro.rig.run_for(1.0);
  CHECK(macro.rig.position()[Axis::Z] < paused_at);
  REQUIRE(macro.rig.stop());
  CHECK(macro.rig.state() == State::ready);
  REQUIRE(macro.run("G0 Z0"));
  CHECK(macro.rig.position()[Axis::Z] == Approx(0.0).margin(1e-9));
}

TEST_CASE("A touch at any instant around the end of a probe move leaves a machine that drives",
          "[GCO-8][safety]") {
  double whole = 0.0;
  for (int cycle = -4; cycle < 10; ++cycle) {
    CAPTURE(cycle);
    MacroRig macro("sub nothing\nendsub");
    auto& simulation = macro.rig.simulation;
    if (cycle == -4) {
      const double begin = simulation.time();
      REQUIRE(macro.run("G38.2 Z-20 F1200"));
      whole = simulation.time() - begin;
      REQUIRE(macro.run("G0 Z0"));
    }
    macro.rig.machine.mdi("G38.2 Z-20 F1200", [](const Result<void>&) {});
    macro.rig.run_for(whole + 0.005 * cycle);
    simulation.virtual_machine().stick_probe(true);
    macro.rig.run_for(0.5);
    simulation.virtual_machine().stick_probe(false);
    REQUIRE(macro.rig.becomes(State::ready, 1.0));
    REQUIRE(macro.run("G0 Z-5"));
    CHECK(macro.rig.position()[Axis::Z] == Approx(-5.0));
  }
}

TEST_CASE("A pause of a probe move waits for what the board has to hold, and no longer",
          "[GCO-8]") {
  MacroRig macro("sub nothing\nendsub");
  macro.rig.machine.mdi("G38.2 Z-120 F600", [](const Result<void>&) {});
  macro.rig.run_for(2.0);
  const double begin = macro.rig.simulation.time();
  REQUIRE(macro.rig.pause());
  // hostTimeout 0.2 s, a ramp of 10 / 300 s, 0.03 s on its way; then that ramp, and a few cycles of
  // 5 ms.
  const double ramp = 10.0 / 300.0;
  CHECK(macro.rig.simulation.time() - begin <= 0.2 + ramp + 0.03 + ramp + 0.02);
}

TEST_CASE("#5068 is the probe input at the place of its line", "[LNG-1]") {
  MacroRig macro("sub nothing\nendsub");
  REQUIRE(macro.run("msg \"up \"#5068"));
  REQUIRE(macro.run("G0 Z-90"));
  REQUIRE(macro.run("msg \"down \"#5068"));
  CHECK_THAT(macro.messages(), Contains("up 0") && Contains("down 1"));
}
