// What the manual forbids with cutter compensation (3.4.11, the seventeen messages of 5.4), what it
// allows meanwhile, and that a refused line leaves compensation as it was.
#include <catch2/catch.hpp>

#include "tests/interpreter/tool_path.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Row {
  const char* rule;
  const char* text;
  const char* expected;  ///< "name@column"; "" = runs
};

/// A machine with tool 1 of 6 mm in the table.
Bench bench_with_tool() {
  Bench bench;
  REQUIRE(bench.tools.set(1, {.diameter = 6, .description = {}}));
  return bench;
}

std::string refusal_on(Bench bench, const std::string& text) {
  const Outcome outcome = bench.run(text);
  if (!outcome.failed) return {};
  return std::string(error_info(outcome.diagnostic.code).name) + "@" +
         std::to_string(outcome.diagnostic.column);
}

}  // namespace

TEST_CASE("The seventeen errors of cutter compensation", "[GCO-4]") {
  const auto row = GENERATE(values<Row>({
      {"1 axis offsets: G10", "G41 D1\nG10 L2 P1 X1", "compensation_offset_change@1"},
      {"1 axis offsets: G92", "G41 D1\nG92 X1", "compensation_offset_change@1"},
      {"1 axis offsets: G92.1", "G41 D1\nG92.1", "compensation_offset_change@1"},
      {"1 axis offsets: G55", "G41 D1\nG55", "compensation_offset_change@1"},
      {"1 axis offsets: G59.3", "G41 D1\nG59.3", "compensation_offset_change@1"},
      {"1 axis offsets: rotation", "G41 D1\nG68 R10", "compensation_offset_change@1"},
      {"1 axis offsets: rotation off", "G68 R10\nG41 D1\nG69", "compensation_offset_change@1"},
      {"1 axis offsets: scaling", "G41 D1\nG51 P2", "compensation_offset_change@1"},
      {"1 axis offsets: scaling off", "G51 P2\nG41 D1\nG50", "compensation_offset_change@1"},
      {"1 axis offsets: parameter", "G41 D1\n#5221=3", "compensation_offset_change@1"},
      {"1 axis offsets: length in the plane", "G18\nG41 D1\nG43.1 K5",
       "compensation_offset_change@1"},
      {"1 axis offsets: another head", "G41 D1\nM91", "compensation_offset_change@1"},
      {"2 units", "G41 D1\nG20", "compensation_unit_change@1"},
      {"3 probe", "F9 G41 D1\nG38.2 Z-5", "compensation_probe@1"},
      {"4 out of the XY plane", "G19\nG41 D1", "compensation_plane@1"},
      {"4 on the line that leaves it", "G19 G42 D1", "compensation_plane@5"},
      {"5 on when on", "G41 D1\nG41 D1", "compensation_already_on@1"},
      {"5 the other side when on", "G41 D1\nG42 D1", "compensation_already_on@1"},
      {"5 by diameter when on", "G41 D1\nG42.1 D3", "compensation_already_on@1"},
      {"5 with a radius of 0", "G41 D0\nG41 D0", "compensation_already_on@1"},
      {"6 G28", "G41 D1\nG28", "compensation_home_move@1"},
      {"6 G30", "G41 D1\nG30 Z0", "compensation_home_move@1"},
      {"7 G53", "G41 D1\nG53 G0 X1", "compensation_machine_move@1"},
      {"7 G53 on the line of G41", "G53 G41 D1 G0 X9", "compensation_machine_move@1"},
      {"8 XZ plane", "G41 D1\nG18", "compensation_plane_change@1"},
      {"8 XY plane from the XZ plane", "G18\nG41 D1\nG17", "compensation_plane_change@1"},
      {"9 YZ plane", "G41 D1\nG19", "compensation_plane_change@1"},
      {"11 gouging, straight", "F9 G41 D1\nG1 X2.9", "compensation_gouging@1"},
      {"11 gouging, tool just covers the point", "F9 G41 D1\nG1 X3", "compensation_gouging@1"},
      {"11 gouging, rapid", "G41 D1\nG0 Y2", "compensation_gouging@1"},
      {"11 gouging, arc with R", "F9 G42 D1\nG2 X2 Y1 R9", "compensation_gouging@10"},
      {"12 D without G41", "D1 G0 X1", "word_unused@1"},
      {"12 D with G40", "G40 D1", "word_unused@5"},
      {"13 two D", "G41 D1 D1", "word_repeated@8"},
      {"14 negative D", "G41 D-1", "word_out_of_range@5"},
      {"15 D too big", "G41 D100", "word_out_of_range@5"},
      {"D that is not whole", "G41 D1.5", "word_out_of_range@5"},
      {"16 inside arc as small as the tool", "F9 G41 D1\nG1 X20\nG3 Y6 R3",
       "compensation_arc_too_small@1"},
      {"16 inside arc smaller than the tool, clockwise", "F9 G42 D1\nG1 X20\nG2 Y-4 R2",
       "compensation_arc_too_small@1"},
      {"16 as the entry move", "F9 G41 D1\nG3 X10 R2.9", "compensation_arc_too_small@8"},
      {"17 two codes of the group", "G40 G41 D1", "modal_group_conflict@5"},
      {"17 left and right", "G41 G42 D1", "modal_group_conflict@5"},
      {"17 tool and diameter", "G41 G41.1 D1", "modal_group_conflict@5"},
      {"diameter missing", "G41.1", "word_missing@1"},
      {"canned cycles", "G41 D1 F9\nG81 X9 Z-1 R1", "compensation_cycle@1"},
      {"threads", "M3 S100\nG41 D1\nG33 Z-5 K1", "compensation_cycle@1"},
      {"tapping", "M3 S100\nG41 D1\nG84 Z-5 R1 F1", "compensation_cycle@1"},
      {"entry arc that cannot reach", "F9 G42 D1\nG2 X50 R9", "compensation_entry_arc@8"},
      {"entry arc whose centre is off", "F9 G41 D1\nG3 X20 I10 J0", "compensation_entry_arc@1"},
  }));
  INFO(row.rule);
  CHECK(refusal_on(bench_with_tool(), row.text) == row.expected);
}

