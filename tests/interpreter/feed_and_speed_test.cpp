// G93 G94 G95, G96 G97, F and S: manual 3.4.24, 3.4.25.
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

TEST_CASE("What F counts", "[GCO-7]") {
  const auto row = GENERATE(values<Row>({
      {"G94: mm per minute", "F600", "SET_FEED_RATE(10.000000)"},
      // F6: ten seconds a move, the manual's example; 0.1 moves per second.
      {"G93: moves per minute", "G93 F6", "SET_FEED_RATE(0.100000, INVERSE_TIME)"},
      {"G95: mm per revolution", "G95 F2", "SET_FEED_RATE(2.000000, PER_REVOLUTION)"},
      {"G95 under G20: inches per revolution", "G20\nG95 F.01",
       "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_FEED_RATE(0.254000, PER_REVOLUTION)"},
      {"F is in the unit of its line", "G95 F.01 G20",
       "SET_FEED_RATE(0.254000, PER_REVOLUTION); USE_LENGTH_UNITS(CANON_UNITS_INCHES)"},
  }));
  INFO(row.rule);
  CHECK(commands_of(row.text) == row.expected);
}

TEST_CASE("Per revolution F means degrees where only rotary axes move", "[GCO-7]") {
  CHECK(commands_of("G20\nM3 G95 F.5\nG1 A90\nX1") ==
        "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_FEED_RATE(12.700000, PER_REVOLUTION); "
        "START_SPINDLE_CLOCKWISE(); SET_FEED_RATE(0.500000, PER_REVOLUTION); "
        "STRAIGHT_FEED(0.000000, 0.000000, 0.000000, 90.000000, 0.000000, 0.000000); "
        "SET_FEED_RATE(12.700000, PER_REVOLUTION); "
        "STRAIGHT_FEED(25.400000, 0.000000, 0.000000, 90.000000, 0.000000, 0.000000)");
}

