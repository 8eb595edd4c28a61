// G73 G74 G81 … G89, G98 G99: manual 3.4.21 and 3.4.26.
#include <algorithm>
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

TEST_CASE("The two G81 examples of the manual", "[GCO-3]") {
  Bench bench;
  bench.start[Axis::X] = 1;
  bench.start[Axis::Y] = 2;
  bench.start[Axis::Z] = 3;
  CHECK(moves_of(bench, "F100 G90 G81 G98 X4 Y5 Z1.5 R2.8") ==
        "rapid 4 5 3; rapid 4 5 2.8; feed 4 5 1.5; rapid 4 5 3");
  CHECK(moves_of(bench, "F100 G91 G81 G98 X4 Y5 Z-0.6 R1.8 L3") ==
        "rapid 1 2 4.8; "
        "rapid 5 7 4.8; feed 5 7 4.2; rapid 5 7 4.8; "
        "rapid 9 12 4.8; feed 9 12 4.2; rapid 9 12 4.8; "
        "rapid 13 17 4.8; feed 13 17 4.2; rapid 13 17 4.8");
}

TEST_CASE("What each canned cycle does at the bottom and on the way out", "[GCO-3]") {
  const auto row = GENERATE(values<Row>({
      {"G82 dwells", "G82 Z-1 R0 P0.5", "feed 0 0 -1; dwell 0.5; rapid 0 0 0"},
      {"G85 feeds out", "G85 Z-1 R0", "feed 0 0 -1; feed 0 0 0"},
      {"G86 stops the spindle and starts it again", "M3 G86 Z-1 R0 P0.5",
       "spindle cw; feed 0 0 -1; dwell 0.5; spindle off; rapid 0 0 0; spindle cw"},
      {"G89 dwells and feeds out", "G89 Z-1 R0 P0.5", "feed 0 0 -1; dwell 0.5; feed 0 0 0"},
      // Steps of 2 from R0 to -5: -2, -4, -5. Back down 0.25 above the bottom so far.
      {"G83 clears the hole after every step", "G83 Z-5 R0 Q2",
       "feed 0 0 -2; rapid 0 0 0; rapid 0 0 -1.75; "
       "feed 0 0 -4; rapid 0 0 0; rapid 0 0 -3.75; feed 0 0 -5; rapid 0 0 0"},
      {"G73 goes back by Q only", "G73 Z-5 R0 Q2",
       "feed 0 0 -2; rapid 0 0 0; rapid 0 0 -1.75; "
       "feed 0 0 -4; rapid 0 0 -2; rapid 0 0 -3.75; feed 0 0 -5; rapid 0 0 0"},
      {"G83 with P dwells at the bottom", "G83 Z-1 R0 Q2 P1", "feed 0 0 -1; dwell 1; rapid 0 0 0"},
      {"a depth of whole steps has no empty last step", "G83 Z-0.3 R0 Q0.1 G99",
       "feed 0 0 -0.1; rapid 0 0 0; feed 0 0 -0.2; rapid 0 0 0; feed 0 0 -0.3; rapid 0 0 0"},
  }));
  INFO(row.rule);
  CHECK(moves_of(std::string("F100\n") + row.text) == row.expected);
}

TEST_CASE("How far a canned cycle retracts", "[GCO-3]") {
  const auto row = GENERATE(values<Row>({
      {"G98: to where it began", "G98 G81 X1 Z-1 R2",
       "rapid 0 0 10; rapid 1 0 10; rapid 1 0 2; feed 1 0 -1; rapid 1 0 10"},
      {"G99: to R", "G99 G81 X1 Z-1 R2",
       "rapid 0 0 10; rapid 1 0 10; rapid 1 0 2; feed 1 0 -1; rapid 1 0 2"},
      {"G98 with R above where it began: to R", "G98 G81 X1 Z-1 R12",
       "rapid 0 0 10; rapid 0 0 12; rapid 1 0 12; feed 1 0 -1; rapid 1 0 12"},
  }));
  INFO(row.rule);
  CHECK(moves_of(std::string("F100 G0 Z10\n") + row.text) == row.expected);
}

