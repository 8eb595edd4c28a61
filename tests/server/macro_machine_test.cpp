// What macro files and single lines do to the machine: outputs and inputs, homing, files, guards,
// clamps and head offsets (GCO-10, HOM-3, LNG-4, STA-4, STA-7, STA-8, CRD-4).
#include <catch2/catch.hpp>

#include "config/ini_file.h"
#include "server/daemon/shipped_files.h"
#include "tests/server/macro_rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

TEST_CASE("Outputs and inputs: M54 M55 M56, and waiting with a time-out", "[GCO-10]") {
  MacroRig macro("sub nothing\nendsub");
  REQUIRE(macro.run("M54 P3"));  // wired back to input 3, 20 ms later
  REQUIRE(macro.run("M56 P3 L1 Q2"));
  REQUIRE(macro.run("msg \"in3 \"#5399"));
  CHECK_THAT(macro.messages(), Contains("in3 1"));
  REQUIRE(macro.run("M55 P3"));
  REQUIRE(macro.run("M56 P3 L2 Q2"));
  REQUIRE(macro.run("msg \"then \"#5399"));
  CHECK_THAT(macro.messages(), Contains("then 0"));
  const double before = macro.rig.simulation.time();
  REQUIRE(macro.run("M56 P4 L1 Q1.5"));
  CHECK(macro.rig.simulation.time() - before == Approx(1.5).margin(0.2));
  REQUIRE(macro.run("msg \"late \"#5399"));
  CHECK_THAT(macro.messages(), Contains("late 0"));
}

TEST_CASE("Homing goes by the macro file, and \"home x\" homes one axis", "[HOM-3]") {
  const std::string macros =
      "sub home_x\nhome x\nendsub\nsub home_y\nhome y\nG0 Y50\nendsub\n"
      "sub home_z\nhome z\nendsub\n"
      "sub home_all\ngosub home_z\ngosub home_y\ngosub home_x\nmsg \"all home\"\nendsub\n";
  MacroRig macro(macros, {}, true);
  REQUIRE(macro.rig.state() == State::needs_homing);
  REQUIRE(macro.rig.home());
  CHECK(macro.rig.state() == State::ready);
  CHECK_THAT(macro.messages(), Contains("all home"));
  CHECK(macro.rig.position()[Axis::Y] == Approx(50.0));
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) CHECK(macro.rig.homed(axis));
  REQUIRE(macro.rig.home({Axis::Y}));
  CHECK(macro.rig.position()[Axis::Y] == Approx(50.0));
  const auto refused = macro.run("home a");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::axis_not_connected);
}

TEST_CASE("user_reset runs behind a reset, and a changed macro file is read again", "[STA-2]") {
  MacroRig macro("sub user_reset\nmsg \"first\"\nendsub");
  REQUIRE(macro.rig.becomes(State::ready));
  CHECK_THAT(macro.messages(), Contains("first"));
  config::test::put(macro.folder.file("user_macro.cnc"), "sub user_reset\nmsg \"second\"\nendsub");
  REQUIRE(macro.rig.reset());
  REQUIRE(macro.rig.becomes(State::ready));
  CHECK_THAT(macro.messages(), Contains("second"));
}

TEST_CASE("What programs write goes into their folder and nowhere else", "[LNG-4]") {
  MacroRig macro(
      "sub write\nlogfile \"part.nc\" 0\nlogmsg \"G0 X\"#4000\nlogmsg \"M30\"\n"
      "logfile \"../escape.nc\" 0\nlogmsg \"bad\"\nG0 X3\nsp points.txt 0\nendsub");
  REQUIRE(macro.run("#4000 = 2.5"));
  REQUIRE(macro.run("gosub write"));
  macro.rig.machine.wait_for_files();
  CHECK(config::test::content_of(macro.folder.file("files/part.nc")) == "G0 X2.5\nM30\n");
  CHECK(config::test::content_of(macro.folder.file("files/points.txt")) ==
        "3.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n");
  CHECK_FALSE(std::filesystem::exists(macro.folder.file("escape.nc")));
  CHECK_THAT(macro.messages(), Contains("cannot write to \"../escape.nc\""));
}

