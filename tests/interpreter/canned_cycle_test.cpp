// G73 G81 G82 G83 G85 G86 G89, G98 G99: manual 3.4.21 and 3.4.26.
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

/// "rapid 1 2 3; feed 1 2 0; dwell 1; spindle off" of a program, machine coordinates.
std::string moves_of(Bench& bench, std::string_view text) {
  std::vector<std::string> moves;
  const auto add = [&](const char* kind, const Position& p) {
    moves.push_back(fmt::format("{} {:g} {:g} {:g}", kind, p[Axis::X], p[Axis::Y], p[Axis::Z]));
  };
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) add("rapid", rapid->end);
    if (const auto* feed = std::get_if<FeedMove>(&command.body)) add("feed", feed->end);
    if (const auto* dwell = std::get_if<Dwell>(&command.body)) {
      moves.push_back(fmt::format("dwell {:g}", dwell->duration));
    }
    if (const auto* spindle = std::get_if<TurnSpindle>(&command.body)) {
      moves.emplace_back(spindle->direction == SpindleDirection::off ? "spindle off"
                                                                     : "spindle on");
    }
  };
  const auto program = Program::from_text(std::string(text), "test.ngc").value();
  const CheckReport report =
      check(program, bench.settings, bench.parameters, bench.tools, bench.start, options);
  if (!report.errors.empty()) return report.errors[0].to_string();
  return fmt::format("{}", fmt::join(moves, "; "));
}

std::string moves_of(std::string_view text) {
  Bench bench;
  return moves_of(bench, text);
}

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
       "spindle on; feed 0 0 -1; dwell 0.5; spindle off; rapid 0 0 0; spindle on"},
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
      {"tapping is not known", "G84 Z-1 R0", "unknown_g_code@1"},
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
