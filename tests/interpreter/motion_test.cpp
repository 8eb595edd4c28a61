// G0 G1 G4 G28 G30 G53 G80 G90 G91 G93 G94 G20 G21: manual 3.4.
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

TEST_CASE("Straight moves", "[GCO-2]") {
  const auto row = GENERATE(values<Row>({
      {"omitted axes stay", "G0 X1 Y2\nZ3",
       "STRAIGHT_TRAVERSE(1.000000, 2.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(1.000000, 2.000000, 3.000000, 0.000000, 0.000000, 0.000000)"},
      {"F is per minute, the command per second", "G1 X1 F60",
       "SET_FEED_RATE(1.000000); STRAIGHT_FEED(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"increments add up", "G91 G0 X1\nX1 A5\nX1",
       "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(2.000000, 0.000000, 0.000000, 5.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(3.000000, 0.000000, 0.000000, 5.000000, 0.000000, 0.000000)"},
      {"inches are 25.4 mm, degrees stay", "G20 G0 X1 A90",
       "USE_LENGTH_UNITS(CANON_UNITS_INCHES); STRAIGHT_TRAVERSE(25.400000, 0.000000, 0.000000, "
       "90.000000, 0.000000, 0.000000)"},
      {"G70 is G20", "G70 G0 X1",
       "USE_LENGTH_UNITS(CANON_UNITS_INCHES); STRAIGHT_TRAVERSE(25.400000, 0.000000, 0.000000, "
       "0.000000, 0.000000, 0.000000)"},
      {"feed in inches per minute", "G20\nF60",
       "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_FEED_RATE(25.400000)"},
      {"F belongs to the unit of its line", "G20 F60",
       "SET_FEED_RATE(25.400000); USE_LENGTH_UNITS(CANON_UNITS_INCHES)"},
      {"dwell", "G4 P0.5", "DWELL(0.500000)"},
      {"inverse time: F6 is a tenth per second", "G93 G1 X1 F6",
       "SET_FEED_RATE(0.100000, INVERSE_TIME); STRAIGHT_FEED(1.000000, 0.000000, 0.000000, "
       "0.000000, 0.000000, 0.000000)"},
  }));
  INFO(row.rule);
  CHECK(commands_of(row.text) == row.expected);
}

TEST_CASE("In inches the feed of a rotary move stays degrees", "[GCO-2][MOT-8]") {
  CHECK(commands_of("G20\nF60\nG1 A90\nG1 X1\n") ==
        "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_FEED_RATE(25.400000); SET_FEED_RATE(1.000000); "
        "STRAIGHT_FEED(0.000000, 0.000000, 0.000000, 90.000000, 0.000000, 0.000000); "
        "SET_FEED_RATE(25.400000); "
        "STRAIGHT_FEED(25.400000, 0.000000, 0.000000, 90.000000, 0.000000, 0.000000)");
}

