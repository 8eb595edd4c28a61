// Search mode: what has to be true before a program goes on at a line (JOB-3).
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Search {
  Bench bench;
  Interpreter interpreter{bench.settings, bench.parameters, bench.tools};

  Progress run(std::string_view text, std::uint32_t line) {
    const auto program = Program::from_text(std::string(text), "job.nc").value();
    interpreter.start(program, {}, {.mode = RunMode::search, .search_line = line});
    Progress progress = interpreter.next();
    while (progress == Progress::working) progress = interpreter.next();
    return progress;
  }
};

}  // namespace

TEST_CASE("A search hands out no command and ends with the complete state", "[JOB-3]") {
  Search search;
  REQUIRE(search.bench.tools.set(4, {.length = 20}).has_value());
  REQUIRE(search.run("G21 G17 G90\n"
                     "T4 M6 G43\n"
                     "G10 L2 P2 X100\n"
                     "G55 S8000 M3 M8\n"
                     "M0\n"
                     "G0 X5 Z10\n"
                     "G1 Y3 F600\n"
                     "G64 P0.1\n"
                     "G1 X7\n",
                     8) == Progress::found);
  const ResumePoint point = search.interpreter.resume_point();
  CHECK(point.line == 8);
  CHECK(point.position[Axis::X] == 105.0);
  CHECK(point.position[Axis::Y] == 3.0);
  CHECK(point.position[Axis::Z] == 30.0);
  CHECK(point.work_position[Axis::X] == 5.0);
  CHECK(point.work_position[Axis::Z] == 10.0);
  CHECK(point.work_offset[Axis::X] == 100.0);
  CHECK(point.tool_length[Axis::Z] == 20.0);
  CHECK(point.modal.tool == 4);
  CHECK(point.modal.work_system == 2);
  CHECK(point.modal.spindle == SpindleDirection::clockwise);
  CHECK(point.modal.speed == 8000.0);
  CHECK(point.modal.flood);
  CHECK(point.modal.feed == 10.0);
  CHECK(point.modal.motion == 10);

  SECTION("and the program goes on there") {
    search.interpreter.leave_search(point.position);
    REQUIRE(search.interpreter.next() == Progress::command);
    CHECK(search.interpreter.command().source == SourceLine{0, 8});
    REQUIRE(search.interpreter.next() == Progress::command);
    CHECK(interp::text_of(search.interpreter.command()) ==
          "STRAIGHT_FEED(107.000000, 3.000000, 30.000000, 0.000000, 0.000000, 0.000000)");
  }
}

TEST_CASE("A search finds lines in loops, in subs, and behind branches not taken", "[JOB-3]") {
  Search search;
  constexpr std::string_view kText =
      "#1 = 0\n"           // 1
      "while [#1 < 5]\n"   // 2
      "  #1 = [#1 + 1]\n"  // 3
      "  G0 X#1\n"         // 4
      "endwhile\n"         // 5
      "if [#1 == 0]\n"     // 6
      "  G0 Y1\n"          // 7
      "endif\n"            // 8
      "gosub a\n"          // 9
      "M30\n"              // 10
      "sub a\n"            // 11
      "  G0 Z1\n"          // 12
      "  G0 Z2\n"          // 13
      "endsub\n";          // 14
  REQUIRE(search.run(kText, 4) == Progress::found);
  CHECK(search.interpreter.position()[Axis::X] == 0.0);
  CHECK(search.interpreter.next_line() == 4);
  REQUIRE(search.run(kText, 7) == Progress::found);
  CHECK(search.interpreter.next_line() == 9);
  CHECK(search.interpreter.position()[Axis::X] == 5.0);
  REQUIRE(search.run(kText, 13) == Progress::found);
  CHECK(search.interpreter.position()[Axis::Z] == 1.0);
}

TEST_CASE("A search for a line that the program never reaches ends with the program", "[JOB-3]") {
  Search search;
  CHECK(search.run("G0 X1\nM30\nG0 X2\n", 3) == Progress::ended);
  CHECK(search.run("G0 X1\n", 100) == Progress::ended);
}

TEST_CASE("A search meets errors like a run", "[JOB-3]") {
  Search search;
  CHECK(search.run("G0 X1\nG77\nG0 X2\n", 3) == Progress::failed);
  CHECK(search.interpreter.diagnostic().line == 2);
}
