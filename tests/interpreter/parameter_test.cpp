// Parameters with a meaning: manual 3.1.1.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

TEST_CASE("Positions and tool data are read at the moment they are asked for", "[LNG-1]") {
  struct Row {
    const char* expression;
    double expected;
  };
  Bench bench;
  Position offset;
  offset[Axis::X] = 100;
  bench.parameters.set_work_offset(1, offset);
  bench.parameters.set(5161, 12.5);
  REQUIRE(bench.tools.set(
      2, {.length = 40, .x_offset = 3, .diameter = 6, .orientation = 4, .description = {}}));
  const auto row = GENERATE(values<Row>({
      {"#5001", 7},  {"#5002", 8},    {"#5003", -1}, {"#5004", 9},   {"#5071", 110}, {"#5072", 8},
      {"#5073", 39}, {"#5008", 2},    {"#5009", 3},  {"#5010", 40},  {"#5012", 3},   {"#5013", 40},
      {"#5014", 3},  {"#5161", 12.5}, {"#5220", 1},  {"#5221", 100}, {"#5402", 40},  {"#5502", 6},
      {"#5602", 3},  {"#5702", 4},    {"#5401", 0},
  }));
  INFO(row.expression);
  // Machine X = 7 + 100 + tool 3 = 110, machine Z = -1 + tool 40 = 39.
  const std::string text = "M6 T2\nG43\nG0 X7 Y8 Z-1 A9\n#1=" + std::string(row.expression) + "\n";
  REQUIRE_FALSE(bench.run(text).failed);
  CHECK(bench.parameters.get(1) == Approx(row.expected));
}

TEST_CASE("A program in inches reads and writes lengths in inches", "[LNG-1]") {
  Bench bench;
  bench.start[Axis::X] = 50.8;
  bench.start[Axis::A] = 90;
  REQUIRE_FALSE(bench.run("G20\n#1=#5001 #2=#5004 #5221=1 #3=#5161 #4=7\n").failed);
  CHECK(bench.parameters.get(1) == Approx(2.0));
  CHECK(bench.parameters.get(2) == 90.0);  // degrees stay
  CHECK(bench.parameters.get(5221) == Approx(25.4));
  CHECK(bench.parameters.get(4) == 7.0);  // free parameters have no unit
}

TEST_CASE("What only the machine writes cannot be set", "[LNG-1]") {
  const auto number =
      GENERATE(as<std::string>{}, "5001", "5006", "5008", "5009", "5013", "5071", "5393", "5400");
  CHECK(refusal_of("#" + number + "=1") == "parameter_read_only@1");
  CHECK(refusal_of("#[" + number + "]=1") == "parameter_read_only@1");
}

TEST_CASE("Writing an offset or the work system takes effect behind the line", "[LNG-1][CRD-1]") {
  CHECK(end_of("#5221=10 G0 X1\n")[Axis::X] == 1.0);
  CHECK(end_of("#5221=10 G0 X1\nX1\n")[Axis::X] == 11.0);
  CHECK(end_of("#5241=20\nG0 X1\n")[Axis::X] == 1.0);
  CHECK(end_of("#5241=20\n#5220=2\nG0 X1\n")[Axis::X] == 21.0);
}

TEST_CASE("A refused line sets no parameter", "[LNG-1]") {
  Bench bench;
  CHECK(bench.run("#1=5 G1 X1\n").failed);
  CHECK(bench.parameters.get(1) == 0.0);
  CHECK(bench.run("#1=5 G10 L2 P1 X9 S-1\n").failed);
  CHECK(bench.parameters.work_offset(1) == Position{});
}
