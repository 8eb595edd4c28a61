// Search mode: what has to be true before a program goes on at a line (JOB-3).
#include <algorithm>
#include <catch2/catch.hpp>
#include <fmt/format.h>

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

TEST_CASE("A search within a compensated contour goes on along the compensated path",
          "[JOB-3][GCO-5]") {
  // A tool of 1 mm radius left of the path: inside corners at (30, 0) and (30, 20), outside corners
  // at (10, 20) and (10, 40); Z goes down between two moves of the contour.
  constexpr std::string_view kText =
      "G0 X0 Y0 Z5\n"   // 1
      "F60 G41.1 D2\n"  // 2
      "G1 X10 Y0\n"     // 3
      "X30\n"           // 4
      "F120\n"          // 5
      "Y20\n"           // 6
      "Z0\n"            // 7
      "X10\n"           // 8
      "Y40\n"           // 9
      "X30\n"           // 10
      "G40\n"           // 11
      "G0 X0\n";        // 12
  Bench bench;
  const Outcome whole = bench.run(kText);
  REQUIRE_FALSE(whole.failed);
  const auto line = GENERATE(3U, 4U, 5U, 6U, 7U, 8U, 9U, 10U, 11U, 12U);
  INFO("line " << line);
  Search search;
  REQUIRE(search.run(kText, line) == Progress::found);
  const ResumePoint point = search.interpreter.resume_point();
  CHECK(point.line == line);

  SECTION("the rest is that of the whole run, and begins where the move before it ended") {
    search.interpreter.leave_search(point.position);
    std::vector<std::string> rest;
    while (search.interpreter.next() == Progress::command) {
      rest.push_back(interp::text_of(search.interpreter.command()));
    }
    REQUIRE(rest.size() < whole.lines.size());
    const auto tail = whole.lines.end() - static_cast<std::ptrdiff_t>(rest.size());
    CHECK(std::equal(tail, whole.lines.end(), rest.begin()));
    const auto is_move = [](const std::string& text) {
      return text.starts_with("STRAIGHT") || text.starts_with("ARC");
    };
    const auto before = std::find_if(std::reverse_iterator(tail), whole.lines.rend(), is_move);
    REQUIRE(before != whole.lines.rend());
    // An arc's text begins with its end in the plane too.
    const std::string end =
        fmt::format("({:.6f}, {:.6f},", point.position[Axis::X], point.position[Axis::Y]);
    CHECK_THAT(*before, Catch::Contains(end));
    const auto is_feed = [](const std::string& text) { return text.starts_with("SET_FEED_RATE"); };
    const auto feed = std::find_if(std::reverse_iterator(tail), whole.lines.rend(), is_feed);
    if (feed != whole.lines.rend()) {
      CHECK(*feed == fmt::format("SET_FEED_RATE({:.6f})", point.modal.feed));
    }
  }
  SECTION("a machine that stands elsewhere enters the contour again") {
    search.interpreter.leave_search({-50, -50, 5});
    CHECK(search.interpreter.position()[Axis::X] == -50.0);
    REQUIRE(search.interpreter.next() == Progress::command);
    CHECK(search.interpreter.command().source.line >= line);
  }
}

TEST_CASE("A search measures no head: nobody has moved it", "[JOB-3][GCO-11]") {
  Search search;
  search.bench.settings.machine.head_offset.at(static_cast<std::size_t>(Head::probe)) = {7, 8, 9};
  Interpreter interpreter{search.bench.settings, search.bench.parameters, search.bench.tools};
  const auto program = Program::from_text("M90\nG0 X40\nM95 Q1\nG0 X1\nG0 X2\n", "job").value();
  interpreter.start(program, {}, {.mode = RunMode::search, .search_line = 5});
  REQUIRE(interpreter.next() == Progress::found);
  CHECK(interpreter.resume_point().modal.head == Head::probe);
  CHECK(interpreter.resume_point().head_offset == Position{7, 8, 9});
  CHECK(interpreter.position()[Axis::X] == 8.0);  // X1 and 7
}

TEST_CASE("A search meets errors like a run", "[JOB-3]") {
  Search search;
  CHECK(search.run("G0 X1\nG77\nG0 X2\n", 3) == Progress::failed);
  CHECK(search.interpreter.diagnostic().line == 2);
}
