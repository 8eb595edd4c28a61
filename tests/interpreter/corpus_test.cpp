// Programs that other people wrote, beside what other interpreters made of them: the same geometry.
// Skipped where the corpus is not at hand; corpus_program_test.cpp has a row for every program.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "interpreter/arc_geometry.h"
#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

const std::string kShared = std::string(CNC_SOURCE_DIR) + "/../shared/";
const std::string kCorpus = kShared + "corpus/gcode/";

bool corpus_missing() {
  if (std::filesystem::exists(kCorpus)) return false;
  WARN("The corpus of real programs is not here: test skipped.");
  return true;
}

CheckReport check_file(const std::string& name, const CheckOptions& options = {},
                       const config::ToolTable& tools = {}) {
  const auto program = Program::open(kCorpus + name);
  REQUIRE(program.has_value());
  return check(*program, {}, {}, tools, {}, options);
}

/// A straight move as the corpus and these tests compare them.
struct Stroke {
  bool rapid = false;
  Position end;
};

/// The moves of a file of canonical commands in inches; moves to where the tool is are left out,
/// for interpreters differ in them.
std::vector<Stroke> expected_strokes(const std::string& text) {
  std::vector<Stroke> strokes;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find("STRAIGHT_");
    if (begin == std::string::npos) continue;
    Stroke stroke{.rapid = line.compare(begin, 17, "STRAIGHT_TRAVERSE") == 0, .end = {}};
    double x = 0;
    double y = 0;
    double z = 0;
    const char* numbers = line.c_str() + line.find('(', begin);
    REQUIRE(std::sscanf(numbers, "(%lf, %lf, %lf", &x, &y, &z) == 3);
    stroke.end[Axis::X] = 25.4 * x;
    stroke.end[Axis::Y] = 25.4 * y;
    stroke.end[Axis::Z] = 25.4 * z;
    if (!strokes.empty() && linear_length(strokes.back().end - stroke.end) < 1e-9) continue;
    strokes.push_back(stroke);
  }
  return strokes;
}

/// Where the straight and round moves of a file of canonical commands in inches end, in mm.
std::vector<PlanePoint> expected_ends(const std::string& text) {
  std::vector<PlanePoint> ends;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("STRAIGHT_") == std::string::npos && line.find("ARC_FEED") == std::string::npos) {
      continue;
    }
    PlanePoint end;
    const char* numbers = line.c_str() + line.find('(');
    REQUIRE(std::sscanf(numbers, "(%lf, %lf", &end.first, &end.second) == 2);
    ends.push_back(25.4 * end);
  }
  return ends;
}

/// The tools of INDEX.md, inches of diameter.
config::ToolTable tools_with(std::int32_t number, double inches) {
  config::ToolTable tools;
  REQUIRE(tools.set(number, {.diameter = 25.4 * inches, .description = {}}));
  return tools;
}

}  // namespace

TEST_CASE("The compensated contours of a Haas program fit their tools", "[GCO-4]") {
  if (corpus_missing()) return;
  // Its chip conveyor, for one, is unknown here; its profile and pocket are not at fault.
  config::ToolTable tools = tools_with(1, 0.5);
  REQUIRE(tools.set(2, {.diameter = 25.4 * 0.375, .description = {}}));
  int arcs = 0;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* arc = std::get_if<ArcMove>(&command.body)) arcs += arc->turns != 0 ? 1 : 0;
  };
  const CheckReport report = check_file("enier290188--mill_hp_4.nc", options, tools);
  for (const Diagnostic& error : report.errors) {
    INFO(error.to_string());
    CHECK((error.code < ErrorCode::compensation_offset_change ||
           error.code > ErrorCode::compensation_entry_arc));
  }
  CHECK(report.complete);
  CHECK(arcs >= 6);
}

TEST_CASE("Entry, arcs and corners go where LinuxCNC's expected moves go", "[GCO-4]") {
  if (corpus_missing()) return;
  const auto expected =
      expected_ends(read_file(kCorpus + "linuxcnc--ccomp-line-arc-entry.expected.txt"));
  REQUIRE(expected.size() == 20);
  std::vector<PlanePoint> ends;
  CheckOptions options;
  const auto add = [&](const Position& end) { ends.push_back(in_plane(end, Plane::xy)); };
  options.sink = [&](const Command& command) {
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) add(rapid->end);
    if (const auto* feed = std::get_if<FeedMove>(&command.body)) add(feed->end);
    if (const auto* arc = std::get_if<ArcMove>(&command.body)) add(arc->end);
  };
  REQUIRE(check_file("linuxcnc--ccomp-line-arc-entry.ngc", options, tools_with(4, 1.0)).ok());
  // The manual's entry move (figure A-6) is tangent to the tool where it stands, half an inch to
  // the left of (1, 4): u = (sqrt(3), 1) / 2 turned by -90 degrees. An arc around (1, 4) leads to
  // where LinuxCNC goes at once.
  constexpr std::size_t kEntry = 11;
  REQUIRE(ends.size() == expected.size() + 1);
  CHECK(distance(ends[kEntry], 25.4 * PlanePoint{1 + std::sqrt(3.0) / 4, 4.25}) < 1e-9);
  ends.erase(ends.begin() + kEntry);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    INFO("move " << i);
    CHECK(distance(ends[i], expected[i]) < 1e-9);
  }
}

