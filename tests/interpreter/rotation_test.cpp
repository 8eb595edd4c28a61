// G68 G69 rotation and G50 G51 scaling: manual 3.4.13 and 3.4.18. Expected points are computed by
// hand: a quarter turn takes (x, y) to (-y, x).
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Row {
  const char* rule;
  const char* text;
  double x;
  double y;
};

struct Wrong {
  const char* rule;
  const char* text;
  const char* expected;
};

Position at(double x, double y, double z) {
  Position position;
  position[Axis::X] = x;
  position[Axis::Y] = y;
  position[Axis::Z] = z;
  return position;
}

/// The last arc of a program.
ArcMove arc_of(std::string_view text) {
  ArcMove arc;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* move = std::get_if<ArcMove>(&command.body)) arc = *move;
  };
  const auto program = Program::from_text(std::string(text), "test.ngc").value();
  const CheckReport report = check(program, {}, {}, {}, {}, options);
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  REQUIRE(report.ok());
  return arc;
}

}  // namespace

TEST_CASE("Where rotated and scaled lines end", "[CRD-2]") {
  const auto row = GENERATE(values<Row>({
      {"positive is counter-clockwise", "G68 R90\nG0 X10 Y1", -1, 10},
      {"negative is clockwise", "G68 R-90\nG0 X10 Y1", 1, -10},
      {"any angle", "G68 R30\nG0 X10", 10 * std::sqrt(3.0) / 2, 5},
      // (10, 1) is (6, -1) from the point (4, 2); a quarter turn makes (1, 6) of it.
      {"about a point", "G68 R90 X4 Y2\nG0 X10 Y1", 5, 8},
      {"the point is absolute under G91", "G0 X3\nG91 G68 R90 X4 Y2\nG90 G0 X10 Y1", 5, 8},
      {"an omitted axis keeps its work coordinate", "G68 R90\nG0 X10 Y1\nX20", -1, 20},
      {"increments are rotated, not moved", "G0 X5 Y5\nG91 G68 R90 X4 Y2\nX2", 5, 7},
      {"a new angle replaces the old one", "G68 R45\nG68 R90\nG0 X10 Y0", 0, 10},
      {"G69 ends it", "G68 R90\nG69\nG0 X10 Y1", 10, 1},
      {"inches", "G20 G68 R90 X1 Y0\nG0 X2 Y0", 25.4, 25.4},
      {"G53 knows no rotation", "G68 R90\nG0 G53 X10 Y1", 10, 1},
      {"uniform scaling", "G51 P2\nG0 X10 Y1", 20, 2},
      // 3 + 2 * (10 - 3) and 1 + 2 * (5 - 1)
      {"scaling about a point", "G51 P2 I3 J1\nG0 X10 Y5", 17, 9},
      {"each axis its own factor", "G51 X2 Y3\nG0 X10 Y5", 20, 15},
      {"one axis only", "G51 X2\nG0 X10 Y5", 20, 5},
      {"increments are scaled", "G51 P2 I3 J3\nG91 G0 X1 Y1", 2, 2},
      {"G50 ends it", "G51 P2 I3 J1\nG50\nG0 X10 Y5", 10, 5},
      {"scaled first, then turned", "G51 X2 Y3\nG68 R90\nG0 X10 Y5", -15, 20},
      // Both about (1, 1): (3, 2) is (2, 1) from it, twice that (4, 2), turned (-2, 4).
      {"rotation and scaling have one point", "G51 P2 I9 J9\nG68 R90 X1 Y1\nG0 X3 Y2", -1, 5},
      {"a point is forgotten with G69", "G68 R10 X4 Y2\nG69\nG68 R90\nG0 X10 Y1", -1, 10},
      {"M30 leaves the rotation, as it leaves offsets", "G68 R90\nG0 X10 Y1\nM30", -1, 10},
  }));
  INFO(row.rule);
  const Position end = end_of(row.text);
  CHECK(end[Axis::X] == Approx(row.x).margin(1e-12));
  CHECK(end[Axis::Y] == Approx(row.y).margin(1e-12));
}

TEST_CASE("Z and the rotary axes are neither rotated nor scaled", "[CRD-2]") {
  const Position end = end_of("G51 P2\nG68 R90\nG0 X1 Z7 A8");
  CHECK(end[Axis::Z] == 7.0);
  CHECK(end[Axis::A] == 8.0);
}

TEST_CASE("Rotation turns the work, not its offsets", "[CRD-2]") {
  Bench bench;
  bench.parameters.set_work_offset(1, at(100, 50, 0));
  const Position end = bench.run("G68 R90\nG0 X10 Y1\n").position;
  CHECK(end[Axis::X] == 99.0);
  CHECK(end[Axis::Y] == 60.0);
}

