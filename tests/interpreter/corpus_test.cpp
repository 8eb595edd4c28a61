// Programs that other people wrote: those that need nothing but lines, arcs, feeds, offsets and
// plain M codes run to their end, and those that are wrong, or use what this interpreter does not
// know, are refused on the right line. Skipped where the corpus is not at hand.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
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

struct Refused {
  const char* file;
  std::uint32_t line;
  ErrorCode code;
};

}  // namespace

TEST_CASE("Real programs run to their end", "[GCO-2][LNG-11]") {
  if (corpus_missing()) return;
  const auto name = GENERATE(
      as<std::string>{},  //
      "nist--c1_hello_world.ngc", "nist--c2_expressions.ngc",
      "linuxcnc--good-arc.medium.metric.ngc", "linuxcnc--Pasta.ngc", "linuxcnc--blur_torus.ngc",
      "linuxcnc--tort.ngc", "linuxcnc--wheels.ngc", "linuxcnc--zigzag_0.002_0.0005.ngc",
      "nraynaud--tux.ngc", "pcb2gcode--back.ngc", "CauldronDevelopmentLLC--botomata_bottom.nc",
      "CauldronDevelopmentLLC--flower_mold.nc", "CauldronDevelopmentLLC--tiger.nc",
      "SergeyPopovGit--ScalePanel.nc", "Sienci-Labs--FourAxisSurface_finishPass.nc",
      "bdring--arcs_arrows.nc", "winder--communicator.nc", "synthetos--FordEmblem.gcode",
      "winder--arc_rword_test.gcode", "winder--no_spaces.gcode", "fragmuffin--Skull2.tap",
      "linuxcnc--g17-g98-g81.ngc", "pcb2gcode--drill.ngc", "MaestroFusion360--G83.NC");
  INFO(name);
  const CheckReport report = check_file(name);
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  CHECK(report.ok());
}

TEST_CASE("Wrong and unknown programs are refused on the right line", "[LNG-10]") {
  if (corpus_missing()) return;
  const auto row = GENERATE(values<Refused>({
      {"linuxcnc--bad-arc.medium.metric.ngc", 6, ErrorCode::arc_radius_mismatch},
      {"linuxcnc--bad-no-feed-rate.ngc", 2, ErrorCode::feed_not_set},
      {"linuxcnc--bad-ccomp-gouging.ngc", 6, ErrorCode::compensation_inside_corner},
      {"fragmuffin--DB25.tap", 15, ErrorCode::word_out_of_range},  // G41 D1.5: no tool
      {"linuxcnc--daisy.ngc", 3, ErrorCode::o_word},
      {"linuxcnc--polar.ngc", 10, ErrorCode::unexpected_character},
      {"linuxcnc--3D_Chips.ngc", 8, ErrorCode::named_parameter},
      {"CauldronDevelopmentLLC--genes-encoder.ngc", 22, ErrorCode::o_word},
      {"CauldronDevelopmentLLC--heart.ngc", 3, ErrorCode::named_parameter},
      {"Sienci-Labs--jsdc_with_error.gcode", 123, ErrorCode::axis_words_missing},
      {"Sienci-Labs--SheepTile-v2.nc", 14, ErrorCode::feed_not_set},
      {"Paciente8159--expressions.nc", 5, ErrorCode::unexpected_character},
      {"kliment--PCB-milling-and-_comment_.gcode", 8, ErrorCode::word_missing},
      // Centre and end of this arc do not fit: 29 mm against 27.6 mm.
      {"cncjs--Circle_Diamond_Square_Calibration.gcode", 624, ErrorCode::arc_radius_mismatch},
      // The full circles run; "X.75" behind G2 has no centre.
      {"cncjs--full-circle-without-xyz.gcode", 11, ErrorCode::arc_centre_missing},
      {"joewalnes--15mm_cube.gcode", 2, ErrorCode::axis_words_missing},
  }));
  INFO(row.file);
  const CheckReport report = check_file(row.file);
  REQUIRE_FALSE(report.errors.empty());
  CHECK(report.errors[0].line == row.line);
  CHECK(report.errors[0].code == row.code);
}

TEST_CASE("Compensated programs of other people run with their tools", "[GCO-4]") {
  if (corpus_missing()) return;
  struct Row {
    const char* file;
    std::int32_t tool;
    double inches;
  };
  const auto row = GENERATE(values<Row>({
      {"linuxcnc--comp.ngc", 1, 0.25},
      {"cncjs--helical-thread-milling.gcode", 8, 0.15},
  }));
  INFO(row.file);
  const CheckReport report = check_file(row.file, {}, tools_with(row.tool, row.inches));
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  CHECK(report.ok());
}

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