TEST_CASE("Straight moves that are an error", "[GCO-2][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"G0 with other words, none of an axis", "G0 P1", "axis_words_missing@1"},
      {"G1 with other words, none of an axis", "F1\nG1 L20", "axis_words_missing@1"},
      {"G1 without feed", "G1 X1", "feed_not_set@1"},
      {"modal G1 after G1 without feed", "G1 F1 X1\nG93 G1 X2 F1\nG94\nX3", "feed_not_set@1"},
      {"feed 0", "G1 X1 F0", "feed_not_set@1"},
      {"negative feed", "G1 X1 F-5", "word_out_of_range@7"},
      {"inverse time without F on the line", "G93 F5\nG1 X1", "inverse_time_feed_missing@1"},
      {"inverse time, G2 without F", "G93\nG2 I1", "inverse_time_feed_missing@1"},
      {"axis words without motion", "X1", "axis_words_not_allowed@1"},
      {"axis words with G80", "G80 X1", "axis_words_not_allowed@5"},
      {"axis words after G80", "G0 X1\nG80\nY1", "axis_words_not_allowed@1"},
      {"G4 without P", "G4", "word_missing@1"},
      {"G4 with negative P", "G4 P-1", "word_out_of_range@4"},
      {"G53 without G0 or G1", "G53 X1", "machine_move_not_straight@1"},
      {"G53 with an arc", "F1\nG2 G53 X1 I1", "machine_move_not_straight@4"},
      {"G53 without axis words", "G0 G53", "axis_words_missing@4"},
      {"two codes that use the axis words", "G1 G92 X1", "axis_words_claimed_twice@1"},
      {"G28 and G1", "F1\nG1 G28 Z0", "axis_words_claimed_twice@1"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("A motion code beside other codes sets the mode only", "[LNG-11]") {
  const Outcome outcome = run("G01 F6\nX1\nG00 G90 G17 S3000\nX2\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.lines[1].starts_with("STRAIGHT_FEED(1.0"));
  CHECK(outcome.lines[4].starts_with("STRAIGHT_TRAVERSE(2.0"));
}

TEST_CASE("G53 moves in machine coordinates, offsets and G91 notwithstanding", "[CRD-1]") {
  Bench bench;
  Position offset;
  offset[Axis::X] = 100;
  offset[Axis::Z] = -50;
  bench.parameters.set_work_offset(1, offset);
  const Outcome outcome = bench.run("G92 X7\nG91 G0 X1\nG53 G0 X-5 Z-1\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.position[Axis::X] == -5.0);
  CHECK(outcome.position[Axis::Z] == -1.0);
  CHECK(bench.run("G20 G0 G53 X1\n").position[Axis::X] == 25.4);
}

TEST_CASE("G28 and G30 go by way of the programmed point; only named axes go on", "[CRD-3]") {
  Bench bench;
  bench.start[Axis::X] = 10;
  bench.start[Axis::Z] = -20;
  Position home;
  home[Axis::X] = 1;
  home[Axis::Y] = 2;
  home[Axis::Z] = 3;
  bench.parameters.set_g28_position(home);
  CHECK(bench.run("G28\n").lines ==
        std::vector<std::string>{
            "STRAIGHT_TRAVERSE(1.000000, 2.000000, 3.000000, 0.000000, 0.000000, 0.000000)",
            "PROGRAM_END()"});
  CHECK(bench.run("G91 G28 Z5\n").lines ==
        std::vector<std::string>{
            "STRAIGHT_TRAVERSE(10.000000, 0.000000, -15.000000, 0.000000, 0.000000, 0.000000)",
            "STRAIGHT_TRAVERSE(10.000000, 0.000000, 3.000000, 0.000000, 0.000000, 0.000000)",
            "PROGRAM_END()"});
  bench.parameters.set_g30_position(home * 2.0);
  CHECK(bench.run("G30\n").position[Axis::Y] == 4.0);
}

TEST_CASE("G0 beside G28 sets the mode; the axis words are those of G28", "[CRD-3]") {
  Bench bench;
  bench.start[Axis::X] = 7;
  bench.start[Axis::Z] = -5;
  const Outcome outcome = bench.run("F60 G1 G91 Z-1\nG0 G28 Z2\nX1\n");
  // X goes on in increments and at rapid: 7 + 1.
  CHECK(outcome.position[Axis::X] == 8.0);
  CHECK(outcome.position[Axis::Z] == 0.0);
  CHECK(outcome.modal.motion == 0);
  CHECK(end_of("G0 G92.1 X5")[Axis::X] == 5.0);
}

TEST_CASE("G28 suspends the motion mode for its line only", "[CRD-3]") {
  CHECK(commands_of("G0 X1\nG28 X5\nX2\n")
            .ends_with(
                "STRAIGHT_TRAVERSE(2.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"));
}

TEST_CASE("Path control passes its values on in mm and degrees", "[GCO-6]") {
  const auto row = GENERATE(values<Row>({
      {"exact path", "G61", "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)"},
      {"with words", "G61 Q0.01 R2",
       "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH, Q0.010000, R2.000000)"},
      {"exact stop", "G61.1", "SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)"},
      {"continuous", "G64 P0.1 Q0.02 R3",
       "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, P0.100000, Q0.020000, R3.000000)"},
  }));
  INFO(row.rule);
  CHECK(commands_of(row.text) == row.expected);
  CHECK(commands_of("G20\nG64 P0.01 R4") ==
        "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, "
        "P0.254000, R4.000000)");
  CHECK(refusal_of("G64 P-0.1") == "word_out_of_range@5");
  CHECK(refusal_of("G61 P0.1") == "word_unused@5");
}

TEST_CASE("A program starts at any line, and the position comes from the world", "[JOB-3]") {
  Bench bench;
  const auto program = Program::from_text("G0 X1\nG0 Y1\nG0 Z1\n", "three").value();
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  Position start;
  start[Axis::A] = 30;
  interpreter.start(program, start, {.line = 2});
  CHECK(interpreter.next_line() == 2);
  REQUIRE(interpreter.next() == Progress::command);
  CHECK(interpreter.command().source == SourceLine{0, 2});
  CHECK(text_of(interpreter.command()) ==
        "STRAIGHT_TRAVERSE(0.000000, 1.000000, 0.000000, 30.000000, 0.000000, 0.000000)");
  Position moved = interpreter.position();
  moved[Axis::X] = 9;
  interpreter.set_position(moved);
  REQUIRE(interpreter.next() == Progress::command);
  CHECK(text_of(interpreter.command()) ==
        "STRAIGHT_TRAVERSE(9.000000, 1.000000, 1.000000, 30.000000, 0.000000, 0.000000)");
}