TEST_CASE("Under rotation the program still sees its own coordinates", "[CRD-2]") {
  CHECK(commands_of("G68 R90 X4 Y2\nG51 X2 Y4\nG0 X10 Y1\nlogmsg \"\" #5001 \"/\" #5002 \"/\" "
                    "#5071")
            .ends_with("LOG(\"10/1/8\")"));
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  interpreter.start(Program::from_text("G68 R90\nG0 X10 Y1\n", "turned").value(), {});
  while (interpreter.next() != Progress::ended) {
  }
  CHECK(interpreter.position() == at(-1, 10, 0));
  CHECK(interpreter.work_position() == at(10, 1, 0));
  CHECK(interpreter.to_work(at(0, 3, 4)) == at(3, 0, 4));
}

TEST_CASE("G92 and G10 L20 give the present point its coordinates under rotation", "[CRD-2]") {
  const auto code = GENERATE(as<std::string>{}, "G92 X3", "G10 L20 P1 X3");
  INFO(code);
  Bench bench;
  bench.parameters.set_work_offset(1, at(100, 50, 20));
  const Outcome outcome = bench.run("G68 R30 X1 Y2\nG0 X10 Y7 Z5\n" + code +
                                    "\nlogmsg \"\" #5001 \"/\" #5002 \"/\" #5003");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.lines[outcome.lines.size() - 2] == "LOG(\"3/7/5\")");
}

TEST_CASE("Arcs are rotated and scaled alike", "[CRD-2]") {
  // A quarter circle from (0, 0) to (10, 10) about (10, 0), clockwise.
  const auto arc =
      GENERATE(as<std::string>{}, "G2 X10 Y10 I10 J0", "G2 X10 Y10 R10", "G90.1 G2 X10 Y10 I10 J0");
  INFO(arc);
  const ArcMove turned = arc_of("F100\nG68 R90\n" + arc);
  CHECK(turned.end[Axis::X] == Approx(-10));
  CHECK(turned.end[Axis::Y] == Approx(10));
  CHECK(turned.first_centre == Approx(0).margin(1e-9));
  CHECK(turned.second_centre == Approx(10));
  CHECK(turned.turns == -1);
  const ArcMove scaled = arc_of("F100\nG51 P3\n" + arc);
  CHECK(scaled.end[Axis::X] == Approx(30));
  CHECK(scaled.first_centre == Approx(30));
  CHECK(scaled.second_centre == Approx(0).margin(1e-9));
}

TEST_CASE("A full circle stays one under rotation", "[CRD-2]") {
  const ArcMove circle = arc_of("F100\nG68 R33 X5 Y-2\nG0 X1.7 Y2.9\nG3 X1.7 Y2.9 I4 J1");
  const double angle = 33 * std::acos(-1.0) / 180;
  const double turned_i = 4 * std::cos(angle) - std::sin(angle);
  CHECK(circle.first_centre - circle.end[Axis::X] == Approx(turned_i));
}

TEST_CASE("Canned cycles drill where the rotated work lies", "[CRD-2][GCO-3]") {
  const Position end = end_of("F100\nG68 R90\nG81 G99 X10 Y1 Z-1 R2\nX20");
  CHECK(end[Axis::X] == Approx(-1));
  CHECK(end[Axis::Y] == Approx(20));
  CHECK(end[Axis::Z] == Approx(2));
}

TEST_CASE("Rotation and scaling that are an error", "[CRD-2][LNG-10]") {
  const auto row = GENERATE(values<Wrong>({
      {"G68 without R", "G68 X1", "word_missing@1"},
      {"G68 with Z", "G68 R1 Z1", "word_unused@8"},
      {"G68 beside a motion", "G68 R10 G0 X1", "axis_words_claimed_twice@9"},
      {"G68 and G69", "G68 R10 G69", "modal_group_conflict@9"},
      {"G51 without a factor", "G51 I1", "word_missing@1"},
      {"G51 with two kinds of factor", "G51 P2 X2", "word_claimed_twice@5"},
      {"G51 P0", "G51 P0", "word_out_of_range@5"},
      {"a mirror", "G51 X-1", "word_out_of_range@5"},
      {"an arc that becomes an ellipse", "F1 G51 X2\nG2 X1 Y1 R1", "arc_not_round@1"},
      {"a scaled arc across the plane", "F1 G51 P2\nG18 G2 X1 Z1 R1", "arc_not_round@5"},
      {"a rotated arc across the plane", "F1 G68 R5\nG19 G2 Y1 Z1 R1", "arc_not_round@5"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("Rotation and scaling show among the active codes", "[CRD-2]") {
  const std::string codes = run("G68 R5\nG51 P2\n").modal.active_codes();
  CHECK(codes.find(" G68 G51 ") != std::string::npos);
  CHECK(run("G68 R5\nG69\n").modal.active_codes().find("G68") == std::string::npos);
}