TEST_CASE("Words of a canned cycle stay for its next lines", "[GCO-3]") {
  CHECK(moves_of("F100\nG83 G99 X1 Z-2 R0 Q1.5\nX2\nX3 Z-1") ==
        "rapid 1 0 0; feed 1 0 -1.5; rapid 1 0 0; rapid 1 0 -1.25; feed 1 0 -2; rapid 1 0 0; "
        "rapid 2 0 0; feed 2 0 -1.5; rapid 2 0 0; rapid 2 0 -1.25; feed 2 0 -2; rapid 2 0 0; "
        "rapid 3 0 0; feed 3 0 -1; rapid 3 0 0");
  CHECK(moves_of("F100\nG81 X1 Z-1 R0 L2\nX2") ==
        "rapid 1 0 0; feed 1 0 -1; rapid 1 0 0; feed 1 0 -1; rapid 1 0 0; "
        "rapid 2 0 0; feed 2 0 -1; rapid 2 0 0");
}

TEST_CASE("Canned cycles drill along the axis that is normal to the plane", "[GCO-3]") {
  CHECK(moves_of("F100\nG18 G81 X1 Z2 Y-3 R1") ==
        "rapid 0 1 0; rapid 1 1 2; feed 1 -3 2; rapid 1 1 2");
  CHECK(moves_of("F100\nG19 G81 Y1 Z2 X-3 R1") ==
        "rapid 1 0 0; rapid 1 1 2; feed -3 1 2; rapid 1 1 2");
}

TEST_CASE("Canned cycles count from the work offset, in the program's unit", "[GCO-3]") {
  Bench bench;
  Position offset;
  offset[Axis::X] = 100;
  offset[Axis::Z] = -50;
  bench.parameters.set_work_offset(1, offset);
  // Z -1 inch: -50 - 25.4; R 0: -50; from machine 0.
  CHECK(moves_of(bench, "F10 G20\nG81 X1 Z-1 R0 G99") ==
        "rapid 125.4 0 0; rapid 125.4 0 -50; feed 125.4 0 -75.4; rapid 125.4 0 -50");
}