TEST_CASE("Feed modes that are an error", "[GCO-7][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"F of G94 is none of G95", "F100 M3\nG95 G1 X1", "feed_not_set@5"},
      {"F of G95 is none of G94", "M3 G95 F1\nG94 G1 X1", "feed_not_set@5"},
      {"per revolution with the spindle off", "G95 F1\nG1 X1", "feed_without_spindle@1"},
      {"an arc per revolution with the spindle off", "G95 F1\nG2 X1 R1", "feed_without_spindle@1"},
      {"negative F", "G95 F-1", "word_out_of_range@5"},
      {"two feed modes", "G94 G95", "modal_group_conflict@5"},
      {"two spindle modes", "G96 G97 S100", "modal_group_conflict@5"},
      {"G95 moves nothing", "G95 X1", "axis_words_not_allowed@5"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("What S counts", "[GCO-7]") {
  const auto row = GENERATE(values<Row>({
      {"G97: rpm", "S500", "SET_SPINDLE_SPEED(500.000000)"},
      // 150 m/min = 2500 mm/s. At X100, that is 150 / (2 pi 0.1 m) = 238.7 rpm, says the manual.
      {"G96: metres per minute, D limits", "G96 S150 D1000",
       "SET_SURFACE_SPEED(2500.000000, D1000.000000)"},
      {"G96 without a limit", "G96 S60", "SET_SURFACE_SPEED(1000.000000)"},
      // 500 feet/min = 152400 mm/min = 2540 mm/s.
      {"G96 under G20: feet per minute", "G20\nG96 S500",
       "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_SURFACE_SPEED(2540.000000)"},
      {"S is in the unit of its line", "G96 S500 G20",
       "SET_SURFACE_SPEED(2540.000000); USE_LENGTH_UNITS(CANON_UNITS_INCHES)"},
      {"a line of macros: M3 first", "M3 G96 S60 D2000",
       "SET_SURFACE_SPEED(1000.000000, D2000.000000); START_SPINDLE_CLOCKWISE()"},
      {"S alone keeps mode and limit", "G96 S60 D2000\nS120",
       "SET_SURFACE_SPEED(1000.000000, D2000.000000); SET_SURFACE_SPEED(2000.000000, "
       "D2000.000000)"},
      {"D alone keeps the speed", "G96 S60\nG96 D2000",
       "SET_SURFACE_SPEED(1000.000000); SET_SURFACE_SPEED(1000.000000, D2000.000000)"},
      {"the limit of the chuck outlasts G97", "G96 S60 D2000\nG97 S500\nG96 S60",
       "SET_SURFACE_SPEED(1000.000000, D2000.000000); SET_SPINDLE_SPEED(500.000000); "
       "SET_SURFACE_SPEED(1000.000000, D2000.000000)"},
      {"G97 S: rpm again", "G96 S60\nG97 S2000 M3",
       "SET_SURFACE_SPEED(1000.000000); SET_SPINDLE_SPEED(2000.000000); START_SPINDLE_CLOCKWISE()"},
      {"G97 where it is in force changes nothing", "S500\nG97", "SET_SPINDLE_SPEED(500.000000)"},
  }));
  INFO(row.rule);
  CHECK(commands_of(row.text) == row.expected);
}

TEST_CASE("Spindle modes that are an error", "[GCO-7][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"negative D", "G96 S60 D-1", "word_out_of_range@9"},
      {"D0", "G96 S60 D0", "word_out_of_range@9"},
      {"G96 without S: rpm are no surface speed", "S500\nG96", "word_missing@1"},
      {"G97 without S: a surface speed is no rpm", "G96 S60\nG97", "word_missing@1"},
      {"negative S", "G96 S-60", "word_out_of_range@5"},
      {"D without G96", "G97 S60 D100", "word_unused@9"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("A refused G96 leaves mode, speed and limit as they were", "[GCO-7]") {
  const Outcome outcome = run("S500\nG96 S60 D0");
  REQUIRE(outcome.failed);
  CHECK_FALSE(outcome.modal.speed_by_surface);
  CHECK(outcome.modal.speed == 500.0);
  CHECK_FALSE(outcome.modal.max_speed.has_value());
}

TEST_CASE("The end of a program ends constant surface speed", "[GCO-7]") {
  const auto code = GENERATE(as<std::string>{}, "M2", "M30");
  const Outcome outcome = run("G96 S60 D2000 M3\n" + code + "\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK_FALSE(outcome.modal.speed_by_surface);
  CHECK_FALSE(outcome.modal.max_speed.has_value());
  CHECK(outcome.modal.speed == 0.0);
  REQUIRE(outcome.lines.size() == 5);
  CHECK(outcome.lines[2] == "STOP_SPINDLE_TURNING()");
  CHECK(outcome.lines[3] == "SET_SPINDLE_SPEED(0.000000)");
}

TEST_CASE("Feed and spindle modes are shown, F and S as they were written", "[GCO-7][GUI-2]") {
  CHECK(run("G95 F0.2\nG96 S150 D1000 M3").modal.active_codes() ==
        "G80 G17 G21 G40 G49 G54 G61 G90 G95 G96 M3 M9 M48 T0 F0.2 S150");
  CHECK(run("G20\nG95 F.01\nG96 S500").modal.active_codes() ==
        "G80 G17 G20 G40 G49 G54 G61 G90 G95 G96 M5 M9 M48 T0 F0.01 S500");
  CHECK(run("G93 F6\nS800").modal.active_codes() ==
        "G80 G17 G21 G40 G49 G54 G61 G90 G93 G97 M5 M9 M48 T0 F6 S800");
}

TEST_CASE("#5070 is the measured speed of the spindle", "[GCO-7]") {
  Bench bench;
  bench.world = [](const Command&, Answer answer) {
    answer.live.spindle_speed = 9.8;
    return answer;
  };
  const Outcome outcome = bench.run("S600 M3\n#1=#5070\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(bench.parameters.get(1) == 9.8);
}
