// Macro files on the machine: dialogs, stops with jogging, probing, homing, inputs and outputs, and
// the shipped macro.cnc from end to end (LNG-4 … LNG-6, GCO-8, GCO-10, HOM-3, JOB-8).
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "config/ini_file.h"
#include "server/daemon/shipped_files.h"
#include "tests/config/temporary_directory.h"
#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;
using config::test::TemporaryDirectory;

namespace {

constexpr double kSetterTop = -100.0;  // machine Z at which the bare spindle touches the setter
constexpr double kStockTop = -80.0;

/// A free machine with macro files of its own, a stock and a tool setter.
struct MacroRig {
  explicit MacroRig(std::string_view macros, std::vector<std::string> settings = {},
                    bool mandatory_homing = false)
      : rig(data(macros, std::move(settings), mandatory_homing), options()) {
    REQUIRE(rig.reset());
  }

  MachineData data(std::string_view macros, std::vector<std::string> settings,
                   bool mandatory_homing) {
    config::test::put(folder.file("macro.cnc"), macros);
    MachineData machine = mandatory_homing ? shipped_machine() : free_machine(std::move(settings));
    machine.macro_files = {folder.file("macro.cnc"), folder.file("user_macro.cnc")};
    machine.parameter_file = folder.file("parameters.txt");
    machine.tool_file = folder.file("tools.txt");
    machine.program_folder = folder.file("files");
    machine.config_file = folder.file("cnc.ini");
    return machine;
  }

  static SimulationOptions options() {
    SimulationOptions options = at_zero();
    // A slope, so that every point of a grid has a height of its own.
    options.machine.touch.stock = [](double x, double y) {
      return x > 200.0 ? -200.0 : kStockTop + 0.1 * x + 0.05 * y;
    };
    options.machine.touch.tool_setter =
        hal::sim::ToolSetter{.x = 500, .y = 300, .half_width = 20, .top = kSetterTop};
    options.machine.loop_back_delay = 0.02;
    return options;
  }

  /// Runs a single line and answers what it asks, as an operator would.
  Result<void> run(const std::string& line, std::vector<double> values = {},
                   bool confirmed = true) {
    auto answer = std::make_shared<std::optional<Result<void>>>();
    rig.machine.mdi(line, [answer](Result<void> result) { *answer = std::move(result); });
    for (int rounds = 0; rounds < 100 && !answer->has_value(); ++rounds) {
      const auto asks = [&] {
        return answer->has_value() || rig.state() == State::question ||
               rig.state() == State::program_stop || rig.state() == State::tool_change;
      };
      REQUIRE(rig.becomes_with_disk(asks, 300.0));
      if (answer->has_value()) break;
      rig.simulation.cycle();
      if (rig.state() == State::question) {
        const auto question = rig.shown()->question;
        REQUIRE(question.has_value());
        REQUIRE(rig.machine.answer(question->number, confirmed, values));
      } else {
        if (on_stop) on_stop();
        REQUIRE(rig.machine.resume());
      }
    }
    REQUIRE(answer->has_value());
    rig.simulation.cycle();
    if (!answer->value()) UNSCOPED_INFO(answer->value().error().to_string());
    return **answer;
  }

  [[nodiscard]] std::string messages() const {
    std::string all;
    for (const LogMessage& message : rig.simulation.log().after(0)) all += message.text + "|";
    return all;
  }

  TemporaryDirectory folder;
  Rig rig;
  std::function<void()> on_stop;
};

}  // namespace

TEST_CASE("A dialog stops the machine until it is answered, by its number", "[LNG-4]") {
  MacroRig macro(
      "sub ask\n#1 = 5\ndlgmsg \"How far?\" \"X\" 1\nif [#5398 == 1]\nG0 X#1\nendif\nendsub");
  macro.rig.machine.mdi("gosub ask", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::question));
  macro.rig.simulation.cycle();
  const auto question = macro.rig.shown()->question;
  REQUIRE(question.has_value());
  CHECK(question->title == "How far?");
  REQUIRE(question->fields.size() == 1);
  CHECK(question->fields[0].label == "X");
  CHECK(question->fields[0].value == 5.0);
  const auto refused = [&](std::uint64_t number, std::vector<double> values) {
    const auto answer = macro.rig.machine.answer(number, true, std::move(values));
    return answer ? std::string("accepted") : std::string(error_info(answer.error().code).name);
  };
  CHECK(refused(question->number + 1, {}) == "no_question");
  CHECK(refused(question->number, {1, 2}) == "value_out_of_range");
  CHECK(refused(question->number, {std::numeric_limits<double>::quiet_NaN()}) ==
        "value_out_of_range");
  CHECK(refused(question->number, {12.5}) == "accepted");
  REQUIRE(macro.rig.becomes(State::ready));
  CHECK(macro.rig.position()[Axis::X] == Approx(12.5));
  CHECK(refused(question->number, {12.5}) == "command_not_allowed");
}

