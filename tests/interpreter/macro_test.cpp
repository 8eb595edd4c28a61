// Macro files, change_tool, subs in place of M codes: manual 4.3 and 4.4; and what people's macro
// files contain besides.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Row {
  const char* rule;
  const char* macros;
  const char* text;
  const char* expected;
};

std::string result(const Row& row) {
  Bench bench;
  if (row.macros[0] != '\0') bench.add_macros(row.macros);
  const Outcome outcome = bench.run(row.text);
  return outcome.failed ? refusal_of(outcome) : test::text_of(outcome);
}

}  // namespace

TEST_CASE("Subs of macro files are called, and M codes replaced, by the manual's rules",
          "[LNG-6][LNG-7]") {
  const auto row = GENERATE(
      Row{"a sub of the macro file", "sub park\nG4 P1\nendsub", "gosub park\nG4 P2",
          "DWELL(1.000000); DWELL(2.000000)"},
      Row{"names in any case", "SUB Park\nG4 P1\nEndSub", "GoSub PARK", "DWELL(1.000000)"},
      Row{"the job's own sub comes first", "sub park\nG4 P1\nendsub",
          "gosub park\nM30\nsub park\nG4 P9\nendsub", "DWELL(9.000000)"},
      Row{"macros call each other, also those further down",
          "sub a\ngosub b\nendsub\nsub b\nG4 P3\nendsub", "gosub a", "DWELL(3.000000)"},
      Row{"a name may begin with a digit", "sub 3dprobe\nG4 P1\nend sub", "gosub 3dprobe",
          "DWELL(1.000000)"},
      Row{"no such sub", "", "gosub nowhere", "sub_unknown@7"},
      Row{"a user M code", "sub m100\nG4 P1\nendsub", "M100", "DWELL(1.000000)"},
      Row{"words come as #1 … #26, those not given as -1e10 (4.4)",
          "sub m999\nmsg \"x=\"#24\" s=\"#19\" a=\"#1\nendsub", "M999 X100 S1000",
          "MESSAGE(\"x=100 s=1000 a=-10000000000\")"},
      Row{"computed words too", "sub m100\nG4 P#16\nendsub", "#5 = 2\nM100 P[#5 * 3]",
          "DWELL(6.000000)"},
      Row{"S of the line is the sub's, not the spindle's", "sub m100\nendsub", "M100 S500", ""},
      Row{"the inner M3 is the real one (4.4)", "sub m3\nmsg \"mine\"\nm3 s#19\nm8\nendsub",
          "N2000 M3 S1000",
          "MESSAGE(\"mine\"); SET_SPINDLE_SPEED(1000.000000); START_SPINDLE_CLOCKWISE(); "
          "SET_COOLANT(MIST_OFF, FLOOD_ON)"},
      Row{"also through another sub", "sub m3\ngosub real\nendsub\nsub real\nm3\nendsub", "M3",
          "START_SPINDLE_CLOCKWISE()"},
      Row{"nothing else on the line (4.4)", "sub m3\nm3\nendsub", "M3 M8 G1 X100 F100",
          "user_m_not_alone@4"},
      Row{"not even G4", "sub m3\nm3\nendsub", "M3 G4 P1", "user_m_not_alone@1"},
      Row{"a comment does no harm", "sub m3\nG4 P1\nendsub", "M3 (on)", "DWELL(1.000000)"},
      Row{"an unknown M code without a sub", "sub m100\nendsub", "M101", "unknown_m_code@1"},
      Row{"M codes end at 999", "sub m1000\nendsub", "M1000", "unknown_m_code@1"},
      Row{"change_tool carries out M6 (4.3), #5011 is the new tool",
          "sub change_tool\nmsg \"from \"#5008\" to \"#5011\nm6t[#5011]\nendsub", "M6 T3",
          "SELECT_TOOL(3); MESSAGE(\"from 0 to 3\"); SELECT_TOOL(3); CHANGE_TOOL(3)"},
      Row{"what stands behind M6 in the order of execution comes after it",
          "sub change_tool\nm6t[#5011]\nG53 G0 Z50\nendsub", "T1 M6 S500 M3 G0 X1",
          "SET_SPINDLE_SPEED(500.000000); SELECT_TOOL(1); SELECT_TOOL(1); CHANGE_TOOL(1); "
          "STRAIGHT_TRAVERSE(0.000000, 0.000000, 50.000000, 0.000000, 0.000000, 0.000000); "
          "START_SPINDLE_CLOCKWISE(); "
          "STRAIGHT_TRAVERSE(1.000000, 0.000000, 50.000000, 0.000000, 0.000000, 0.000000)"},
      Row{"change_tool that calls itself ends at the real M6",
          "sub change_tool\nif [#1 == 0]\n#1 = 1\ngosub change_tool\nendif\nm6\nendsub", "T1 M6",
          "SELECT_TOOL(1); CHANGE_TOOL(1); CHANGE_TOOL(1)"},
      Row{"M30 within a sub ends everything", "sub a\nM30\nendsub", "gosub a\nG4 P1", ""},
      Row{"recursion has a stated depth", "sub a\ngosub a\nendsub", "gosub a", "calls_too_deep@7"});
  CAPTURE(row.rule, row.text);
  CHECK(result(row) == row.expected);
}

