// G33 G33.1: manual 3.4.9.
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

TEST_CASE("G33 moves K per revolution of the spindle", "[GCO-7]") {
  const auto row = GENERATE(values<Row>({
      {"one way", "M3\nG33 Z-10 K1.5", "spindle cw; thread 0 0 -10 by 1.5"},
      {"with a spindle that turns the other way", "M4\nG33 Z-10 K1.5",
       "spindle ccw; thread 0 0 -10 by 1.5"},
      {"all of X Y Z", "M3\nG33 X3 Y4 Z-10 K2", "spindle cw; thread 3 4 -10 by 2"},
      {"under G91", "M3\nG0 Z5\nG91 G33 Z-10 K1", "spindle cw; rapid 0 0 5; thread 0 0 -5 by 1"},
      // 0.05 inch = 1.27 mm.
      {"in inches", "M3\nG20 G33 Z-1 K.05", "spindle cw; thread 0 0 -25.4 by 1.27"},
      {"stays in force, K on every line", "M3\nG33 Z-10 K1\nZ-12 X1 K2",
       "spindle cw; thread 0 0 -10 by 1; thread 1 0 -12 by 2"},
      {"needs no F, whatever the feed mode", "M3\nG93 G33 Z-10 K1",
       "spindle cw; thread 0 0 -10 by 1"},
      {"a rotary axis may stand on the line as long as it stays", "M3\nG33 Z-10 A0 K1",
       "spindle cw; thread 0 0 -10 by 1"},
  }));
  INFO(row.rule);
  CHECK(moves_of(row.text) == row.expected);
}

TEST_CASE("G33.1 comes back with the spindle reversed, which then turns as before", "[GCO-7]") {
  const auto row = GENERATE(values<Row>({
      {"clockwise", "M3\nG0 X1 Z2\nG33.1 Z-10 K1",
       "spindle cw; rapid 1 0 2; thread 1 0 -10 by 1; spindle ccw; thread 1 0 2 by 1; spindle cw"},
      {"counter-clockwise", "M4\nG33.1 Z-10 K1",
       "spindle ccw; thread 0 0 -10 by 1; spindle cw; thread 0 0 0 by 1; spindle ccw"},
      {"the next line begins where it began", "M3\nG33.1 Z-10 K1\nG91 G0 X1",
       "spindle cw; thread 0 0 -10 by 1; spindle ccw; thread 0 0 0 by 1; spindle cw; rapid 1 0 0"},
  }));
  INFO(row.rule);
  CHECK(moves_of(row.text) == row.expected);
  CHECK(run(row.text).modal.spindle != SpindleDirection::off);
}

TEST_CASE("Moves that cannot follow the spindle are refused", "[GCO-7][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"no axis word", "M3\nG33 K1", "axis_words_missing@1"},
      {"no axis word for G33.1", "M3\nG33.1 K1", "axis_words_missing@1"},
      {"spindle off", "G33 Z-1 K1", "spindle_not_turning@1"},
      {"spindle off for G33.1", "G33.1 Z-1 K1", "spindle_not_turning@1"},
      {"spindle stopped again", "M3\nM5\nG33 Z-1 K1", "spindle_not_turning@1"},
      {"spindle stopped by a tool change", "M3\nM6 T1\nG33 Z-1 K1", "spindle_not_turning@1"},
      {"no K", "M3\nG33 Z-1", "word_missing@1"},
      {"no K on the next line", "M3\nG33 Z-1 K1\nZ-2", "word_missing@1"},
      {"K0", "M3\nG33 Z-1 K0", "word_out_of_range@9"},
      {"negative K", "M3\nG33.1 Z-1 K-1", "word_out_of_range@11"},
      {"a rotary axis that turns", "M3\nG33 Z-1 A5 K1", "rotary_axis_would_turn@9"},
      {"constant surface speed", "G96 S10 M3\nG33 Z-1 K1", "thread_in_surface_speed@1"},
      {"machine coordinates", "M3\nG53 G33 Z-1 K1", "machine_move_not_straight@1"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("A check counts threads as cuts and probing as motion", "[GCO-7][GCO-8]") {
  const auto program = Program::from_text("M3 F60\nG33 Z-10 K1\nG38.2 Z-20\nM30\n", "t").value();
  const CheckReport report = check(program, {}, {}, {}, {});
  CHECK(report.cutting.lowest[Axis::Z] == -10.0);
  CHECK(report.motion.lowest[Axis::Z] == -20.0);
}
