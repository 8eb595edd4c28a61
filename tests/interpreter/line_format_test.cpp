// The format of a line, item repeats, item order and modal groups: manual 3.2 and 3.3.
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

}  // namespace

TEST_CASE("Every permitted way to write a line means the same", "[GCO-1]") {
  const auto row = GENERATE(values<Row>({
      {"blanks anywhere (manual 3.2)", "g0x +0. 12 34y 7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"the same without them", "g0 x+0.1234 y7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"upper case", "G0 X+0.1234 Y7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"tabs", "G0\tX\t0.1234\tY7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"words in any order", "Y7 X.1234 G0", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"carriage return at the end", "G0 X.1234 Y7\r", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"line number", "N0010 G0 X.1234 Y7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"line number of any length", "N1234567890123 G0 X.1234 Y7",
       "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"leading zeros of codes", "G00 X.1234 Y7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"zeros that are not needed", "G0 X000.12340000 Y7.", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"more digits than a double holds", "G0 X.12340000000000000000000001 Y7",
       "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"an expression", "G[1-1] X[.1+.0234] Y[7]", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"byte order mark", "\xEF\xBB\xBFG0 X.1234 Y7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
      {"slash without block delete", "/G0 X.1234 Y7", "STRAIGHT_TRAVERSE(0.123400, 7.000000"},
  }));
  INFO(row.rule);
  CHECK_THAT(commands_of(row.text), Catch::Matchers::StartsWith(row.expected));
}

TEST_CASE("Lines without content do nothing", "[GCO-1]") {
  const auto text = GENERATE(as<std::string>{}, "\n", "   \t", "%", "% any text", "N10", "O1234",
                             "o0001 ; name of the part", "/", "()", "\r");
  INFO(text);
  const Outcome outcome = run(text + "\n");
  CHECK_FALSE(outcome.failed);
  const auto moves = [](const std::string& line) { return line.find("STRAIGHT") == 0; };
  CHECK(std::none_of(outcome.lines.begin(), outcome.lines.end(), moves));
  CHECK(outcome.lines.back() == "PROGRAM_END()");
}

TEST_CASE("What a line must not hold is refused with its place", "[GCO-1][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"a letter that is no word", "G0 X1 U2", "unexpected_character@7"},
      {"a character that belongs nowhere", "G0 X1 $", "unexpected_character@7"},
      {"a word without value", "G0 X", "value_expected@5"},
      {"a word with two signs but no number", "G0 X--", "value_expected@7"},
      {"a line number behind words", "G0 X1 N5", "bad_line_number@7"},
      {"a line number with a sign", "N-5 G0 X1", "bad_line_number@1"},
      {"the same word twice", "G0 X1 X2", "word_repeated@7"},
      {"two F words", "F1 F2", "word_repeated@4"},
      {"an open comment", "G0 X1 (to the left", "comment_not_closed@7"},
      {"code behind a comment in a comment", "G0 X1 (a (b) Y2", "comment_nested@7"},
      {"a single parenthesis", "G0 X1 )", "unexpected_character@7"},
      {"O-words of LinuxCNC", "O100 while [#1 LT 5]", "o_word@1"},
      {"an O without number", "O<name> sub", "o_word@1"},
      {"a setting without value", "#1=", "value_expected@4"},
      {"a parameter that is not set", "#1", "equal_sign_expected@3"},
      {"a named parameter that is not closed", "#<depth = 5", "named_parameter@2"},
      {"an unknown statement", "dlgbox \"x\"", "unknown_statement@1"},
      {"two words run together", "G0 XY5", "unknown_function@5"},
      {"an unknown G code", "G0 X1 G999", "unknown_g_code@7"},
      {"a G code between two", "G1.5 X1", "unknown_g_code@1"},
      {"a negative G code", "G-1 X1", "unknown_g_code@1"},
      {"an unknown M code", "M77", "unknown_m_code@1"},
      {"an M code that is no whole number", "M3.5", "unknown_m_code@1"},
      {"five M codes", "M3 M8 M6 M48 M0", "too_many_m_codes@14"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("Numbers beyond any machine are refused instead of becoming infinite",
          "[GCO-1][LNG-10]") {
  const std::string huge(400, '9');
  CHECK(refusal_of("G0 X" + huge) == "word_out_of_range@4");
  CHECK(refusal_of("G0 X[" + huge + "-1]") == "result_not_finite@6");
  CHECK(refusal_of("G0 X2000000000") == "word_out_of_range@4");
  CHECK(refusal_of("#5221=[10**300]") == "word_out_of_range@1");
  CHECK(refusal_of("#1=[10**300]\nG0 X#1") == "word_out_of_range@4");
  CHECK(end_of("G0 X999999999\n")[Axis::X] == 999999999.0);
}

TEST_CASE("Two codes of one modal group are refused, whatever group", "[GCO-1]") {
  // Table 3-3 of the manual, the groups with more than one code here.
  const auto pair = GENERATE(as<std::string>{}, "G0 G1 X1 F1", "G2 G3 X1 I1", "G17 G18", "G90 G91",
                             "G93 G94", "G20 G21", "G70 G20", "G43 G49", "G54 G55", "G59.1 G59.3",
                             "G61 G64", "G61 G61.1", "G4 P1 G92 X1", "G10 L2 P1 G28", "M0 M30",
                             "M3 M5", "M7 M9", "M7 M8", "M48 M49", "G90.1 G91.1");
  CHECK_THAT(refusal_of(pair), Catch::Matchers::StartsWith("modal_group_conflict@"));
}

TEST_CASE("G80 beside another motion cancels it: the first line of many CAM programs",
          "[GCO-1][LNG-11]") {
  CHECK(run("G00 G20 G17 G90 G40 G49 G80\n").modal.motion == 800);
  CHECK(run("G80 G00\n").modal.motion == 800);
  CHECK(refusal_of("G00 G80 X1") == "axis_words_not_allowed@9");
}

TEST_CASE("Words that no code of the line uses are refused", "[GCO-1]") {
  const auto row = GENERATE(values<Row>({
      {"P without G4 or G10", "G0 X1 P2", "word_unused@7"},
      {"I without an arc", "G1 X1 I2 F1", "word_unused@7"},
      {"R without an arc", "G0 X1 R2", "word_unused@7"},
      {"H without G43", "G0 X1 H2", "word_unused@7"},
      {"D without compensation", "G0 X1 D2", "word_unused@7"},
      {"Q alone", "Q1", "word_unused@1"},
      {"a word that two codes use", "G64 P0.1 G4", "word_claimed_twice@5"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("Items are executed in the order of table 3-7, not in that of the line", "[GCO-1]") {
  CHECK(
      commands_of("M0 G1 X1 G55 G4 P2 G18 M8 M3 M6 T1 S100 F60 (note)") ==
      "COMMENT(\"note\"); SET_FEED_RATE(1.000000); SET_SPINDLE_SPEED(100.000000); SELECT_TOOL(1); "
      "CHANGE_TOOL(1); START_SPINDLE_CLOCKWISE(); SET_COOLANT(MIST_OFF, FLOOD_ON); "
      "DWELL(2.000000); SELECT_PLANE(CANON_PLANE_XZ); "
      "SET_ORIGIN_OFFSETS(2, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
      "STRAIGHT_FEED(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); PROGRAM_STOP()");
  CHECK(commands_of("G4 P2 M49 M8") ==
        "SET_COOLANT(MIST_OFF, FLOOD_ON); ENABLE_OVERRIDES(FEED_OFF, SPEED_OFF); DWELL(2.000000)");
}

TEST_CASE("A line takes effect as a whole or not at all", "[GCO-1]") {
  // The arc is impossible, so nothing that would run before it may happen.
  const Outcome outcome = run("G1 X1 F60\nG55 G18 F600 S500 M3 #1=7 G2 X5 Z5 R0.1\n");
  REQUIRE(outcome.failed);
  CHECK(outcome.diagnostic.code == ErrorCode::arc_radius_too_small);
  CHECK(outcome.lines.size() == 2);  // F and the move of the first line
  CHECK(outcome.modal.work_system == 1);
  CHECK(outcome.modal.plane == Plane::xy);
  CHECK(outcome.modal.feed == 1.0);
  CHECK(outcome.modal.spindle == SpindleDirection::off);
  CHECK(outcome.position[Axis::X] == 1.0);
}

TEST_CASE("Comments and messages", "[LNG-9]") {
  const auto row = GENERATE(values<Row>({
      {"in parentheses", "M5 (stop motion)", "COMMENT(\"stop motion\"); STOP_SPINDLE_TURNING()"},
      {"behind a semicolon", "M5 ; stop (now)", "COMMENT(\" stop (now)\"); STOP_SPINDLE_TURNING()"},
      {"a message", "(MSG, load part)", "MESSAGE(\"load part\")"},
      {"blanks and small letters", "( m s g , x)", "COMMENT(\" m s g , x\")"},
      {"small letters", "( msg,load part)", "MESSAGE(\"load part\")"},
      {"only the last one counts", "(one) (two)", "COMMENT(\"two\")"},
      {"a parenthesis inside, nothing behind", "M5 (about the ( centre )",
       "COMMENT(\"about the ( centre\"); STOP_SPINDLE_TURNING()"},
      {"between words", "G0 (left) X1",
       "COMMENT(\"left\"); STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
  }));
  INFO(row.rule);
  CHECK(commands_of(row.text) == row.expected);
}

TEST_CASE("Block delete skips lines with a slash, readable or not", "[JOB-1][GCO-1]") {
  Bench bench;
  bench.settings.block_delete = true;
  const Outcome outcome = bench.run("/G0 X1\n  / ((nonsense\nG0 Y1\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.position[Axis::X] == 0.0);
  CHECK(outcome.position[Axis::Y] == 1.0);
  CHECK(run("/G0 X1\n").position[Axis::X] == 1.0);
}

TEST_CASE("Block delete cannot take away half of a loop", "[JOB-1][LNG-3]") {
  Bench bench;
  bench.settings.block_delete = GENERATE(false, true);
  CHECK(bench.run("if [1]\n/endif\n").diagnostic.code == ErrorCode::block_delete_on_flow);
}