TEST_CASE("NIST's expressions give the values that their comments state", "[LNG-2]") {
  if (corpus_missing()) return;
  // "n0050 x [2/5] (x should be 0.40)": the comment comes first, then the move.
  std::string comment;
  int compared = 0;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* message = std::get_if<Message>(&command.body)) comment = message->text;
    const auto* move = std::get_if<FeedMove>(&command.body);
    const std::size_t value = comment.find("be ");
    if (move == nullptr || value == std::string::npos) return;
    INFO("line " << command.source.line << ": " << comment);
    CHECK(move->end[Axis::X] == Approx(std::stod(comment.substr(value + 3))).margin(1e-3));
    comment.clear();
    ++compared;
  };
  CHECK(check_file("nist--c2_expressions.ngc", options).ok());
  CHECK(compared > 35);
}

TEST_CASE("The tolerance case of LinuxCNC keeps its end points", "[GCO-2]") {
  if (corpus_missing()) return;
  const CheckReport report = check_file("linuxcnc--good-arc.medium.metric.ngc");
  CHECK(report.motion.highest[Axis::X] == 2000.0);
}

TEST_CASE("G81 goes where LinuxCNC's expected moves go", "[GCO-3]") {
  if (corpus_missing()) return;
  const auto expected = expected_strokes(read_file(kCorpus + "linuxcnc--g17-g98-g81.expected.txt"));
  REQUIRE(expected.size() == 38);
  std::vector<Stroke> strokes;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) {
      strokes.push_back({true, rapid->end});
    }
    if (const auto* feed = std::get_if<FeedMove>(&command.body)) {
      strokes.push_back({false, feed->end});
    }
  };
  REQUIRE(check_file("linuxcnc--g17-g98-g81.ngc", options).ok());
  REQUIRE(strokes.size() == expected.size());
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    INFO("move " << i);
    CHECK(strokes[i].rapid == expected[i].rapid);
    CHECK(linear_length(strokes[i].end - expected[i].end) < 1e-9);
  }
}

namespace {

/// The first three numbers behind the parenthesis: "(1, 2, 3" or "(" X1 Y2 Z3".
Position three_numbers(const std::string& line) {
  std::string numbers = line.substr(line.find('('));
  const auto is_no_digit = [](char c) {
    return std::string_view("-.0123456789").find(c) == std::string_view::npos;
  };
  std::replace_if(numbers.begin(), numbers.end(), is_no_digit, ' ');
  std::istringstream text(numbers);
  Position point;
  REQUIRE(text >> point[Axis::X] >> point[Axis::Y] >> point[Axis::Z]);
  return point;
}

/// What a "(debug, X#5420 …)" shows, and under which offset and rotation of the XY plane.
struct Shown {
  Position work;
  Position g92;
  double degrees = 0.0;
};

std::vector<Shown> expected_positions(const std::string& text) {
  std::vector<Shown> shown;
  Shown now;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("SET_G92_OFFSET") != line.npos) now.g92 = three_numbers(line);
    const std::size_t rotation = line.find("SET_XY_ROTATION(");
    if (rotation != line.npos) now.degrees = std::stod(line.substr(line.find('(') + 1));
    if (line.find("MESSAGE") == line.npos) continue;
    now.work = three_numbers(line);
    shown.push_back(now);
  }
  return shown;
}

/// The program in this language: no rotation by G10 R, and msg in place of (debug, …).
std::string without_rotation(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("g10")) line.resize(line.find(" r"));
    if (line.starts_with("(debug")) line = R"(msg " X"#5001" Y"#5002" Z"#5003)";
    result += line + "\n";
  }
  return result;
}

}  // namespace

TEST_CASE("Nine work systems and G92 add up as in LinuxCNC, its rotation taken away", "[CRD-1]") {
  if (corpus_missing()) return;
  const std::string name = kCorpus + "linuxcnc--g10-with-g92";
  const auto expected = expected_positions(read_file(name + ".expected.txt"));
  REQUIRE(expected.size() == 18);
  const Outcome outcome = run(without_rotation(read_file(name + ".ngc")));
  REQUIRE(refusal_of(outcome).empty());
  std::size_t compared = 0;
  for (const std::string& line : outcome.lines) {
    if (!line.starts_with("MESSAGE")) continue;
    const Shown& there = expected.at(compared++);
    INFO("position " << compared);
    const Position here = three_numbers(line) + there.g92;
    // From the origin of the system, turned back by its rotation.
    const double angle = -there.degrees * std::numbers::pi / 180.0;
    const double x = here[Axis::X] * std::cos(angle) - here[Axis::Y] * std::sin(angle);
    const double y = here[Axis::X] * std::sin(angle) + here[Axis::Y] * std::cos(angle);
    CHECK(x - there.g92[Axis::X] == Approx(there.work[Axis::X]).margin(2e-6));
    CHECK(y - there.g92[Axis::Y] == Approx(there.work[Axis::Y]).margin(2e-6));
    CHECK(here[Axis::Z] - there.g92[Axis::Z] == Approx(there.work[Axis::Z]).margin(2e-6));
  }
  CHECK(compared == expected.size());
}

TEST_CASE("The sample programs of the PSCNC manual run", "[LNG-11]") {
  const std::string manual = read_file(kShared + "seeds/pscnc-manual.md");
  if (manual.empty()) {
    WARN("The PSCNC manual is not here: test skipped.");
    return;
  }
  const auto title = GENERATE(as<std::string>{}, "### *Rectangular Path with Rounded Corners*",
                              "### *Center Drill and Finish Drill a Hole Pattern*");
  INFO(title);
  const std::size_t found = manual.find(title);
  REQUIRE(found != std::string::npos);
  const std::size_t begin = found + title.size();
  const std::string text = manual.substr(begin, manual.find("###", begin) - begin);

  Bench bench;
  bench.settings.default_unit = LengthUnit::inch;
  const Outcome outcome = bench.run(text);
  INFO(outcome.diagnostic.to_string());
  CHECK_FALSE(outcome.failed);
  CHECK(outcome.lines.size() > 15);
  CHECK(outcome.lines.back() == "PROGRAM_END()");
}
