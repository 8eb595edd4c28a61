// Conformance of what the manuals call an error: one row per bullet under "It is an error if", and
// per rule whose breach the text calls illegal. Those of cutter compensation (5.4) are rows of
// cutter_compensation_error_test.cpp, those of M codes (3.5) of conformance_m_codes_test.cpp.
#include <catch2/catch.hpp>
#include <limits>

#include "tests/interpreter/conformance.h"
#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

void check_refusal(const Row& row) {
  INFO(row.rule << ": " << row.program);
  CHECK(refusal_of(row.program) == row.expected);
}

}  // namespace

TEST_CASE("Lines that are an error by section 3.1 to 3.3", "[conformance][GCO-1][LNG-10]") {
  check_refusal(GENERATE(values<Row>({
      {"3.1.1 #5220 is a whole number from 1 to 9", "#5220=10", "parameter_value_refused@1"},
      {"3.1.1 #5220 is not 0", "#5220=0", "parameter_value_refused@1"},
      {"3.1.1 #5220 is a whole number", "#5220=1.5", "parameter_value_refused@1"},
      {"3.2 what is not allowed is illegal", "G0 X1 ?", "unexpected_character@7"},
      {"3.2.1 a line number has no sign", "N-1 G0 X1", "bad_line_number@1"},
      {"3.2.1 a line number is whole", "N1.5 G0 X1", "unexpected_character@3"},
      {"3.2.1 it stands in front", "G0 X1 N1", "bad_line_number@7"},
      {"3.2.2 a word has a value", "G0 X", "value_expected@5"},
      {"3.2.2 U is no word", "G0 U1", "unexpected_character@4"},
      {"3.2.2.1 a number has a digit", "G0 X.", "value_expected@5"},
      {"3.2.2.1 a number has one point", "G0 X1.2.3", "unexpected_character@8"},
      {"3.2.2.1 close to an integer is within 0.0001: M", "M3.0002", "unknown_m_code@1"},
      {"3.2.2.1 G times ten", "G1.00002 X1", "unknown_g_code@1"},
      {"3.2.2.1 parameter numbers", "G0 X#1.0002", "parameter_number_invalid@6"},
      {"3.2.2.2 parameters begin at 1", "G0 X#0", "parameter_number_invalid@6"},
      {"3.2.2.2 and end (at 5799 in table 3.1.1)", "G0 X#5800", "parameter_number_invalid@6"},
      {"3.2.2.3 brackets balance", "G0 X[1+2", "bracket_not_closed@5"},
      {"3.2.2.3 operations stand in brackets only", "G0 X1+2", "unexpected_character@6"},
      {"3.2.2.4 a function takes an expression", "G0 XSIN30", "bracket_expected@8"},
      {"3.2.2.4 ATAN takes two", "G0 XATAN[1]", "bracket_expected@5"},
      {"3.2.3 a setting has a parameter number", "#=1", "value_expected@2"},
      {"3.2.3 from 1 on", "#0=1", "parameter_number_invalid@2"},
      {"3.2.3 an equal sign (this is #15)", "#1 5", "equal_sign_expected@5"},
      {"3.2.3 and a value", "#1=", "value_expected@4"},
      {"3.2.4 a comment is closed on its line", "G0 X1 (open", "comment_not_closed@7"},
      {"3.2.4 comments are not nested", "(a (b) c) G0 X1", "comment_nested@1"},
      {"3.2.5 two G codes of a group", "G17 G18", "modal_group_conflict@5"},
      {"3.2.5 at most four M codes", "M3 M7 M48 M6 M0", "too_many_m_codes@14"},
      {"3.2.5 two M codes of a group", "M3 M4", "modal_group_conflict@4"},
      {"3.2.5 other letters once", "G0 X1 X2", "word_repeated@7"},
      {"3.3 axis words used by group 1 and by G10", "G0 G10 L2 P1 X1",
       "axis_words_claimed_twice@1"},
      {"3.3 axis words used by group 1 and by G92", "F60 G1 G92 X1", "axis_words_claimed_twice@5"},
      {"3.3 axis words used by group 1 and by G28", "F60 G1 G28 X1", "axis_words_claimed_twice@5"},
      {"3.3 axis words used by group 1 and by G30", "F60 G1 G30 X1", "axis_words_claimed_twice@5"},
  })));
}

