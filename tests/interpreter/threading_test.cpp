// G76: manual 3.4.19, docs/threading.md.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

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

/// The synchronised moves of a program, each with where it begins.
struct Cut {
  Position begin;
  Position end;
  double pitch = 0.0;
};

std::vector<Cut> cuts_of(std::string_view text) {
  std::vector<Cut> cuts;
  Position at;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) at = rapid->end;
    if (const auto* sync = std::get_if<SyncMove>(&command.body)) {
      cuts.push_back({at, sync->end, sync->pitch});
      at = sync->end;
    }
  };
  const auto program = Program::from_text(std::string(text), "test.ngc").value();
  const CheckReport report = check(program, {}, {}, {}, {}, options);
  if (!report.errors.empty()) throw std::runtime_error(report.errors[0].to_string());
  return cuts;
}

/// X of the cuts.
std::vector<double> bottoms_of(std::string_view text) {
  std::vector<double> bottoms;
  for (const Cut& cut : cuts_of(text)) bottoms.push_back(cut.end[Axis::X]);
  return bottoms;
}

}  // namespace

TEST_CASE("The manual's example: from X15 to X14 in ten passes, Z20 to Z10", "[GCO-7]") {
  const std::vector<Cut> cuts = cuts_of("G18 S500 M3\nG0 X20 Z20\nG76 P1.0 Z10 I15 J0.1 K1.0\n");
  REQUIRE(cuts.size() == 10);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    INFO("pass " << i + 1);
    CHECK(cuts[i].end[Axis::X] == Approx(15.0 - 0.1 * static_cast<double>(i + 1)));
    CHECK(cuts[i].begin[Axis::X] == cuts[i].end[Axis::X]);
    CHECK(cuts[i].begin[Axis::Z] == 20.0);
    CHECK(cuts[i].end[Axis::Z] == 10.0);
    CHECK(cuts[i].pitch == 1.0);
  }
}

TEST_CASE("The moves of G76", "[GCO-7]") {
  const auto row = GENERATE(values<Row>({
      {"in and out along X, back along the drive line", "G0 X20 Z20\nG76 P1 Z10 I15 J0.5 K1",
       "rapid 20 0 20; rapid 14.5 0 20; thread 14.5 0 10 by 1; rapid 20 0 10; rapid 20 0 20; "
       "rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20"},
      {"from inside, an internal thread", "G0 X10 Z20\nG76 P1 Z10 I12 J1 K1",
       "rapid 10 0 20; rapid 13 0 20; thread 13 0 10 by 1; rapid 10 0 10; rapid 10 0 20"},
      {"away from the chuck", "G0 X20 Z10\nG76 P1 Z20 I15 J1 K1",
       "rapid 20 0 10; rapid 14 0 10; thread 14 0 20 by 1; rapid 20 0 20; rapid 20 0 10"},
      {"spring passes", "G0 X20 Z20\nG76 P1 Z10 I15 J1 K1 H2",
       "rapid 20 0 20; rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20; "
       "rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20; "
       "rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20"},
      {"a first cut deeper than the thread ends at its depth", "G0 X20 Z20\nG76 P1 Z10 I15 J3 K1",
       "rapid 20 0 20; rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20"},
      {"Z is a distance under G91, I is not", "G0 X20 Z20\nG91 G76 P1 Z-10 I15 J1 K1",
       "rapid 20 0 20; rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20"},
      {"from the work offset", "G0 X20 Z20\nG92 X30 Z0\nG76 P1 Z-10 I25 J1 K1",
       "rapid 20 0 20; rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20"},
      // 1 inch: X 25.4, peak 0.5 inch = 12.7, depth 0.1 inch = 2.54, pitch 0.05 inch = 1.27.
      {"in inches", "G20 G0 X1 Z1\nG76 P.05 Z0 I.5 J.1 K.1",
       "rapid 25.4 0 25.4; rapid 10.16 0 25.4; thread 10.16 0 0 by 1.27; rapid 25.4 0 0; "
       "rapid 25.4 0 25.4"},
  }));
  INFO(row.rule);
  CHECK(moves_of(std::string("G18 M3\n") + row.text) == std::string("spindle cw; ") + row.expected);
}