TEST_CASE("Canned cycles that are an error", "[GCO-3][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"no X Y Z", "G81 Z-1 R0\nA0", "axis_words_missing@1"},
      {"negative P", "G82 Z-1 R0 P-1", "word_out_of_range@12"},
      {"L0", "G81 Z-1 R0 L0", "word_out_of_range@12"},
      {"L1.5", "G81 Z-1 R0 L1.5", "word_out_of_range@12"},
      {"a rotary axis that turns", "G81 Z-1 R0 B5", "cycle_turns_axis@12"},
      {"inverse time", "G93 G81 Z-1 R0 F1", "cycle_in_inverse_time@5"},
      {"no Z where it begins", "G81 X1 R0", "word_missing@1"},
      {"no Y where it begins in the XZ plane", "G18 G81 Z1 R0", "word_missing@5"},
      {"no X where it begins in the YZ plane", "G19 G81 Z1 R0", "word_missing@5"},
      {"no R where it begins", "G81 Z-1", "word_missing@1"},
      {"another cycle has its own words", "G81 Z-1 R0\nG85 X1", "word_missing@1"},
      {"words do not stay over a change of distance mode", "G81 Z-1 R0\nG91 X1", "word_missing@5"},
      {"R below Z", "G81 Z1 R0", "cycle_retract_below_bottom@1"},
      {"R below Y", "G18 G81 Y1 R0", "cycle_retract_below_bottom@5"},
      {"R below X", "G19 G81 X1 R0", "cycle_retract_below_bottom@5"},
      {"G91 with an upward depth", "G91 G81 Z1 R0", "cycle_retract_below_bottom@5"},
      {"G82 without P", "G82 Z-1 R0", "word_missing@1"},
      {"G83 without Q", "G83 Z-1 R0", "word_missing@1"},
      {"G83 with Q0", "G83 Z-1 R0 Q0", "word_out_of_range@12"},
      {"G73 with negative Q", "G73 Z-1 R0 Q-1", "word_out_of_range@12"},
      {"steps without end", "G83 Z-1 R0 Q0.00001", "word_out_of_range@1"},
      {"G86 with the spindle off", "G86 Z-1 R0 P0", "cycle_without_spindle@1"},
      {"no feed", "F0 G81 Z-1 R0", "feed_not_set@4"},
      {"G53", "G53 G81 Z-1 R0", "machine_move_not_straight@1"},
      {"a dwell in a cycle that has none", "G81 Z-1 R0 P1", "word_unused@12"},
      {"G84 with the spindle off", "G84 Z-1 R0 F1", "spindle_not_turning@1"},
      {"G74 with the spindle off", "G74 Z-1 R0 F1", "spindle_not_turning@1"},
      {"G84 counter-clockwise", "M4 G84 Z-1 R0 F1", "tapping_direction@4"},
      {"G74 clockwise", "M3 G74 Z-1 R0 F1", "tapping_direction@4"},
      {"a feed from before the cycle is no pitch", "M3 G84 Z-1 R0", "word_missing@4"},
      {"F in mm per minute is no pitch", "M3 S600 G84 Z-1 R0 F600", "word_out_of_range@20"},
      {"tapping without pitch", "M3 G84 Z-1 R0 F0", "word_out_of_range@15"},
      {"tapping at constant surface speed", "G96 S10 M3 G84 Z-1 R0 F1",
       "thread_in_surface_speed@12"},
      {"tapping in inverse time", "M3 G93 G84 Z-1 R0 F1", "cycle_in_inverse_time@8"},
      {"G87 with the spindle off", "G87 Z-9 R0 I1 J0 K-5", "cycle_without_spindle@1"},
      {"G87 without I", "M3 G87 Z-9 R0 J0 K-5", "word_missing@4"},
      {"G87 without J", "M3 G87 Z-9 R0 I1 K-5", "word_missing@4"},
      {"G87 without K", "M3 G87 Z-9 R0 I1 J0", "word_missing@4"},
      {"G87 that bores downwards", "M3 G87 Z-9 R0 I1 J0 K-10", "word_out_of_range@21"},
      {"G87 that bores above R", "M3 G87 Z-9 R0 I1 J0 K1", "word_out_of_range@21"},
      {"G88 with the spindle off", "G88 Z-9 R0 P0", "cycle_without_spindle@1"},
      {"G88 without P", "M3 G88 Z-9 R0", "word_missing@4"},
      {"a feed per revolution without a spindle", "G95 F0.1 G81 Z-1 R0", "feed_without_spindle@10"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(std::string("F100\n") + row.text) == row.expected);
}

TEST_CASE("A canned cycle ends with G80 and with another motion", "[GCO-3]") {
  CHECK(refusal_of("F1\nG81 Z-1 R0\nG80\nX1") == "axis_words_not_allowed@1");
  CHECK(moves_of("F100\nG81 Z-1 R0\nG0 X1") == "feed 0 0 -1; rapid 0 0 0; rapid 1 0 0");
}

TEST_CASE("Under G64 a canned cycle drills in exact path mode", "[GCO-3]") {
  const std::string commands = commands_of("F60\nG64 P0.1\nG81 Z-1 R0");
  const auto begin = commands.find("SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH); STRAIGHT_FEED");
  CHECK(begin != std::string::npos);
  CHECK(commands.ends_with("; SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, P0.100000)"));
}