TEST_CASE("Moves that are an error by section 3.4.1 to 3.4.10", "[conformance][GCO-2][LNG-10]") {
  check_refusal(GENERATE(values<Row>({
      {"3.4.1 G0: all axis words are omitted", "G0 P1", "axis_words_missing@1"},
      {"3.4.2 G1: all axis words are omitted", "F60\nG1 L2", "axis_words_missing@1"},
      {"3.4.3.1 no axis word of the plane (R)", "F60 G2 R5", "axis_words_missing@5"},
      {"3.4.3.1 no axis word of the plane (R), but the third", "F60 G2 Z5 R5",
       "axis_words_missing@5"},
      {"3.4.3.1 the end is the start (R)", "F60 G2 X0 R5", "arc_radius_end_is_start@11"},
      {"3.4.3.1 the radius does not reach the end", "F60 G2 X10 R4.9", "arc_radius_too_small@12"},
      // 5 from the start, 5.006 from the end: 0.006 mm, and more than 0.1 % of 5 mm.
      {"3.4.3.2 the distances to the centre differ (mm)", "F60 G2 X10.006 I5",
       "arc_radius_mismatch@5"},
      // 0.1 and 0.1003 inch: 0.0003 inch, and more than 0.1 % of 0.1 inch.
      {"3.4.3.2 the distances to the centre differ (inch)", "F60 G20 G2 X.2003 I.1",
       "arc_radius_mismatch@9"},
      {"3.4.3.2 G17: I and J are omitted", "F60 G17 G2 X1", "arc_centre_missing@9"},
      {"3.4.3.2 G18: I and K are omitted", "F60 G18 G2 X1", "arc_centre_missing@9"},
      {"3.4.3.2 G19: J and K are omitted", "F60 G19 G2 Y1", "arc_centre_missing@9"},
      {"3.4.3.2 G18: J is no offset of its plane", "F60 G18 G2 X1 J1", "arc_centre_off_plane@15"},
      {"3.4.4 G4: P is negative", "G4 P-1", "word_out_of_range@4"},
      {"3.4.4 G4: P is omitted", "G4", "word_missing@1"},
      {"3.4.5 G10: P is not 1 to 9", "G10 L2 P10 X1", "word_out_of_range@8"},
      {"3.4.5 G10: P is not an integer", "G10 L2 P1.5 X1", "word_out_of_range@8"},
      {"3.4.5 G10: P is omitted", "G10 L2 X1", "word_missing@1"},
      {"3.4.5 G10: L is omitted", "G10 P1 X1", "word_missing@1"},
      {"3.4.5 G10 L20: P is not 1 to 9", "G10 L20 P0 X1", "word_out_of_range@9"},
      {"3.4.9 G33: all axis words are omitted", "M3 G33 K1", "axis_words_missing@4"},
      {"3.4.9 G33: K is omitted", "M3 G33 Z-1", "word_missing@4"},
      {"3.4.9 G33: the spindle is not turning", "G33 Z-1 K1", "spindle_not_turning@1"},
      {"3.4.9 G33.1: all axis words are omitted", "M3 G33.1 K1", "axis_words_missing@4"},
      {"3.4.9 G33.1: the spindle is not turning", "G33.1 Z-1 K1", "spindle_not_turning@1"},
      {"3.4.10.1 the point is closer than 0.254 mm", "F60 G38.2 Z-0.253", "probe_too_close@5"},
      {"3.4.10.1 the point is closer than 0.01 inch", "F60 G20\nG38.2 Z-0.0099",
       "probe_too_close@1"},
      {"3.4.10.1 inverse time", "G93 F1 G38.2 Z-5", "probe_feed_mode@8"},
      {"3.4.10.1 a rotary axis is commanded to move", "F60 G38.2 Z-5 A1",
       "rotary_axis_would_turn@15"},
      {"3.4.10.1 no X, Y or Z", "F60 G38.2 A0", "axis_words_missing@5"},
  })));
}