TEST_CASE("R makes the later cuts of G76 smaller", "[GCO-7]") {
  const std::string start = "G18 M3\nG0 X20 Z20\n";
  // Depth of pass n: J n^(1/R). R2 is constant area: 0.3 sqrt(n) reaches 1 after (1/0.3)^2 = 11.1
  // passes, so the twelfth is at full depth.
  const std::vector<double> area = bottoms_of(start + "G76 P1 Z10 I15 J0.3 K1 R2");
  REQUIRE(area.size() == 12);
  CHECK(area[0] == Approx(14.7));
  CHECK(area[1] == Approx(15.0 - 0.3 * std::sqrt(2.0)));
  CHECK(area[3] == Approx(15.0 - 0.6));
  CHECK(area[8] == Approx(15.0 - 0.9));
  CHECK(area[11] == 14.0);
  // R1 is constant depth: 0.3 0.6 0.9 1.
  CHECK(bottoms_of(start + "G76 P1 Z10 I15 J0.3 K1 R1") ==
        bottoms_of(start + "G76 P1 Z10 I15 J0.3 K1"));
  CHECK(bottoms_of(start + "G76 P1 Z10 I15 J0.3 K1").size() == 4);
}

TEST_CASE("Q moves deeper cuts of G76 along the drive line", "[GCO-7]") {
  // tan 30 degrees: 0.5 deep is 0.288675 further on, at both ends; the deepest cut ends at Z.
  const double slope = std::tan(std::numbers::pi / 6.0);
  const std::vector<Cut> cuts = cuts_of("G18 M3\nG0 X20 Z20\nG76 P1 Z10 I15 J0.5 K1 Q30");
  REQUIRE(cuts.size() == 2);
  CHECK(cuts[0].begin[Axis::Z] == Approx(20.0 - 0.5 * slope));
  CHECK(cuts[0].end[Axis::Z] == Approx(10.0 + 0.5 * slope));
  CHECK(cuts[1].begin[Axis::Z] == Approx(20.0 - 1.0 * slope));
  CHECK(cuts[1].end[Axis::Z] == Approx(10.0));
}

TEST_CASE("Tapers of G76 keep the pitch along Z", "[GCO-7]") {
  const std::string start = "G18 M3\nG0 X20 Z20\n";
  // E2 and K1: 2 along Z, 1 along X; sqrt(5) of way per 2 of Z, at pitch 1 that is 1.118 per turn.
  const double slope_pitch = std::sqrt(5.0) / 2.0;

  const std::vector<Cut> none = cuts_of(start + "G76 P1 Z10 I15 J1 K1 E2 L0");
  CHECK(none.size() == 1);

  const std::vector<Cut> entry = cuts_of(start + "G76 P1 Z10 I15 J1 K1 E2 L1");
  REQUIRE(entry.size() == 2);
  CHECK(entry[0].begin[Axis::X] == 15.0);
  CHECK(entry[0].begin[Axis::Z] == 20.0);
  CHECK(entry[0].end[Axis::X] == 14.0);
  CHECK(entry[0].end[Axis::Z] == 18.0);
  CHECK(entry[0].pitch == Approx(slope_pitch));
  CHECK(entry[1].end[Axis::Z] == 10.0);
  CHECK(entry[1].pitch == 1.0);

  const std::vector<Cut> exit = cuts_of(start + "G76 P1 Z10 I15 J1 K1 E2 L2");
  REQUIRE(exit.size() == 2);
  CHECK(exit[0].end[Axis::X] == 14.0);
  CHECK(exit[0].end[Axis::Z] == 12.0);
  CHECK(exit[1].end[Axis::X] == 15.0);
  CHECK(exit[1].end[Axis::Z] == 10.0);
  CHECK(exit[1].pitch == Approx(slope_pitch));

  // Both, half of the drive line each: nothing straight is left.
  const std::vector<Cut> both = cuts_of(start + "G76 P1 Z10 I15 J1 K1 E5 L3");
  REQUIRE(both.size() == 2);
  CHECK(both[0].end[Axis::Z] == 15.0);
  CHECK(both[1].end[Axis::Z] == 10.0);

  // A drive line at X15.2: the taper of the first cut, 14.5 + 1, ends there.
  const std::vector<Cut> close = cuts_of("G18 M3\nG0 X15.2 Z20\nG76 P1 Z10 I15 J0.5 K1 E2 L1");
  REQUIRE(close.size() == 4);
  CHECK(close[0].begin[Axis::X] == Approx(15.2));
}

TEST_CASE("Under G64 a thread is cut in exact path mode", "[GCO-7]") {
  const std::string commands = commands_of("G18 G64 P0.1 M3\nG0 X20 Z20\nG76 P1 Z10 I15 J1 K1");
  CHECK(commands.find("SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH); STRAIGHT_TRAVERSE") !=
        std::string::npos);
  CHECK(commands.ends_with("; SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, P0.100000)"));
}