TEST_CASE("Tapping follows the spindle down and, reversed, up again", "[GCO-3][GCO-7]") {
  const auto row = GENERATE(values<Row>({
      {"G84: right-hand, F is the pitch", "S600 M3\nG84 X1 Z-5 R1 F1.25",
       "spindle cw; rapid 0 0 1; rapid 1 0 1; thread 1 0 -5 by 1.25; spindle ccw; "
       "thread 1 0 1 by 1.25; spindle cw"},
      {"G74: left-hand", "M4\nG74 Z-5 R0 F1",
       "spindle ccw; thread 0 0 -5 by 1; spindle cw; thread 0 0 0 by 1; spindle ccw"},
      {"F is the pitch in G95 too", "M3\nG95 G84 Z-5 R0 F1",
       "spindle cw; thread 0 0 -5 by 1; spindle ccw; thread 0 0 0 by 1; spindle cw"},
      // 1/20 inch is 1.27 mm; Z -0.5 inch is -12.7 mm.
      {"inches per revolution under G20", "M3\nG20 G84 Z-.5 R0 F.05",
       "spindle cw; thread 0 0 -12.7 by 1.27; spindle ccw; thread 0 0 0 by 1.27; spindle cw"},
      {"the pitch stays within the cycle, whatever F a line between sets",
       "M3\nG84 G99 Z-5 R0 F1\nF500\nX1",
       "spindle cw; thread 0 0 -5 by 1; spindle ccw; thread 0 0 0 by 1; spindle cw; rapid 1 0 0; "
       "thread 1 0 -5 by 1; spindle ccw; thread 1 0 0 by 1; spindle cw"},
      {"repeated by L", "M3\nG91 G84 X1 Z-5 R0 F1 L2",
       "spindle cw; rapid 1 0 0; thread 1 0 -5 by 1; spindle ccw; thread 1 0 0 by 1; spindle cw; "
       "rapid 2 0 0; thread 2 0 -5 by 1; spindle ccw; thread 2 0 0 by 1; spindle cw"},
      {"in the XZ plane along Y", "M3\nG18 G84 Y-5 R0 F1",
       "spindle cw; thread 0 -5 0 by 1; spindle ccw; thread 0 0 0 by 1; spindle cw"},
      {"G98 threads up to where it began", "M3\nG0 Z3\nG84 Z-5 R0 F1",
       "spindle cw; rapid 0 0 3; rapid 0 0 0; thread 0 0 -5 by 1; spindle ccw; thread 0 0 3 by 1; "
       "spindle cw"},
  }));
  INFO(row.rule);
  CHECK(moves_of(std::string("F100\n") + row.text) == row.expected);
}