TEST_CASE("A stopped question ends the program and answers nobody", "[LNG-4]") {
  MacroRig macro("sub ask\ndlgmsg \"?\"\nG0 X10\nendsub");
  std::optional<Result<void>> answer;
  macro.rig.machine.mdi("gosub ask", [&](Result<void> result) { answer = std::move(result); });
  REQUIRE(macro.rig.becomes(State::question));
  REQUIRE(macro.rig.stop());
  CHECK(macro.rig.state() == State::ready);
  REQUIRE(answer.has_value());
  CHECK_FALSE(answer->has_value());
  CHECK_FALSE(macro.rig.shown()->question.has_value());
  CHECK(macro.rig.position()[Axis::X] == 0.0);
}

TEST_CASE("While a program waits the operator may jog, and it goes on from there", "[JOB-8]") {
  MacroRig macro("sub park\nwarnmsg \"Jog away, then resume\"\n#4996 = #5071\nG0 Y10\nendsub");
  macro.on_stop = [&] {
    REQUIRE(macro.rig.machine.jog_step(Axis::X, 7.0, 0.5));
    CHECK(macro.rig.state() == State::jogging);
    REQUIRE(macro.rig.becomes(State::program_stop));
  };
  REQUIRE(macro.run("gosub park"));
  CHECK(macro.rig.position()[Axis::X] == Approx(7.0));
  CHECK(macro.rig.position()[Axis::Y] == Approx(10.0));
  REQUIRE(macro.run("G0 X#4996"));
  CHECK(macro.rig.position()[Axis::X] == Approx(7.0));
}

TEST_CASE("A stop while jogging in a waiting program ends both", "[JOB-8]") {
  MacroRig macro("sub park\nM0\nG0 Y10\nendsub");
  macro.rig.machine.mdi("gosub park", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::program_stop));
  REQUIRE(macro.rig.machine.jog_step(Axis::X, 100.0, 0.5));
  macro.rig.run_for(0.3);
  REQUIRE(macro.rig.stop());
  CHECK(macro.rig.state() == State::ready);
  CHECK(macro.rig.position()[Axis::X] > 0.0);
  CHECK(macro.rig.position()[Axis::X] < 100.0);
  REQUIRE(macro.rig.mdi("G0 X0"));
  CHECK(macro.rig.position()[Axis::Y] == 0.0);
}

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

TEST_CASE("#5068 is the probe input at the place of its line", "[LNG-1]") {
  MacroRig macro("sub nothing\nendsub");
  REQUIRE(macro.run("msg \"up \"#5068"));
  REQUIRE(macro.run("G0 Z-90"));
  REQUIRE(macro.run("msg \"down \"#5068"));
  CHECK_THAT(macro.messages(), Contains("up 0") && Contains("down 1"));
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

TEST_CASE("The shipped macros: zero of the work piece with the probe plate", "[LNG-6]") {
  MacroRig macro(shipped_macros());
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("G0 Z-50"));
  REQUIRE(macro.run("gosub user_1", {20}));
  // The plate of 20 mm lies at the height that the probe touches.
  REQUIRE(macro.run("G0 Z30"));
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
  macro.rig.machine.mdi("G1 X-15 F3000", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::error));
  CHECK(macro.rig.last_error().code == ErrorCode::home_switch_active);
  CHECK_FALSE(macro.rig.homed(Axis::X));
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

TEST_CASE("A dialog value that its parameter cannot have is refused and asked again", "[LNG-4]") {
  MacroRig macro("sub ask\ndlgmsg \"Tool\" \"Diameter\" 5507\nendsub");
  macro.rig.machine.mdi("gosub ask", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::question));
  macro.rig.simulation.cycle();
  const std::uint64_t number = macro.rig.shown()->question->number;
  CHECK_FALSE(macro.rig.machine.answer(number, true, {1e6}));
  CHECK(macro.rig.state() == State::question);
  CHECK(macro.rig.machine.answer(number, true, {6.0}));
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("msg \"diameter \"#5507"));
  CHECK_THAT(macro.messages(), Contains("diameter 6"));
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
