// Work systems, G92, tool length: manual 3.1.3, 3.4.5, 3.4.12, 3.4.15, 3.4.23.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

Position at(double x, double y, double z) {
  Position position;
  position[Axis::X] = x;
  position[Axis::Y] = y;
  position[Axis::Z] = z;
  return position;
}

}  // namespace

TEST_CASE("G54 to G59.3 select the nine work systems", "[CRD-1]") {
  struct Row {
    const char* code;
    int system;
  };
  const auto row = GENERATE(values<Row>({{"G54", 1},
                                         {"G55", 2},
                                         {"G56", 3},
                                         {"G57", 4},
                                         {"G58", 5},
                                         {"G59", 6},
                                         {"G59.1", 7},
                                         {"G59.2", 8},
                                         {"G59.3", 9}}));
  Bench bench;
  for (int system = 1; system <= 9; ++system) {
    bench.parameters.set_work_offset(system, at(100.0 * system, 0, 0));
  }
  const Outcome outcome = bench.run(std::string(row.code) + " G0 X1\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.position[Axis::X] == 100.0 * row.system + 1);
  CHECK(bench.parameters.active_system() == row.system);
  CHECK(outcome.modal.work_system == row.system);
}

TEST_CASE("A new interpreter stands in the stored work system", "[CRD-1]") {
  Bench bench;
  bench.parameters.set_work_offset(3, at(5, 6, 7));
  bench.parameters.set_active_system(3);
  CHECK(bench.run("G0 X0 Y0 Z0\n").position == at(5, 6, 7));
}

TEST_CASE("Offsets that the operator changed between programs count at the next start", "[CRD-1]") {
  Bench bench;
  const auto program = Program::from_text("G0 X0\n", "zero").value();
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  bench.parameters.set_work_offset(1, at(42, 0, 0));
  interpreter.start(program, {});
  REQUIRE(interpreter.next() == Progress::command);
  CHECK(text_of(interpreter.command()) ==
        "SET_ORIGIN_OFFSETS(1, 42.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)");
  REQUIRE(interpreter.next() == Progress::command);
  CHECK(interpreter.position()[Axis::X] == 42.0);
}

TEST_CASE("G10 L2 sets origins, of the named axes only", "[CRD-1]") {
  Bench bench;
  bench.parameters.set_work_offset(1, at(1, 2, 3));
  const Outcome outcome = bench.run("G10 L2 P1 x 3.5 y 17.2\nG10 L2 P5 X9\nG0 X0 Y0 Z0\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.position == at(3.5, 17.2, 3));
  CHECK(bench.parameters.work_offset(5) == at(9, 0, 0));
  CHECK(outcome.lines[1].starts_with("STORE_ORIGIN_OFFSETS(5, 9.0"));
}

TEST_CASE("G10 L20 gives the present point the programmed coordinates", "[CRD-1]") {
  Bench bench;
  bench.start = at(100, 50, -10);
  const Outcome outcome = bench.run("G10 L20 P1 X0 Y5\nG0 X1 Y5\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(bench.parameters.work_offset(1) == at(100, 45, 0));
  CHECK(outcome.position == at(101, 50, -10));
  // In inches, and with G92 in force: 100 mm - 25.4 mm - (G92 offset 90) = -15.4.
  Bench inch;
  inch.start = at(100, 0, 0);
  REQUIRE_FALSE(inch.run("G92 X10\nG20 G10 L20 P2 X1\n").failed);
  CHECK(inch.parameters.work_offset(2)[Axis::X] == Approx(-15.4));
}

TEST_CASE("G92 moves the origin as in the manual's example", "[CRD-1]") {
  // Manual 3.4.23: at X4, G92 X7 gives offset -3; then G92 X9 gives [[7-9] + -3] = -5.
  Bench bench;
  bench.start = at(4, 0, 0);
  CHECK(bench.run("G92 X7\nG0 X7\n").position[Axis::X] == 4.0);
  CHECK(bench.parameters.g92_offset()[Axis::X] == -3.0);
  const Outcome again = bench.run("G92 X7\nG92 x9\n");
  CHECK(again.lines[1] ==
        "SET_G92_OFFSETS(-5.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)");
  CHECK(bench.parameters.get(5211) == -5.0);
}

TEST_CASE("G92.1 forgets the offset, G92.2 keeps it for G92.3", "[CRD-1]") {
  Bench bench;
  const Outcome outcome =
      bench.run("G92 X10\nG92.2\n#1=#5001\nG92.3\n#2=#5001\nG92.1\n#3=#5001\nG92.3\n#4=#5001\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(bench.parameters.get(1) == 0.0);
  CHECK(bench.parameters.get(2) == 10.0);
  CHECK(bench.parameters.get(3) == 0.0);
  CHECK(bench.parameters.get(4) == 0.0);
  CHECK(bench.parameters.g92_offset() == Position{});
}

TEST_CASE("G92 applies to all work systems and survives M30", "[CRD-1]") {
  Bench bench;
  bench.parameters.set_work_offset(2, at(100, 0, 0));
  CHECK(bench.run("G92 X10\nG55 G0 X0\n").position[Axis::X] == 90.0);
  const Outcome ended = bench.run("G55\nG92 X10\nM30\n");
  CHECK(ended.modal.g92_active);
  CHECK(ended.modal.work_system == 2);  // manual 3.5.1: no longer reset
}

TEST_CASE("Tool length moves Z and X, from the spindle or from the table", "[GCO-5]") {
  Bench bench;
  REQUIRE(bench.tools.set(3, {.length = 50, .x_offset = 2, .description = {}}));
  REQUIRE(bench.tools.set(4, {.length = 80, .description = {}}));
  CHECK(bench.run("G43 H3\nG0 X0 Z0\n").position == at(2, 0, 50));
  CHECK(bench.run("M6 T3\nG43\nG0 X0 Z0\n").position == at(2, 0, 50));
  // G43 follows the tool change, G43 H does not.
  CHECK(bench.run("M6 T3\nG43\nM6 T4\nG0 X0 Z0\n").position == at(0, 0, 80));
  CHECK(bench.run("M6 T3\nG43 H3\nM6 T4\nG0 X0 Z0\n").position == at(2, 0, 50));
  CHECK(bench.run("G43 H3\nG49\nG0 X0 Z0\n").position == at(0, 0, 0));
  CHECK(bench.run("G43 H3\nG43 H0\nG0 X0 Z0\n").position == at(0, 0, 0));
  CHECK(bench.run("G43 H3 G0 Z1\n").position == at(0, 0, 51));
  // A change of length does not move the machine.
  CHECK(bench.run("G0 Z10\nG43 H3\n").position == at(0, 0, 10));
}

TEST_CASE("The tool changer example of the PSCNC manual moves the new tip to the old place",
          "[GCO-5]") {
  Bench bench;
  bench.settings.default_unit = LengthUnit::inch;
  REQUIRE(bench.tools.set(2, {.length = 1.5 * 25.4, .description = {}}));
  CHECK(bench.run("G00 Z0.0\nM06 T02 (change to tool #2)\nG43 H02\nG00 Z0.0\n").position[Axis::Z] ==
        Approx(1.5 * 25.4));
}

TEST_CASE("Offset codes with wrong words are refused", "[CRD-1][GCO-5]") {
  struct Row {
    const char* text;
    const char* expected;
  };
  const auto row = GENERATE(values<Row>({
      {"G10 L2 P0 X1", "word_out_of_range@8"},
      {"G10 L2 P10 X1", "word_out_of_range@8"},
      {"G10 L2 P1.5 X1", "word_out_of_range@8"},
      {"G10 L3 P1 X1", "word_out_of_range@5"},
      {"G10 P1 X1", "word_missing@1"},
      {"G10 L2 X1", "word_missing@1"},
      {"G92", "axis_words_missing@1"},
      {"G43 H100", "word_out_of_range@5"},
      {"G43 H-1", "word_out_of_range@5"},
      {"G43 H1.5", "word_out_of_range@5"},
  }));
  INFO(row.text);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("G43.1 takes the tool length from its words", "[GCO-5]") {
  Bench bench;
  REQUIRE(bench.tools.set(3, {.length = 99, .description = {}}));
  const Outcome outcome = bench.run("G43.1 I2 K30\nG0 X1 Z1\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.lines[0] == "USE_TOOL_LENGTH_OFFSET(30.000000, 2.000000)");
  CHECK(outcome.position == at(3, 0, 31));
  CHECK(outcome.modal.active_codes().find(" G43.1 ") != std::string::npos);
  // "The tool-length compensation will not adapt to the new tool after M6": 30 stays.
  CHECK(bench.run("G43.1 K30\nT3 M6\nG0 Z1\n").position == at(0, 0, 31));
  CHECK(bench.run("G20 G43.1 K1\nG0 Z1\n").position == at(0, 0, 50.8));
  CHECK(bench.run("G43.1 I2 K30\nG43.1 K5\nG0 X1 Z1\n").position == at(1, 0, 6));
  CHECK(bench.run("G43.1 K30\nG49\nG0 Z1\n").position == at(0, 0, 1));
  CHECK(bench.run("G43.1 K30\nG43 H3\nG0 Z1\n").position == at(0, 0, 100));
  CHECK(refusal_of("G43.1") == "word_missing@1");
  CHECK(refusal_of("G43.1 H1 K1") == "word_unused@7");
}

TEST_CASE("A length of G43.1 stays over the start of the next program", "[GCO-5]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  for (const char* text : {"G43.1 K30\n", "G0 Z1\n"}) {
    interpreter.start(Program::from_text(text, "line").value(), {});
    while (interpreter.next() != Progress::ended) {
    }
  }
  CHECK(interpreter.position() == at(0, 0, 31));
}