TEST_CASE("Only a tool change may enter the tool change area", "[STA-7]") {
  MacroRig macro(
      "sub change_tool\nTCAGuard off\nG53 G0 X150 Y150\nm6 t[#5011]\nTCAGuard on\nendsub",
      {"JOB.autoToolChange=1", "TOOLCHANGEAREA.xLow=100", "TOOLCHANGEAREA.xHigh=200",
       "TOOLCHANGEAREA.yLow=100", "TOOLCHANGEAREA.yHigh=200", "TOOLCHANGEAREA.zLow=-50",
       "TOOLCHANGEAREA.zHigh=50"});
  struct Move {
    const char* line;
    bool allowed;
  };
  for (const Move& move : {Move{"G0 X90 Y90", true}, Move{"G0 X210 Y210", false},
                           Move{"G0 X210", true}, Move{"G0 Y210", true}, Move{"G0 X90 Y90", false},
                           Move{"G2 X90 Y90 I-60 J-60 F6000", false}}) {
    INFO(move.line);
    const auto moved = macro.run(move.line);
    CHECK(moved.has_value() == move.allowed);
    if (!moved) CHECK(moved.error().code == ErrorCode::tool_change_area);
  }
  REQUIRE(macro.run("T1 M6"));
  CHECK(macro.rig.position()[Axis::X] == Approx(150.0));
}

TEST_CASE("HomeIsEstop: a home switch that becomes active behind homing stops at once", "[STA-4]") {
  MacroRig macro("sub nothing\nendsub", {"AXIS_X.negativeLimit=-20"});
  REQUIRE(macro.rig.home());
  REQUIRE(macro.run("HomeIsEstop on"));
  REQUIRE(macro.run("M3 S12000"));
  REQUIRE(macro.run("M8"));
  REQUIRE(macro.rig.simulation.virtual_machine().outputs().spindle_on);
  macro.rig.machine.mdi("G1 X-15 F3000", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::error));
  CHECK(macro.rig.last_error().code == ErrorCode::home_switch_active);
  CHECK_FALSE(macro.rig.homed(Axis::X));
  macro.rig.run_for(0.1);
  CHECK_FALSE(macro.rig.simulation.virtual_machine().outputs().spindle_on);
  CHECK_FALSE(macro.rig.simulation.virtual_machine().outputs().flood);
  REQUIRE(macro.rig.reset());
  REQUIRE(macro.rig.machine.jog_step(Axis::X, 10.0, 0.2));  // off the switch
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("HomeIsEstop off"));
  REQUIRE(macro.run("G1 X-15 F3000"));
}

TEST_CASE("A clamped axis is not jogged", "[STA-8]") {
  MacroRig macro("sub nothing\nendsub",
                 {"AXIS_A.port=4", "AXIS_A.visible=1", "AXIS_A.velocity=90"});
  REQUIRE(macro.run("M26 P2"));
  CHECK((macro.rig.simulation.virtual_machine().outputs().ports & 2U) != 0);
  const auto jogged = macro.rig.machine.jog_step(Axis::A, 5.0, 0.5);
  REQUIRE_FALSE(jogged);
  CHECK(jogged.error().code == ErrorCode::axis_clamped);
  REQUIRE(macro.run("M27 P2"));
  REQUIRE(macro.rig.machine.jog_step(Axis::A, 5.0, 0.5));
}

TEST_CASE("A measured head offset is kept in the configuration's file", "[CRD-4]") {
  MacroRig macro("sub nothing\nendsub");
  config::test::put(macro.folder.file("cnc.ini"), shipped_cnc_ini());
  REQUIRE(macro.run("G10 L20 P1 X0 Y0 Z0"));
  REQUIRE(macro.run("G0 X30 Y-0 Z-5"));
  REQUIRE(macro.run("M95 Q1"));
  const auto saved = config::load_machine_config(macro.folder.file("cnc.ini")).value();
  CHECK(saved.probe.x == Approx(30.0));
  CHECK(saved.probe.z == Approx(-5.0));
  CHECK(saved.camera == config::HeadOffset{});
}

TEST_CASE("Cutter compensation of a job that ended in its middle does not act on the next",
          "[GCO-4]") {
  MacroRig macro("sub nothing\nendsub");
  macro.rig.start("G41.1 D6\nG1 X20 Y20 F6000\nG1 X40\nM0\nG1 X60\nG40\nM30\n");
  REQUIRE(macro.rig.becomes(State::program_stop));
  REQUIRE(macro.rig.stop());
  REQUIRE(macro.run("G1 X100 Y100 F6000"));
  CHECK(macro.rig.position()[Axis::X] == Approx(100.0));
  CHECK(macro.rig.position()[Axis::Y] == Approx(100.0));
}

TEST_CASE("Every mistake of a macro file is told when it is loaded, the first ten by themselves",
          "[LNG-6]") {
  std::string lines;
  for (int i = 0; i < 12; ++i) lines += "G0 X1\n";
  const MacroRig macro("sub fine\nendsub\n" + lines);
  const std::string messages = macro.messages();
  CHECK_THAT(messages, Contains("macro.cnc:3: ") && Contains("macro.cnc:12: "));
  CHECK_THAT(messages, !Contains("macro.cnc:13: ") && Contains("2 more remarks"));
}
