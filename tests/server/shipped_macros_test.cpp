// The shipped macro.cnc from end to end (LNG-6, HOM-3).
#include <catch2/catch.hpp>

#include "server/daemon/shipped_files.h"
#include "tests/server/macro_rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

TEST_CASE("The shipped macros: tool setter and tool length", "[LNG-6]") {
  MacroRig macro(shipped_macros());
  REQUIRE(macro.rig.becomes(State::ready));
  int stops = 0;
  macro.on_stop = [&] {
    // First the tool table, then Z up, then above the setter.
    if (++stops == 2) REQUIRE(macro.rig.machine.jog_step(Axis::Z, 5.0, 0.5));
    if (stops == 3) {
      REQUIRE(macro.rig.machine.jog_step(Axis::X, 500.0, 1.0));
      REQUIRE(macro.rig.becomes(State::program_stop));
      REQUIRE(macro.rig.machine.jog_step(Axis::Y, 300.0, 1.0));
      REQUIRE(macro.rig.becomes(State::program_stop));
      REQUIRE(macro.rig.machine.jog_step(Axis::Z, -95.0, 1.0));
    }
    REQUIRE(macro.rig.becomes(State::program_stop));
  };
  REQUIRE(macro.run("gosub calibrate_tool_setter"));
  CHECK(stops == 3);
  CHECK_THAT(macro.messages(),
             Contains("Tool setter calibrated: safe height 5, X 500, Y 300, height -100"));
  CHECK(macro.rig.position()[Axis::Z] == Approx(5.0));

  macro.rig.simulation.virtual_machine().set_tool_length(42.5);
  macro.on_stop = {};
  REQUIRE(macro.run("gosub m_tool", {7, 40, 6}));
  CHECK_THAT(macro.messages(), Contains("Tool 7 has length 42.5"));
  REQUIRE(
      macro.rig.complete([&](Completion done) { macro.rig.machine.when_saved(std::move(done)); }));
  const auto tools = config::ToolTable::load(macro.folder.file("tools.txt")).value();
  CHECK(tools.tool(7).length == Approx(42.5).margin(1.0 / 200.0));
  CHECK(tools.tool(7).diameter == 6.0);

  const auto wrong = macro.run("gosub m_tool", {100, 40, 6});
  REQUIRE_FALSE(wrong);
  CHECK_THAT(wrong.error().message, Contains("1 to 99"));
}

TEST_CASE("The shipped macros: zero of the work piece with the probe plate, whatever the unit",
          "[LNG-6]") {
  const auto unit = GENERATE(as<std::string>{}, "G21", "G20");
  INFO(unit);
  MacroRig macro(shipped_macros());
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("G0 Z-50"));
  REQUIRE(macro.run(unit));
  REQUIRE(macro.run("gosub user_1", {20}));
  CHECK_THAT(macro.rig.shown()->active_codes, Contains(unit));
  // The plate of 20 mm lies at the height that the probe touches.
  REQUIRE(macro.run("G21 G0 Z30"));
  CHECK(macro.rig.position()[Axis::Z] == Approx(kStockTop - 20.0 + 30.0).margin(2.0 / 200.0));
}

TEST_CASE("The shipped macros: height map of a slope", "[LNG-6]") {
  MacroRig macro(shipped_macros());
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("G92 Z75"));  // work Z 0 = machine -75
  REQUIRE(macro.run("gosub zhcmgrid", {3, 2, 5, -20, 10, 600}));
  CHECK_THAT(macro.messages(), Contains("Height map: 6 points added, 0 missed"));
  macro.rig.machine.wait_for_files();
  std::istringstream text(
      config::test::content_of(macro.folder.file("files/zHeightCompTable.txt")));
  std::string word;
  double size = 0.0;
  int columns = 0;
  int rows = 0;
  REQUIRE(text >> word >> size >> columns >> rows);
  CHECK(word == "grid");
  CHECK(size == 10.0);
  CHECK(columns == 3);
  CHECK(rows == 2);
  int points = 0;
  for (double x = 0, y = 0, z = 0; text >> x >> y >> z; ++points)
    CHECK(z == Approx(kStockTop + 0.1 * x + 0.05 * y).margin(1.0 / 200.0));
  CHECK(points == 6);
}

TEST_CASE("The shipped macros: tool change by hand, and a tool that is there already", "[LNG-6]") {
  MacroRig macro(shipped_macros(), {"JOB.autoToolChange=1"});
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("T2 M6"));
  CHECK(macro.rig.shown()->tool == 2);
  CHECK_THAT(macro.messages(), Contains("Insert tool 2"));
  REQUIRE(macro.run("T2 M6"));
  CHECK_THAT(macro.messages(), Contains("Tool 2 is in the spindle already"));
  REQUIRE(macro.run("T3 M6"));
  CHECK_THAT(macro.messages(), Contains("Take out tool 2") && Contains("Insert tool 3"));
  CHECK(macro.rig.shown()->tool == 3);
}

TEST_CASE("The shipped macros load without a remark, and homing works by them", "[LNG-6][HOM-3]") {
  MacroRig macro(shipped_macros(), {}, true);
  REQUIRE(macro.rig.becomes(State::needs_homing));
  CHECK_THAT(macro.messages(), !Contains("remark"));
  REQUIRE(macro.rig.home());
  CHECK(macro.rig.state() == State::ready);
}
