// F S T and the M codes: manual 3.5 and 3.6.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

TEST_CASE("M codes and words become commands", "[GCO-9][GCO-13]") {
  struct Row {
    const char* text;
    const char* expected;
  };
  const auto row = GENERATE(values<Row>({
      {"M0", "PROGRAM_STOP()"},
      {"M1", "OPTIONAL_PROGRAM_STOP()"},
      {"S1000 M3", "SET_SPINDLE_SPEED(1000.000000); START_SPINDLE_CLOCKWISE()"},
      {"M4", "START_SPINDLE_COUNTERCLOCKWISE()"},
      {"M5", "STOP_SPINDLE_TURNING()"},
      {"S0", "SET_SPINDLE_SPEED(0.000000)"},
      {"M7\nM8\nM9",
       "SET_COOLANT(MIST_ON, FLOOD_OFF); SET_COOLANT(MIST_ON, FLOOD_ON); SET_COOLANT(MIST_OFF, "
       "FLOOD_OFF)"},
      {"M49\nM48", "ENABLE_OVERRIDES(FEED_OFF, SPEED_OFF); ENABLE_OVERRIDES(FEED_ON, SPEED_ON)"},
      {"T5", "SELECT_TOOL(5)"},
      {"M06 T03", "SELECT_TOOL(3); CHANGE_TOOL(3)"},
      {"T3\nT4\nM6", "SELECT_TOOL(3); SELECT_TOOL(4); CHANGE_TOOL(4)"},
      {"M6", "CHANGE_TOOL(0)"},
      {"T99", "SELECT_TOOL(99)"},
      {"G40", ""},
  }));
  INFO(row.text);
  CHECK(commands_of(row.text) == row.expected);
}

TEST_CASE("A tool change stops the spindle", "[GCO-9]") {
  CHECK(commands_of("M3\nM6 T1\n") ==
        "START_SPINDLE_CLOCKWISE(); SELECT_TOOL(1); STOP_SPINDLE_TURNING(); CHANGE_TOOL(1)");
}

TEST_CASE("Words out of range are refused", "[GCO-13]") {
  CHECK(refusal_of("S-1") == "word_out_of_range@1");
  CHECK(refusal_of("T-1") == "word_out_of_range@1");
  CHECK(refusal_of("T100") == "word_out_of_range@1");
  CHECK(refusal_of("T1.5") == "word_out_of_range@1");
}

TEST_CASE("M2 and M30 reset what the manual lists and keep the work system", "[GCO-9]") {
  const auto code = GENERATE(as<std::string>{}, "M2", "M30");
  const Outcome outcome = run("G18 G91 G93 G55 M49\nS100 M3\nM8\nG0 X1\n" + code + "\nG0 X5\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.lines.back() == "PROGRAM_END()");
  CHECK(outcome.position[Axis::X] == 1.0);
  const ModalState& modal = outcome.modal;
  CHECK(modal.plane == Plane::xy);
  CHECK(modal.distance == DistanceMode::absolute);
  CHECK(modal.feed_mode == FeedMode::per_minute);
  CHECK(modal.overrides_enabled());
  CHECK(modal.spindle == SpindleDirection::off);
  CHECK_FALSE(modal.flood);
  CHECK(modal.motion == 10);
  CHECK(modal.work_system == 2);
  const auto has = [&](const char* line) {
    return std::find(outcome.lines.begin(), outcome.lines.end(), line) != outcome.lines.end();
  };
  CHECK(has("STOP_SPINDLE_TURNING()"));
  CHECK(has("SET_COOLANT(MIST_OFF, FLOOD_OFF)"));
}

TEST_CASE("The end of the file ends a program and leaves the modes alone", "[JOB-8][MAN-5]") {
  // A line that the operator types is such a program: "M3" must not stop the spindle at its end.
  const Outcome outcome = run("G91\nM3\n");
  CHECK(outcome.lines.back() == "PROGRAM_END()");
  CHECK(outcome.modal.spindle == SpindleDirection::clockwise);
  CHECK(outcome.modal.distance == DistanceMode::incremental);
}

TEST_CASE("Modal state is kept from program to program until reset", "[STA-2]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto run_text = [&](const char* text) {
    interpreter.start(Program::from_text(text, "mdi").value(), interpreter.position());
    while (interpreter.next() == Progress::command) {
    }
  };
  run_text("G91 G1 X1 F600\n");
  run_text("X1\n");
  CHECK(interpreter.position()[Axis::X] == 2.0);
  CHECK(interpreter.modal().active_codes() ==
        "G1 G17 G21 G40 G49 G54 G61 G91 G94 G97 M5 M9 M48 T0 F600 S0");
  interpreter.set_tool_in_spindle(7);
  interpreter.reset();
  CHECK(interpreter.modal().active_codes() ==
        "G80 G17 G21 G40 G49 G54 G61 G90 G94 G97 M5 M9 M48 T7 F0 S0");
}

TEST_CASE("Active codes are shown in program units", "[GUI-2]") {
  CHECK_THAT(run("G20\nF10\nG1 A5\n").modal.active_codes(), Catch::Matchers::Contains(" F10 "));
  CHECK(run("G20\nG64 F10\nG43 H2\nG59.2 G90.1 M7\nG92 X1\n").modal.active_codes() ==
        "G80 G17 G20 G40 G43 H2 G59.2 G64 G90 G90.1 G92 G94 G97 M5 M7 M48 T0 F10 S0");
}

TEST_CASE("On a 3D printer E is the A axis, and M84 switches no spindle output", "[GCO-12]") {
  Bench printer;
  printer.settings.is_3d_printer = true;
  const auto row = GENERATE(values<std::pair<const char*, const char*>>({
      {"G0 E5", "STRAIGHT_TRAVERSE(0.000000, 0.000000, 0.000000, 5.000000, 0.000000, 0.000000)"},
      {"G0 X1 E2.5",
       "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 2.500000, 0.000000, 0.000000)"},
      {"G0 E[2+1]",
       "STRAIGHT_TRAVERSE(0.000000, 0.000000, 0.000000, 3.000000, 0.000000, 0.000000)"},
      {"G0 A5", "STRAIGHT_TRAVERSE(0.000000, 0.000000, 0.000000, 5.000000, 0.000000, 0.000000)"},
      {"G92 E0", "SET_G92_OFFSETS(0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
      {"M54 E1 Q500", "SET_ANALOG_OUTPUT(1, 0.500000)"},  // its own E
      {"M82\nM84", ""},
  }));
  INFO(row.first);
  CHECK(test::text_of(printer.run(row.first)) == row.second);
  CHECK(refusal_of(printer.run("G0 A1 E1")) == "word_repeated@7");
  CHECK(refusal_of("G0 X1 E5") == "word_unused@7");
  CHECK(commands_of("M84") == "SET_SPINDLE_OUTPUT(DIRECTION, ON)");
}

TEST_CASE("sp stores X as a program writes it: under diameter programming as a diameter",
          "[LNG-7][CFG-17]") {
  const bool is_lathe = GENERATE(false, true);
  InterpreterSettings settings;
  settings.diameter_programming = is_lathe;
  std::optional<Position> stored;
  double reached = 0.0;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* store = std::get_if<StorePosition>(&command.body))
      stored = store->work_position;
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) reached = rapid->end[Axis::X];
  };
  const auto program = Program::from_text("G0 X20 Z4\nsp \"a\"\n", "job").value();
  REQUIRE(check(program, settings, {}, {}, {}, options).ok());
  CHECK(reached == (is_lathe ? 10.0 : 20.0));
  REQUIRE(stored.has_value());
  CHECK(*stored == Position{20, 0, 4});
}