TEST_CASE("Inside corners: the manual's rule 10 when strict, the tool's size otherwise",
          "[GCO-4]") {
  struct Corner {
    const char* rule;
    const char* text;
    bool runs;
    bool runs_strict;
  };
  // G41.1 D6: 3 mm to the left. A square corner to the left takes 3 mm of both of its moves.
  const auto row = GENERATE(values<Corner>({
      {"square inside corner", "G1 X20\nY20", true, false},
      {"outside corner", "G1 X20\nY-20", true, true},
      {"straight on", "G1 X20\nX40", true, true},
      {"back on itself", "G1 X20\nX5", true, true},
      {"half a degree, from rounding", "G1 X20\nX40 Y0.17", true, true},
      {"one degree", "G1 X20\nX40 Y0.35", true, false},
      {"the move behind it is too short", "G1 X20\nY2.9\nY2.95", false, false},
      {"the move before it is too short", "G1 X20\nY-20\nX22.9\nY0", false, false},
      {"both of its corners together", "G1 X20\nY5.9\nX0", false, false},
      {"both of its corners, just enough room", "G1 X20\nY6.1\nX0", true, false},
      {"sharper than the moves are long", "G1 X20\nX5 Y0.5", false, false},
      {"line into an arc", "G1 X20\nG3 X30 Y10 I0 J10\nG1 X40", true, true},
      {"line into an inside arc at an angle", "G1 X20\nG3 X20 Y20 I-5 J10\n", true, false},
      {"arc to arc", "G1 X20\nG3 X28 Y8 R8\nG3 X28 Y24 R8\n", true, true},
      {"arc to arc with a corner", "G1 X20\nG3 X28 Y8 R8\nG3 X20 Y16 R8\n", true, true},
      {"two outside arcs meet", "G1 X20\nG2 X40 Y0 R10\nG2 X60 Y0 R10\n", true, false},
  }));
  INFO(row.rule);
  const std::string text = std::string("F9 G41.1 D6\nG0 X-20 Y0\n") + row.text;
  Bench bench;
  bench.start[Axis::X] = -40;
  CHECK(refusal_on(bench, text).empty() == row.runs);
  bench.settings.strict = true;
  CHECK(refusal_on(bench, text).empty() == row.runs_strict);
}

TEST_CASE("What is allowed while compensation is on", "[GCO-4]") {
  const auto text = GENERATE(as<std::string>{}, "G17", "G21", "G54", "G40", "G40 G20", "M6 T1",
                             "G43.1 K5", "G49", "G0 Z5", "G0 A90", "G80", "G4 P1", "M30", "G91",
                             "#1=5", "G40\nG41 D1", "G40 G28", "G17 G21 G40 G49 G54 G80 G90");
  INFO(text);
  CHECK(refusal_on(bench_with_tool(), "G41 D1\n" + text) ==
        (text == "G40 G20" ? "compensation_unit_change@5" : ""));
}

TEST_CASE("A refused line leaves compensation as it was", "[GCO-4]") {
  Bench bench = bench_with_tool();
  const Outcome off = bench.run("F9\nG41 D1 G1 X1\n");
  CHECK(off.failed);
  CHECK(off.modal.compensation == CompensationSide::off);
  CHECK(off.position[Axis::X] == 0.0);
  const Outcome on = bench.run("F9 G42 D1\nG40 G1 X5 I3\n");
  CHECK(on.failed);
  CHECK(on.modal.compensation == CompensationSide::right);
}

TEST_CASE("A check goes on behind a refused corner from the move before it", "[GCO-4]") {
  const auto program =
      Program::from_text("F9 G41.1 D6\nG0 X20\nG1 X50\nY2.9\nX60\nG40\nM30\n", "test.ngc").value();
  const CheckReport report = check(program, {}, {}, {}, {});
  REQUIRE(report.errors.size() == 1);
  CHECK(report.errors[0].code == ErrorCode::compensation_inside_corner);
  CHECK(report.errors[0].line == 4);
  CHECK(report.complete);
}

TEST_CASE("Displays show which compensation is on", "[GCO-4]") {
  Bench bench = bench_with_tool();
  CHECK(bench.run("G41 D1").modal.active_codes().find(" G41 ") != std::string::npos);
  CHECK(bench.run("G42.1 D1").modal.active_codes().find(" G42 ") != std::string::npos);
  CHECK(bench.run("G42 D1\nG40").modal.active_codes().find(" G40 ") != std::string::npos);
  for (const char* end : {"M2", "M30"}) {
    INFO(end);
    CHECK(bench.run(std::string("G41 D1\n") + end).modal.active_codes().find(" G40 ") !=
          std::string::npos);
  }
}
