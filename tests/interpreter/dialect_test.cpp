// The dialect pscnc (PSCNC manual 3.3), what the dialect eding tolerates, and the setting that
// makes it strict.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Row {
  const char* rule;
  const char* text;
  const char* expected;
};

std::string in_pscnc(const char* text) {
  Bench bench;
  bench.settings.dialect = DialectId::pscnc;
  static_cast<void>(bench.tools.set(2, {.length = 1.5}));
  const Outcome outcome = bench.run(text);
  return outcome.failed ? refusal_of(outcome) : test::text_of(outcome);
}

}  // namespace

TEST_CASE("The dialect pscnc follows its manual", "[LNG-11]") {
  const auto row = GENERATE(
      Row{"unlisted G codes are ignored", "G91 G00 X1\nG00 X1\nM30",
          "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
          "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
      Row{"unlisted M codes are errors", "M08\nM30", "unknown_m_code@1"},
      Row{"M codes are executed behind the motion of their line", "G00 X1 M03\nM30",
          "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
          "START_SPINDLE_CLOCKWISE(); STOP_SPINDLE_TURNING()"},
      Row{"one M code on a line", "M03 M05\nM30", "too_many_m_codes@5"},
      Row{"M21 and M22 switch contouring", "M22\nM21\nM30",
          "SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP); SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)"},
      Row{"R below half the distance is half a circle", "F60 G02 X4 Y0 R1\nM30",
          "SET_FEED_RATE(1.000000); ARC_FEED(4.000000, 0.000000, 2.000000, 0.000000, -1, "
          "0.000000, 0.000000, 0.000000, 0.000000)"},
      Row{"G43 takes H from the tool file", "G43 H02\nG00 Z0\nM30",
          "USE_TOOL_LENGTH_OFFSET(1.500000, 0.000000); "
          "STRAIGHT_TRAVERSE(0.000000, 0.000000, 1.500000, 0.000000, 0.000000, 0.000000)"},
      Row{"G43 without H", "G43\nM30", "word_missing@1"},
      Row{"a program ends with M00", "G00 X1\nM00",
          "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
          "PROGRAM_STOP()"},
      Row{"a program without an end", "G00 X1\n", "no_program_end@0"});
  CAPTURE(row.rule, row.text);
  CHECK(in_pscnc(row.text) == row.expected);
}

TEST_CASE("A typed line needs no M30 in any dialect", "[LNG-11]") {
  Bench bench;
  bench.settings.dialect = DialectId::pscnc;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  interpreter.start(Program::from_text("G00 X1", "line").value(), {}, {.single_line = true});
  CHECK(interpreter.next() == Progress::command);
  CHECK(interpreter.next() == Progress::command);
  CHECK(interpreter.next() == Progress::ended);
}

TEST_CASE("Habits of CAM systems are warned of once, and refused when strict", "[LNG-11]") {
  struct Habitual {
    const char* text;
    const char* strict;  ///< refusal
  };
  static const std::string long_line = "(" + std::string(260, 'x') + ")\n";
  const auto row = GENERATE_REF(Habitual{"N1234567 G0 X1", "manual_is_stricter@1"},
                                Habitual{long_line.c_str(), "manual_is_stricter@0"},
                                Habitual{"O1234 (PART)", "manual_is_stricter@1"},
                                Habitual{"if [1 == 1]\nelse : note\nendif", "manual_is_stricter@6"},
                                Habitual{"if [1 == 1]]\nendif", "manual_is_stricter@12"},
                                Habitual{"msg \"a\" %d", "manual_is_stricter@9"},
                                Habitual{"G1 F300", "manual_is_stricter@1"},
                                Habitual{"G0 G91 G28 Z0", "manual_is_stricter@1"},
                                Habitual{"F60 G2 X2 I1 K0", "manual_is_stricter@14"},
                                Habitual{"G0 G17 G40 G80", "manual_is_stricter@12"});
  CAPTURE(row.text);
  Bench bench;
  const Outcome twice = bench.run(std::string(row.text) + "\n" + row.text);
  CHECK(refusal_of(twice).empty());
  CHECK(twice.warnings.size() == 1);
  bench.settings.strict = true;
  CHECK(refusal_of(bench.run(row.text)) == row.strict);
}

TEST_CASE("What the manual allows gives no warning and is allowed when strict", "[LNG-11]") {
  Bench bench;
  bench.settings.strict = true;
  const Outcome outcome =
      bench.run("%\nN10 g0x +0. 12 34y 7\n(comment) (another)\nG17 G21\nF100 G1 X1 M3\nM30\n%");
  CHECK(refusal_of(outcome).empty());
  CHECK(outcome.warnings.empty());
}

TEST_CASE("A 3D printer ignores the M codes that mean nothing to it", "[GCO-12]") {
  Bench bench;
  CHECK(refusal_of(bench.run("M82")) == "unknown_m_code@1");
  bench.settings.is_3d_printer = true;
  const Outcome outcome = bench.run("M82 (absolute extrusion)\nG4 P1");
  CHECK(test::text_of(outcome) == "DWELL(1.000000)");
  CHECK(outcome.warnings.size() == 1);
}

TEST_CASE("Nesting data are read from the file and skipped by the language", "[JOB-4]") {
  const auto program =
      Program::from_text("%mx=200\n%MY = 150.5\n%dx=20\n%dy=-30\n%ox=1\n%oy=2\n%\n%zz=3\nG0 X1\n",
                         "nest.nc")
          .value();
  const NestingData& data = program->nesting();
  CHECK(data.material_x == 200.0);
  CHECK(data.material_y == 150.5);
  CHECK(data.pitch_x == 20.0);
  CHECK(data.pitch_y == -30.0);
  CHECK(data.offset_x == 1.0);
  CHECK(data.offset_y == 2.0);
  CHECK(end_of("%mx=200\nG0 X1")[Axis::X] == 1.0);
}