TEST_CASE("Threads that are an error", "[GCO-7][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"the XY plane", "G17\nG76 P1 Z10 I15 J1 K1", "threading_plane@1"},
      {"the YZ plane", "G19\nG76 P1 Z10 I15 J1 K1", "threading_plane@1"},
      {"a word X", "G76 P1 Z10 X5 I15 J1 K1", "word_unused@12"},
      {"a word Y", "G76 P1 Z10 Y5 I15 J1 K1", "word_unused@12"},
      {"a rotary word", "G76 P1 Z10 A0 I15 J1 K1", "word_unused@12"},
      {"R below 1", "G76 P1 Z10 I15 J1 K1 R0.9", "word_out_of_range@22"},
      {"no P", "G76 Z10 I15 J1 K1", "word_missing@1"},
      {"no I", "G76 P1 Z10 J1 K1", "word_missing@1"},
      {"no J", "G76 P1 Z10 I15 K1", "word_missing@1"},
      {"no K", "G76 P1 Z10 I15 J1", "word_missing@1"},
      {"no Z", "G76 P1 X10 I15 J1 K1", "word_unused@8"},
      {"no axis word", "G76 P1 I15 J1 K1", "axis_words_missing@1"},
      {"negative P", "G76 P-1 Z10 I15 J1 K1", "word_out_of_range@5"},
      {"P0", "G76 P0 Z10 I15 J1 K1", "word_out_of_range@5"},
      {"negative J", "G76 P1 Z10 I15 J-1 K1", "word_out_of_range@16"},
      {"J0", "G76 P1 Z10 I15 J0 K1", "word_out_of_range@16"},
      {"negative K", "G76 P1 Z10 I15 J1 K-1", "word_out_of_range@19"},
      {"K0", "G76 P1 Z10 I15 J1 K0", "word_out_of_range@19"},
      {"negative H", "G76 P1 Z10 I15 J1 K1 H-1", "word_out_of_range@22"},
      {"H1.5", "G76 P1 Z10 I15 J1 K1 H1.5", "word_out_of_range@22"},
      {"negative I: an offset in other controls", "G76 P1 Z10 I-5 J1 K1", "word_out_of_range@12"},
      {"negative Q", "G76 P1 Z10 I15 J1 K1 Q-5", "word_out_of_range@22"},
      {"Q81", "G76 P1 Z10 I15 J1 K1 Q81", "word_out_of_range@22"},
      {"negative E", "G76 P1 Z10 I15 J1 K1 E-1 L1", "word_out_of_range@22"},
      {"E above half the drive line", "G76 P1 Z10 I15 J1 K1 E5.1 L1", "threading_too_short@22"},
      {"E above half the drive line, though not used", "G76 P1 Z10 I15 J1 K1 E5.1",
       "threading_too_short@22"},
      {"tapers that leave no room for the slide", "G76 P1 Z10 I15 J1 K1 E5 L3 Q30",
       "threading_too_short@8"},
      {"a drive line without length", "G76 P1 Z20 I15 J1 K1", "threading_too_short@8"},
      {"L4", "G76 P1 Z10 I15 J1 K1 E1 L4", "word_out_of_range@25"},
      {"L1.5", "G76 P1 Z10 I15 J1 K1 E1 L1.5", "word_out_of_range@25"},
      {"a taper without length", "G76 P1 Z10 I15 J1 K1 L1", "word_missing@1"},
      {"a start on the peak", "G76 P1 Z10 I20 J1 K1", "threading_start@1"},
      {"a start behind the turning axis", "G0 X-20\nG76 P1 Z10 I15 J1 K1", "threading_start@1"},
      {"deeper than the turning axis", "G76 P1 Z10 I5 J1 K6", "word_out_of_range@18"},
      {"passes without end", "G76 P1 Z10 I15 J0.0001 K1", "word_out_of_range@16"},
      {"passes without end by R", "G76 P1 Z10 I15 J0.1 K1 R9", "word_out_of_range@16"},
      {"spindle off", "M5\nG76 P1 Z10 I15 J1 K1", "spindle_not_turning@1"},
      {"constant surface speed", "G96 S10\nG76 P1 Z10 I15 J1 K1", "thread_in_surface_speed@1"},
      {"rotation", "G68 R10\nG76 P1 Z10 I15 J1 K1", "threading_transformed@1"},
      {"a bare axis word behind it", "G76 P1 Z10 I15 J1 K1\nX30", "word_missing@1"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(std::string("G18 M3\nG0 X20 Z20\n") + row.text) == row.expected);
}