TEST_CASE("Without automatic tool change M6 is the operator's business", "[LNG-6]") {
  Bench bench;
  bench.add_macros("sub change_tool\nG4 P1\nendsub");
  bench.settings.automatic_tool_change = false;
  CHECK(test::text_of(bench.run("T2 M6")) == "SELECT_TOOL(2); CHANGE_TOOL(2)");
}

TEST_CASE("A later macro file's sub comes before an earlier one's", "[LNG-6]") {
  Bench bench;
  bench.add_macros("sub a\nG4 P1\nendsub\nsub b\ngosub a\nendsub", "macro.cnc");
  bench.add_macros("sub a\nG4 P2\nendsub", "user_macro.cnc");
  CHECK(test::text_of(bench.run("gosub b")) == "DWELL(2.000000)");
}

TEST_CASE("An error in a sub names the macro file and the calls that led there", "[LNG-10]") {
  Bench bench;
  bench.add_macros("sub outer\ngosub inner\nendsub\nsub inner\nG1 X1\nendsub");
  const Outcome outcome = bench.run("\ngosub outer\n");
  REQUIRE(outcome.failed);
  CHECK(outcome.diagnostic.to_string() ==
        "macro.cnc:5:1: error: G1 without a feed rate. [E2401]\n"
        "  G1 X1\n"
        "  ^~\n"
        "  allowed: F above 0, on this line or before it.\n"
        "  in sub inner, called from macro.cnc:2\n"
        "  in sub outer, called from test.ngc:2\n");
}

TEST_CASE("Loading a macro file sets parameters, moves nothing and tells what it skips",
          "[LNG-6]") {
  Bench bench;
  bench.add_macros(
      "@unit mm\n"
      "; comment\n"
      "if [#3500 == 0]\n"
      "  #3500 = 1\n"
      "  #4100 = [10 * 4]\n"
      "endif\n"
      "G0 X100\n"
      "M3 S1000\n"
      "gosub a\n"
      "4700 tool diameter\n"
      "msg \"hello\"\n"
      "sub a\nG4 P#4100\nendsub\n");
  const Outcome outcome = bench.run("gosub a");
  CHECK(test::text_of(outcome) == "DWELL(40.000000)");
  std::string lines;
  for (const Diagnostic& warning : outcome.library_warnings) {
    CHECK(warning.severity == Severity::warning);
    lines += fmt::format("{} ", warning.line);
  }
  CHECK(lines == "1 7 8 9 10 11 ");
}

TEST_CASE("A macro file that runs without end when it is loaded is given up with a warning",
          "[LNG-6]") {
  Bench bench;
  bench.add_macros("while [1 == 1]\n#1 = [#1 + 1]\nendwhile\nsub a\nG4 P1\nendsub");
  const Outcome outcome = bench.run("gosub a");
  CHECK(test::text_of(outcome) == "DWELL(1.000000)");
  REQUIRE(outcome.library_warnings.size() == 1);
  CHECK(outcome.library_warnings[0].code == ErrorCode::check_incomplete);
  CHECK(bench.parameters.get(1) == 33'333);  // 100 000 lines, three per round
}

TEST_CASE("Macro files may have a byte order mark, CRLF, Latin-1 text", "[LNG-6]") {
  Bench bench;
  bench.add_macros("\xEF\xBB\xBFsub a\r\nmsg \"Gr\xFC\xDF\"\r\nendsub\r\n");
  CHECK(test::text_of(bench.run("gosub a")) == "MESSAGE(\"Gr\xFC\xDF\")");
}
