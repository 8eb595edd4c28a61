// G38.2 and its results: manual 3.4.10, 3.1.1.
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

Position at(double x, double y, double z) {
  Position position;
  position[Axis::X] = x;
  position[Axis::Y] = y;
  position[Axis::Z] = z;
  return position;
}

/// A machine whose probe trips, or not, at `tripped_at`, and which stands at `stands_at` after it.
Bench machine_with_probe(bool trips, const Position& tripped_at, const Position& stands_at) {
  Bench bench;
  bench.world = [=](const Command& command, Answer answer) {
    if (!std::holds_alternative<ProbeMove>(command.body)) return answer;
    answer.probe_tripped = trips;
    answer.probe_position = tripped_at;
    answer.position = stands_at;
    return answer;
  };
  return bench;
}

}  // namespace

TEST_CASE("G38.2 probes straight towards its end", "[GCO-8]") {
  const auto row = GENERATE(values<Row>({
      {"one axis", "F60\nG38.2 Z-10", "probe 0 0 -10"},
      {"F on its line", "G38.2 X3 Y4 F60", "probe 3 4 0"},
      {"G91 on its line, as macros write it", "G0 Z5\ng38.2 g91 z-20 f30",
       "rapid 0 0 5; probe 0 0 -15"},
      {"in inches", "G20 F1\nG38.2 Z-1", "probe 0 0 -25.4"},
      {"from the work offset", "F60\nG92 Z100\nG38.2 Z90", "probe 0 0 -10"},
      {"G53 in front: machine coordinates", "F60\nG92 Z100\nG53 G38.2 Z-10", "probe 0 0 -10"},
      {"G53 behind: machine coordinates", "F60\nG92 Z100\nG38.2 G53 Z-10", "probe 0 0 -10"},
      {"a rotary axis may stand on the line as long as it stays", "F60\nG38.2 Z-10 A0",
       "probe 0 0 -10"},
      {"the least way, 0.01 inch", "G20 F1\nG38.2 Z-.01", "probe 0 0 -0.254"},
      {"stays in force, as every code of its group", "F60\nG38.2 Z-10\nX5",
       "probe 0 0 -10; probe 5 0 -10"},
      {"where there is no machine it ends at its end", "F60\nG38.2 Z-10\nG91 G0 Z1",
       "probe 0 0 -10; rapid 0 0 -9"},
  }));
  INFO(row.rule);
  CHECK(moves_of(row.text) == row.expected);
}

TEST_CASE("Probe moves that are an error", "[GCO-8][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"closer than 0.254 mm", "G38.2 Z-0.25", "probe_too_close@1"},
      {"closer than 0.01 inch", "G20 F1\nG38.2 Z-.0099", "probe_too_close@1"},
      {"where the machine is", "G38.2 Z0", "probe_too_close@1"},
      {"inverse time", "G93 G38.2 Z-10 F1", "probe_feed_mode@5"},
      {"a feed per revolution", "G95 M3 F0.1\nG38.2 Z-10", "probe_feed_mode@1"},
      {"a rotary axis that turns", "G38.2 Z-10 A1", "rotary_axis_would_turn@12"},
      {"only rotary axes", "G38.2 A0", "axis_words_missing@1"},
      {"no axis word", "G38.2", "axis_words_missing@1"},
      {"no axis word beside other words", "G38.2 F60", "axis_words_missing@1"},
      {"no feed", "F0\nG38.2 Z-10", "feed_not_set@1"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(std::string("F60\n") + row.text) == row.expected);
}

TEST_CASE("A probe's results are machine and work coordinates of where it tripped", "[GCO-8]") {
  Bench bench = machine_with_probe(true, at(1, 2, -57), at(1, 2, -56.8));
  bench.parameters.set_work_offset(1, at(100, 0, -50));
  const Outcome outcome = bench.run("F60\nG38.2 Z-20\n#1=#5063 #2=#5003\n");
  // Machine coordinates.
  CHECK(bench.parameters.get(5051) == 1.0);
  CHECK(bench.parameters.get(5052) == 2.0);
  CHECK(bench.parameters.get(5053) == -57.0);
  CHECK(bench.parameters.get(5083) == -57.0);
  // Work coordinates: machine - offset; X 1 - 100, Z -57 + 50.
  CHECK(bench.parameters.get(5061) == -99.0);
  CHECK(bench.parameters.get(5062) == 2.0);
  CHECK(bench.parameters.get(1) == -7.0);
  CHECK(bench.parameters.get(5067) == 1.0);
  // The machine has retracted: -56.8 + 50.
  CHECK(bench.parameters.get(2) == Approx(-6.8));
  CHECK(outcome.position[Axis::Z] == -56.8);
}

TEST_CASE("Tool length, G92 and inches count in a probe's results", "[GCO-8]") {
  Bench bench = machine_with_probe(true, at(0, 0, -25.4), at(0, 0, -25.4));
  config::Tool tool;
  tool.length = 25.4;
  REQUIRE(bench.tools.set(3, tool).has_value());
  // Work Z = -25.4 - 25.4 (tool) - G92 offset. The tool's tip stands at -1 inch when G92 calls it
  // +1 inch, so the G92 offset is -2 inch and the tip at -2 inch lies at 0.
  const Outcome outcome = bench.run("G20 F1\nG43 H3\nG92 Z1\nG38.2 Z-3\n#1=#5063 #2=#5053\n");
  CHECK(bench.parameters.get(1) == Approx(0.0).margin(1e-12));
  CHECK(bench.parameters.get(2) == Approx(-1.0));
}

TEST_CASE("A probe that does not trip clears #5067 and the program goes on", "[GCO-8]") {
  Bench bench = machine_with_probe(false, at(0, 0, -10), at(0, 0, -10));
  bench.parameters.set(5067, 1);
  // As in the manual's zhcmgrid (2.2.5.5): the program itself asks.
  const Outcome outcome = bench.run(
      "F60\nG38.2 Z-10\nif [#5067 == 1]\n#1=1\nelse\n#1=2\n"
      "endif\n");
  CHECK(bench.parameters.get(1) == 2.0);
  CHECK(outcome.lines.back() == "PROGRAM_END()");
  CHECK(bench.parameters.get(5053) == -10.0);
}

TEST_CASE("After a probe move the next distance counts from where the machine stands", "[GCO-8]") {
  Bench bench = machine_with_probe(true, at(0, 0, -4), at(0, 0, -3.9));
  const Outcome outcome = bench.run("F60\nG38.2 Z-10\nG91 G0 Z1\n");
  CHECK(outcome.position[Axis::Z] == Approx(-2.9));
}