TEST_CASE("Codes that are an error by section 3.4.11 to 3.4.19",
          "[conformance][GCO-4][GCO-7][LNG-10]") {
  check_refusal(GENERATE(values<Row>({
      {"3.4.11 D is not an integer", "G41 D1.5", "word_out_of_range@5"},
      {"3.4.11 D is negative", "G41 D-1", "word_out_of_range@5"},
      {"3.4.11 D is larger than the table", "G41 D100", "word_out_of_range@5"},
      {"3.4.11 neither XY nor ZX is active", "G19\nG41 D0", "compensation_plane@1"},
      {"3.4.11 on when on", "G41 D0\nG42 D0", "compensation_already_on@1"},
      {"3.4.11 G41.1 without its diameter", "G41.1", "word_missing@1"},
      {"3.4.11 G42.1 without its diameter", "G42.1", "word_missing@1"},
      {"3.4.12 H is not 1 to 99", "G43 H100", "word_out_of_range@5"},
      {"3.4.12 G43.1 without I and K", "G43.1", "word_missing@1"},
      {"3.4.13 non-uniform scaling with an arc", "F60 G51 X1 Y2\nG2 X10 R5", "arc_not_round@1"},
      {"3.4.13 G51 without a factor", "G51 I1 J1", "word_missing@1"},
      {"3.4.14 all axis words are omitted", "G53 G0", "axis_words_missing@1"},
      {"3.4.14 G53 without G0 or G1 (G80)", "G53 X1", "machine_move_not_straight@1"},
      {"3.4.14 G53 without G0 or G1 (G2)", "F60 G53 G2 X10 R5", "machine_move_not_straight@5"},
      {"3.4.14 G53 under compensation", "G41 D0\nG53 G0 X9", "compensation_machine_move@1"},
      {"3.4.15 a coordinate system under compensation", "G41 D0\nG55",
       "compensation_offset_change@1"},
      {"3.4.18 G68 without R", "G68 X1 Y1", "word_missing@1"},
      {"3.4.19 the plane is not ZX", "M3 G76 P1 Z-5 I5 J1 K1", "threading_plane@4"},
      {"3.4.19 X is specified", "M3 G18 G76 P1 Z-5 X1 I5 J1 K1", "word_unused@19"},
      {"3.4.19 Y is specified", "M3 G18 G76 P1 Z-5 Y1 I5 J1 K1", "word_unused@19"},
      {"3.4.19 R is less than 1", "M3 G18 G0 X20\nG76 P1 Z-5 I5 J1 K1 R.9", "word_out_of_range@21"},
      {"3.4.19 P is not specified", "M3 G18 G76 Z-5 I5 J1 K1", "word_missing@8"},
      {"3.4.19 Z is not specified", "M3 G18 G76 P1 I5 J1 K1", "axis_words_missing@8"},
      {"3.4.19 I is not specified", "M3 G18 G76 P1 Z-5 J1 K1", "word_missing@8"},
      {"3.4.19 J is not specified", "M3 G18 G76 P1 Z-5 I5 K1", "word_missing@8"},
      {"3.4.19 K is not specified", "M3 G18 G76 P1 Z-5 I5 J1", "word_missing@8"},
      {"3.4.19 P is negative", "M3 G18 G0 X20\nG76 P-1 Z-5 I5 J1 K1", "word_out_of_range@5"},
      {"3.4.19 J is negative", "M3 G18 G0 X20\nG76 P1 Z-5 I5 J-1 K1", "word_out_of_range@15"},
      {"3.4.19 K is negative", "M3 G18 G0 X20\nG76 P1 Z-5 I5 J1 K-1", "word_out_of_range@18"},
      {"3.4.19 H is negative", "M3 G18 G0 X20\nG76 P1 Z-5 I5 J1 K1 H-1", "word_out_of_range@21"},
      // The drive line is 5 long.
      {"3.4.19 E is more than half the drive line", "M3 G18 G0 X20\nG76 P1 Z-5 I5 J1 K1 E2.6 L1",
       "threading_too_short@21"},
  })));
}