TEST_CASE("G87 goes through the hole with the tool oriented and bores upwards", "[GCO-3]") {
  // The thirteen steps of manual 3.4.21.10, of which the first is "preliminary motion".
  const auto row = GENERATE(values<Row>({
      {"in the XY plane", "M3\nG87 X10 Y5 Z-20 R2 I1 J0.5 K-15",
       "spindle cw; rapid 0 0 2; rapid 10 5 2; rapid 11 5.5 2; orient; rapid 11 5.5 -20; "
       "rapid 10 5 -20; spindle cw; feed 10 5 -15; feed 10 5 -20; orient; rapid 11 5.5 -20; "
       "rapid 11 5.5 2; rapid 10 5 2; spindle cw"},
      // R = 0 + 2, Z = R - 22 = -20, K = Z + 5 = -15.
      {"K counts from Z under G91", "M4\nG91 G99 G87 Z-22 R2 I1 J0 K5",
       "spindle ccw; rapid 0 0 2; rapid 1 0 2; orient; rapid 1 0 -20; rapid 0 0 -20; spindle ccw; "
       "feed 0 0 -15; feed 0 0 -20; orient; rapid 1 0 -20; rapid 1 0 2; rapid 0 0 2; spindle ccw"},
      {"I and K aside, J along the hole in the XZ plane", "M3\nG18 G87 Y-20 R0 I1 K2 J-15",
       "spindle cw; rapid 1 0 2; orient; rapid 1 -20 2; rapid 0 -20 0; spindle cw; feed 0 -15 0; "
       "feed 0 -20 0; orient; rapid 1 -20 2; rapid 1 0 2; rapid 0 0 0; spindle cw"},
      {"J and K aside, I along the hole in the YZ plane", "M3\nG19 G87 X-20 R0 J1 K2 I-15",
       "spindle cw; rapid 0 1 2; orient; rapid -20 1 2; rapid -20 0 0; spindle cw; feed -15 0 0; "
       "feed -20 0 0; orient; rapid -20 1 2; rapid 0 1 2; rapid 0 0 0; spindle cw"},
      // The tool stops at the machine's angle, wherever the work lies: the hole turns, I does not.
      {"I and J are not turned with the work", "M3\nG68 R90\nG87 X10 Y0 Z-20 R0 I1 J0 K-15",
       "spindle cw; rapid 0 10 0; rapid 1 10 0; orient; rapid 1 10 -20; rapid 0 10 -20; "
       "spindle cw; feed 0 10 -15; feed 0 10 -20; orient; rapid 1 10 -20; rapid 1 10 0; "
       "rapid 0 10 0; spindle cw"},
      {"I J K stay for the next hole", "M3\nG87 Z-20 R0 I1 J0 K-15\nX5",
       "spindle cw; rapid 1 0 0; orient; rapid 1 0 -20; rapid 0 0 -20; spindle cw; feed 0 0 -15; "
       "feed 0 0 -20; orient; rapid 1 0 -20; rapid 1 0 0; rapid 0 0 0; spindle cw; rapid 5 0 0; "
       "rapid 6 0 0; orient; rapid 6 0 -20; rapid 5 0 -20; spindle cw; feed 5 0 -15; "
       "feed 5 0 -20; orient; rapid 6 0 -20; rapid 6 0 0; rapid 5 0 0; spindle cw"},
  }));
  INFO(row.rule);
  CHECK(moves_of(std::string("F100\n") + row.text) == row.expected);
}

TEST_CASE("G88 stops for the operator and goes on at the clear level", "[GCO-3]") {
  CHECK(moves_of("F100 M3\nG88 Z-5 R1 P0.5") ==
        "spindle cw; rapid 0 0 1; feed 0 0 -5; dwell 0.5; spindle off; stop; rapid 0 0 1; "
        "spindle cw");
}

TEST_CASE("After G88 the program goes on where it is, wherever the operator left the tool",
          "[GCO-3]") {
  Bench bench;
  bench.world = [](const Command&, Answer answer) {
    answer.position[Axis::Y] = 50.0;
    answer.position[Axis::Z] = 80.0;
    return answer;
  };
  const Outcome outcome = bench.run("F100 M3\nG88 X3 Z-5 R1 P0\nG91 G0 X1\n");
  const auto stop = std::ranges::find(outcome.lines, "PROGRAM_STOP()");
  CHECK(std::vector<std::string>(stop, outcome.lines.end()) ==
        std::vector<std::string>{
            "PROGRAM_STOP()",
            "STRAIGHT_TRAVERSE(3.000000, 0.000000, 1.000000, 0.000000, 0.000000, 0.000000)",
            "START_SPINDLE_CLOCKWISE()",
            "STRAIGHT_TRAVERSE(4.000000, 0.000000, 1.000000, 0.000000, 0.000000, 0.000000)",
            "PROGRAM_END()"});
}

TEST_CASE("After G99 R under G91 counts from R of the line before", "[GCO-3]") {
  // Literally the manual: R is an increment from the current position, which G99 left at R.
  CHECK(moves_of("F100\nG91 G99 G81 X1 Z-3 R-2\nX1") ==
        "rapid 1 0 0; rapid 1 0 -2; feed 1 0 -5; rapid 1 0 -2; "
        "rapid 2 0 -2; rapid 2 0 -4; feed 2 0 -7; rapid 2 0 -4");
}
