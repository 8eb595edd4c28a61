// X words as diameters (manual 2.5, DiameterProgramming; 3.4.11.2): everything that a program
// writes or reads as an X position, and nothing else.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

Bench lathe() {
  Bench bench;
  bench.settings.diameter_programming = true;
  return bench;
}

struct Row {
  const char* rule;
  const char* text;
  double x;  ///< of the machine, where the last move ends
};

}  // namespace

TEST_CASE("X words are diameters", "[CFG-17]") {
  const auto row = GENERATE(values<Row>({
      {"G0", "G0 X20", 10},
      {"G1", "F9 G1 X20", 10},
      {"incremental", "G0 X20\nG91 X4", 12},
      {"inches", "G20 G0 X2", 25.4},
      {"G53", "G54 G53 G0 X20", 10},
      {"G92 X: the tool stands at this diameter", "G0 X20\nG92 X8\nG0 X0", 6},
      {"G10 L2", "G10 L2 P1 X8\nG0 X20", 14},
      {"G10 L20", "G0 X20\nG10 L20 P1 X8\nG0 X0", 6},
      {"offset parameters", "#5221=8\nG0 X20", 14},
      {"G28 by way of a point, stored position in parameters", "#5161=8\nG28 X20", 4},
      {"position of a parameter", "G0 X20\nG0 X[#5001 + 2]", 11},
      {"machine position of a parameter", "G92 X8\nG0 X20\nG53 G0 X#5071", 6},
      {"holes", "F9 G81 X20 Z-1 R1", 10},
      {"under rotation", "G68 R180\nG0 X20", -10},
      {"point of rotation", "G68 R180 X4\nG0 X0", 4},
      {"the end of an arc; its R is none", "G18 F9\nG2 X20 Z-10 R10", 10},
      {"the end of an arc; its I is none", "G18 F9\nG0 X0\nG2 X20 Z-10 I10 K0", 10},
      {"the tool's offset is none", "G43.1 I3\nG0 X20", 13},
  }));
  INFO(row.rule);
  Bench bench = lathe();
  const Outcome outcome = bench.run(row.text);
  INFO(outcome.diagnostic.to_string());
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.position[Axis::X] == Approx(row.x).margin(1e-9));
}

TEST_CASE("Y and Z are no diameters, and nothing is without the setting", "[CFG-17]") {
  Bench bench = lathe();
  CHECK(bench.run("G0 Y20").position[Axis::Y] == 20.0);
  CHECK(bench.run("G0 Z20").position[Axis::Z] == 20.0);
  CHECK(end_of("G0 X20")[Axis::X] == 20.0);
}

TEST_CASE("Work coordinates are given as diameters", "[CFG-17]") {
  Bench bench = lathe();
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  interpreter.start(Program::from_text("G92 X8\nG0 X20", "line").value(), {});
  while (interpreter.next() != Progress::ended) {
  }
  CHECK(interpreter.position()[Axis::X] == 6.0);
  CHECK(interpreter.work_position()[Axis::X] == 20.0);
}