TEST_CASE("Canned cycles that are an error by section 3.4.20 and 3.4.21",
          "[conformance][GCO-3][LNG-10]") {
  check_refusal(GENERATE(values<Row>({
      {"3.4.20 axis words while G80 is active", "G80\nX1", "axis_words_not_allowed@1"},
      {"3.4.20 axis words on the line of G80", "G80 X1", "axis_words_not_allowed@5"},
      {"3.4.21 X, Y and Z are all missing", "F60 G81 Z-1 R0\nR1", "word_unused@1"},
      {"3.4.21 X, Y and Z are all missing beside G81", "F60 G81 Z-1 R0\nG81 R1",
       "axis_words_missing@1"},
      {"3.4.21 P is negative", "F60 G82 Z-1 R0 P-1", "word_out_of_range@16"},
      {"3.4.21 P is required", "F60 G82 Z-1 R0", "word_missing@5"},
      {"3.4.21 L is not positive", "F60 G81 Z-1 R0 L0", "word_out_of_range@16"},
      {"3.4.21 L is not an integer", "F60 G81 Z-1 R0 L1.5", "word_out_of_range@16"},
      {"3.4.21 a rotary axis moves", "F60 G81 Z-1 R0 C1", "cycle_turns_axis@16"},
      {"3.4.21 inverse time", "G93 F1 G81 Z-1 R0", "cycle_in_inverse_time@8"},
      {"3.4.21 cutter compensation", "F60 G41 D0\nG81 X5 Z-1 R0", "compensation_cycle@1"},
      {"3.4.21 XY: Z is missing the first time", "F60 G81 X1 R0", "word_missing@5"},
      {"3.4.21 XY: Z of another cycle", "F60 G81 Z-1 R0\nG85 X1 R0", "word_missing@1"},
      {"3.4.21 XY: R is less than Z", "F60 G81 Z1 R0", "cycle_retract_below_bottom@5"},
      {"3.4.21 XZ: Y is missing the first time", "F60 G18 G81 X1 R0", "word_missing@9"},
      {"3.4.21 XZ: R is less than Y", "F60 G18 G81 Y1 R0", "cycle_retract_below_bottom@9"},
      {"3.4.21 YZ: X is missing the first time", "F60 G19 G81 Y1 R0", "word_missing@9"},
      {"3.4.21 YZ: R is less than X", "F60 G19 G81 X1 R0", "cycle_retract_below_bottom@9"},
      {"3.4.21 R is missing the first time", "F60 G81 Z-1", "word_missing@5"},
      {"3.4.21.4 G83: Q is zero", "F60 G83 Z-1 R0 Q0", "word_out_of_range@16"},
      {"3.4.21.4 G83: Q is negative", "F60 G83 Z-1 R0 Q-1", "word_out_of_range@16"},
      {"3.4.21.5 G73: Q is zero", "F60 G73 Z-1 R0 Q0", "word_out_of_range@16"},
      {"3.4.21.5 G73: Q is negative", "F60 G73 Z-1 R0 Q-1", "word_out_of_range@16"},
      {"3.4.21.9 G86: the spindle is not turning", "F60 G86 Z-1 R0 P1", "cycle_without_spindle@5"},
  })));
}

TEST_CASE("Codes and words that are an error by section 3.4.23 to 3.6",
          "[conformance][GCO-7][GCO-13][LNG-10]") {
  check_refusal(GENERATE(values<Row>({
      {"3.4.23 G92: all axis words are omitted", "G92", "axis_words_missing@1"},
      {"3.4.24 G93: F on every line with G1", "G93 F1 G1 X1\nX2", "inverse_time_feed_missing@1"},
      {"3.4.24 G93: F on every line with G2", "G93\nG2 X10 R5", "inverse_time_feed_missing@1"},
      {"3.4.24 G93: F on every line with G3", "G93\nG3 X10 R5", "inverse_time_feed_missing@1"},
      {"3.6.1 a feed is not negative", "F-1", "word_out_of_range@1"},
      {"3.6.1 a move at feed rate has a feed", "G1 X1", "feed_not_set@1"},
      {"3.6.2 S is negative", "S-1", "word_out_of_range@1"},
      {"3.6.3 T is negative", "T-1", "word_out_of_range@1"},
      {"3.6.3 T is larger than the table", "T100", "word_out_of_range@1"},
  })));
}

TEST_CASE("What the manual forbids and other people's programs contain is refused when strict",
          "[conformance][LNG-11]") {
  static const std::string long_line = "G0 X1" + std::string(252, ' ');
  const Row row = GENERATE_REF(
      Row{"3.2 at most 256 characters", long_line.c_str(), "manual_is_stricter@0"},
      Row{"3.2.1 at most five digits", "N000009 G0 X1", "manual_is_stricter@1"},
      Row{"table 3-2 O is no word", "O1000", "manual_is_stricter@1"},
      Row{"3.2.4 a parenthesis in a comment", "G0 X1 (a (b)", "manual_is_stricter@7"},
      Row{"3.4.1 G0 alone, axis words omitted", "G0", "manual_is_stricter@1"},
      Row{"3.4.2 G1 alone, axis words omitted", "G1", "manual_is_stricter@1"},
      Row{"3.4.1 G0 beside other codes, axis words omitted", "G0 G90", "manual_is_stricter@1"},
      Row{"3.4.2 G1 beside F, axis words omitted", "G1 F60", "manual_is_stricter@1"},
      Row{"3.4.3.2 no axis word of the plane", "F60 G2 I5", "manual_is_stricter@5"},
      Row{"3.4.3.2 no axis word of the plane, but the third", "F60 G2 Z1 I5",
          "manual_is_stricter@5"},
      Row{"3.4.3.2 K in the XY plane", "F60 G2 X10 I5 K0", "manual_is_stricter@15"},
      Row{"3.3 G28 beside G0, with axis words", "G0 G28 X0", "manual_is_stricter@1"},
      Row{"3.2.5 G80 beside another motion", "G80 G0", "manual_is_stricter@5"});
  INFO(row.rule << ": " << row.program);
  Bench bench;
  const Outcome tolerated = bench.run(row.program);
  CHECK(refusal_of(tolerated).empty());
  CHECK(tolerated.warnings.size() == 1);
  bench.settings.strict = true;
  CHECK(refusal_of(bench.run(row.program)) == row.expected);
}

