// Programs that wait for the world: dialogs, inputs, stops, live values; and rendering, where
// nothing waits. Manual 3.1.1, 3.5.9, 4.2.4.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

TEST_CASE("A dialog's values go into their parameters, OK and Cancel into #5398", "[LNG-4]") {
  Bench bench;
  bench.world = [](const Command&, Answer answer) {
    answer.values = {12.5, -3};
    return answer;
  };
  const std::string program =
      "#1 = 1\n#2 = 2\ndlgmsg \"t\" \"A\" 1 \"B\" 2\nmsg #5398 \" \" #1 \" \" #2";
  CHECK(bench.run(program).lines[1] == "MESSAGE(\"1 12.5 -3\")");
  bench.world = [](const Command&, Answer answer) {
    answer.values = {12.5, -3};
    answer.confirmed = false;
    return answer;
  };
  CHECK(bench.run(program).lines[1] == "MESSAGE(\"-1 1 2\")");
}

TEST_CASE("The program waits until it is answered, and ignores answers nobody asked for",
          "[LNG-4]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  interpreter.start(Program::from_text("dlgmsg \"t\"\nG4 P1", "p").value(), {});
  interpreter.answer({});
  REQUIRE(interpreter.next() == Progress::command);
  for (int i = 0; i < 3; ++i) CHECK(interpreter.next() == Progress::waiting);
  interpreter.answer(interpreter.expected_answer());
  CHECK(interpreter.next() == Progress::command);
  CHECK(interp::text_of(interpreter.command()) == "DWELL(1.000000)");
}

TEST_CASE("After a stop the program goes on from where the operator moved the machine", "[JOB-8]") {
  Bench bench;
  bench.world = [](const Command& command, Answer answer) {
    if (std::holds_alternative<ProgramStop>(command.body)) answer.position[Axis::Z] = 30;
    return answer;
  };
  CHECK(test::text_of(bench.run("warnmsg \"jog\"\n#1 = #5073\nG0 X#1")) ==
        "WARNING(\"jog\"); PROGRAM_STOP(); "
        "STRAIGHT_TRAVERSE(30.000000, 0.000000, 30.000000, 0.000000, 0.000000, 0.000000)");
}

TEST_CASE("What follows a tool change on its line starts where the machine then stands",
          "[GCO-9]") {
  Bench bench;
  bench.settings.automatic_tool_change = false;
  bench.world = [](const Command&, Answer answer) {
    answer.position[Axis::Z] = 80;
    return answer;
  };
  CHECK(test::text_of(bench.run("T1 M6 G0 X5")) ==
        "SELECT_TOOL(1); CHANGE_TOOL(1); "
        "STRAIGHT_TRAVERSE(5.000000, 0.000000, 80.000000, 0.000000, 0.000000, 0.000000)");
}

TEST_CASE("A setting on a line that waits is made when the line is done", "[LNG-1]") {
  CHECK(commands_of("#1 = 3 T1 M6 G4 P#1\nG4 P#1") ==
        "SELECT_TOOL(1); CHANGE_TOOL(1); DWELL(0.000000); DWELL(3.000000)");
}

TEST_CASE("Live values are asked for when they are read, each time", "[LNG-1]") {
  Bench bench;
  int asked = 0;
  bench.world = [&](const Command& command, Answer answer) {
    CHECK(std::holds_alternative<Synchronise>(command.body));
    answer.live = {
        .probe = ++asked > 2, .hand_wheel = 400, .spindle_speed = 25, .height_map = false};
    return answer;
  };
  CHECK(test::text_of(bench.run("while [#5068 == 0]\n#1 = [#1 + 1]\nendwhile\n"
                                "msg #1\" \"#5069\" \"[#5070 * 60]")) ==
        "SYNCHRONISE(); SYNCHRONISE(); SYNCHRONISE(); SYNCHRONISE(); MESSAGE(\"2 400 1500\")");
  asked = 0;
  CHECK(test::text_of(bench.run("#2 = 5069\nG4 P[#[#2] / 100]")) ==
        "SYNCHRONISE(); DWELL(4.000000)");
}

TEST_CASE("Rendering waits for nothing: dialogs say OK, #5397 is 1", "[LNG-8]") {
  Bench bench;
  bench.mode = RunMode::render;
  int asked = 0;
  bench.world = [&](const Command&, Answer answer) {
    ++asked;
    return answer;
  };
  CHECK(test::text_of(bench.run("#1 = 7\ndlgmsg \"t\" \"A\" 1\nM0\nmsg #5397\" \"#5398\" \"#1\" "
                                "\"#5068")) ==
        "DIALOG(\"t\", \"A\", #1=7.000000); PROGRAM_STOP(); MESSAGE(\"1 1 7 0\")");
  CHECK(asked == 0);
  bench.mode = RunMode::run;
  CHECK(test::text_of(bench.run("msg #5397")) == "MESSAGE(\"0\")");
}