TEST_CASE("What the PSCNC manual (3.3) calls an error", "[conformance][LNG-11][LNG-10]") {
  const Row row = GENERATE(values<Row>({
      {"G02 I J K: the distances to the centre differ", "F60 G02 X10.5 I5\nM30",
       "arc_radius_mismatch@5"},
      {"G02 R: R must be greater than 0", "F60 G02 X10 R-5\nM30", "word_out_of_range@13"},
      {"G02 R: R is 0", "F60 G02 X10 R0\nM30", "arc_radius_zero@13"},
      {"M codes that are not listed", "M04\nM30", "unknown_m_code@1"},
      {"4) one M code on a line", "M03 M06\nM30", "too_many_m_codes@5"},
      {"5) a comment ends on its line", "(open\nM30", "comment_not_closed@1"},
      {"8) the last line is M00 or M30", "G00 X1", "no_program_end@0"},
      {"G04 needs P", "G04\nM30", "word_missing@1"},
      {"G43 needs H", "G43\nM30", "word_missing@1"},
      {"G01 needs a feed rate", "G01 X1\nM30", "feed_not_set@1"},
  }));
  INFO(row.rule << ": " << row.program);
  Bench bench;
  bench.settings.dialect = DialectId::pscnc;
  CHECK(refusal_of(bench.run(row.program)) == row.expected);
}

TEST_CASE("A number from the machine that is none stops the program", "[LNG-10][GCO-8]") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Wrong {
    const char* what;
    void (*spoil)(Answer&);
  };
  const Wrong wrong = GENERATE(values<Wrong>({
      {"position", [](Answer& answer) { answer.position[Axis::Z] = kNan; }},
      {"probed position", [](Answer& answer) { answer.probe_position[Axis::A] = kInfinity; }},
      {"input", [](Answer& answer) { answer.input = kNan; }},
      {"hand wheel", [](Answer& answer) { answer.live.hand_wheel = -kInfinity; }},
      {"spindle speed", [](Answer& answer) { answer.live.spindle_speed = 1e300; }},
  }));
  INFO(wrong.what);
  Bench bench;
  bench.world = [&](const Command&, Answer answer) {
    wrong.spoil(answer);
    return answer;
  };
  const Outcome outcome = bench.run("F60 G38.2 Z-5\nG91 G0 Z1\n");
  CHECK(outcome.diagnostic.code == ErrorCode::answer_impossible);
  CHECK(outcome.lines.back().starts_with("STRAIGHT_PROBE"));
  CHECK(bench.parameters.get(5063) == 0.0);
}

TEST_CASE("A typed value that is no number stops the program and sets nothing", "[LNG-4][LNG-10]") {
  const double typed =
      GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
  Bench bench;
  bench.world = [&](const Command&, Answer answer) {
    answer.values = {5.0, typed};
    return answer;
  };
  const Outcome outcome = bench.run("#1=1 #2=2\ndlgmsg \"t\" \"A\" 1 \"B\" 2");
  CHECK(outcome.diagnostic.code == ErrorCode::word_out_of_range);
  CHECK(bench.parameters.get(1) == 1.0);
  CHECK(bench.parameters.get(2) == 2.0);
}

TEST_CASE("A dialog shows what only the machine writes, and refuses another value for it",
          "[LNG-4]") {
  Bench bench;
  double typed = 3.0;
  bench.world = [&](const Command& command, Answer answer) {
    if (std::holds_alternative<AskOperator>(command.body)) answer.values = {typed, 7.0};
    return answer;
  };
  const std::string program = "T3 M6\ndlgmsg \"t\" \"old\" 5008 \"new\" 5011\nmsg #5008\" \"#5011";
  CHECK(bench.run(program).lines.at(3) == "MESSAGE(\"3 7\")");
  typed = 4.0;
  CHECK(bench.run(program).diagnostic.code == ErrorCode::parameter_read_only);
}
