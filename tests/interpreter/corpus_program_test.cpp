// Programs that other people wrote, every file of the corpus: it runs to its end, or is refused on
// the line and with the error that it calls for. Skipped where the corpus is not at hand.
#include <array>
#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

const std::string kPrograms = std::string(CNC_SOURCE_DIR) + "/../shared/corpus/gcode/";

/// Line 0: runs to its end. Otherwise the first line that is refused, and with what.
struct Row {
  const char* file;
  std::uint32_t line = 0;
  ErrorCode code{};
  const char* why = "";
};

constexpr auto kRows = std::to_array<Row>({
    {.file = "CauldronDevelopmentLLC--botomata_bottom.nc"},
    {.file = "CauldronDevelopmentLLC--flower_mold.nc"},
    {"CauldronDevelopmentLLC--genes-encoder.ngc", 22, ErrorCode::o_word, "O-words of LinuxCNC"},
    {.file = "CauldronDevelopmentLLC--heart.ngc"},
    {.file = "CauldronDevelopmentLLC--tiger.nc"},
    {.file = "MaestroFusion360--G83.NC"},  // its O number is skipped
    {"Paciente8159--expressions.nc", 5, ErrorCode::unexpected_character, "$# is a console command"},
    {.file = "SergeyPopovGit--ScalePanel.nc"},
    {.file = "Sienci-Labs--FourAxisSurface_finishPass.nc"},
    {"Sienci-Labs--SheepTile-v2.nc", 14, ErrorCode::feed_not_set, "G1 before any F"},
    {"Sienci-Labs--jsdc_with_error.gcode", 123, ErrorCode::axis_words_missing, "g1 l20"},
    {.file = "bdring--arcs_arrows.nc"},
    {"bdring--gcode_conditionals_test.nc", 10, ErrorCode::o_word, "O-words of LinuxCNC"},
    {"cncjs--Circle_Diamond_Square_Calibration.gcode", 624, ErrorCode::arc_radius_mismatch,
     "29 mm from the start of the arc to its centre, 27.6 mm from its end"},
    {"cncjs--full-circle-without-xyz.gcode", 11, ErrorCode::arc_centre_missing,
     "the circles run; an X under G2 has no centre"},
    {.file = "cncjs--helical-thread-milling.gcode"},
    {"enier290188--mill_hp_4.nc", 14, ErrorCode::unknown_m_code, "M31: chip conveyor of a Haas"},
    {"enier290188--weld_pin.nc", 11, ErrorCode::unknown_m_code, "M31: chip conveyor of a Haas"},
    {"fragmuffin--DB25.tap", 15, ErrorCode::word_out_of_range, "G41 D1.5 is no tool"},
    {.file = "fragmuffin--Skull2.tap"},
    {"joewalnes--15mm_cube.gcode", 2, ErrorCode::axis_words_missing, "G92 of an extruder: E"},
    {"kliment--PCB-milling-and-_comment_.gcode", 8, ErrorCode::word_missing, "G4 without P"},
    {.file = "linuxcnc--3D_Chips.ngc"},
    {.file = "linuxcnc--Pasta.ngc"},
    {"linuxcnc--bad-arc.medium.metric.ngc", 6, ErrorCode::arc_radius_mismatch,
     "998.5 mm from the start of the arc to its centre, 1001.5 mm from its end"},
    {"linuxcnc--bad-ccomp-gouging.ngc", 6, ErrorCode::compensation_inside_corner,
     "the tool does not reach the corner"},
    {"linuxcnc--bad-no-feed-rate.ngc", 2, ErrorCode::feed_not_set, "G1 before any F"},
    {.file = "linuxcnc--blur_torus.ngc"},
    {.file = "linuxcnc--ccomp-line-arc-entry.ngc"},
    {.file = "linuxcnc--comp.ngc"},
    {"linuxcnc--daisy.ngc", 3, ErrorCode::o_word, "O-words of LinuxCNC"},
    {"linuxcnc--g10-with-g92.ngc", 3, ErrorCode::word_unused, "G10 L2 R of LinuxCNC"},
    {.file = "linuxcnc--g17-g98-g81.ngc"},
    {.file = "linuxcnc--good-arc.medium.metric.ngc"},
    {"linuxcnc--lathe_pawn.ngc", 3, ErrorCode::unknown_g_code, "G8 of LinuxCNC: radius mode"},
    {"linuxcnc--polar.ngc", 10, ErrorCode::unexpected_character, "@ and ^: polar coordinates"},
    {.file = "linuxcnc--tort.ngc"},
    {.file = "linuxcnc--wheels.ngc"},
    {.file = "linuxcnc--zigzag_0.002_0.0005.ngc"},
    {.file = "nist--c1_hello_world.ngc"},
    {.file = "nist--c2_expressions.ngc"},
    {.file = "nraynaud--tux.ngc"},
    {.file = "pcb2gcode--back.ngc"},
    {.file = "pcb2gcode--drill.ngc"},
    {.file = "synthetos--FordEmblem.gcode"},
    {.file = "winder--arc_rword_test.gcode"},
    {.file = "winder--communicator.nc"},
    {.file = "winder--no_spaces.gcode"},
});

bool corpus_missing() {
  if (std::filesystem::exists(kPrograms)) return false;
  WARN("The corpus of real programs is not here: test skipped.");
  return true;
}

/// The tools of INDEX.md and of the programs' own comments, inches of diameter.
config::ToolTable tools() {
  config::ToolTable table;
  for (const auto& [number, inches] :
       {std::pair{1, 0.25}, {2, 0.375}, {3, 0.25}, {4, 1.0}, {8, 0.15}}) {
    REQUIRE(table.set(number, {.diameter = 25.4 * inches, .description = {}}));
  }
  return table;
}

}  // namespace

TEST_CASE("Every program of the corpus ends as its row says", "[GCO-2][LNG-10][LNG-11]") {
  if (corpus_missing()) return;
  const Row row = GENERATE(from_range(kRows));
  INFO(row.file << ": " << row.why);
  const auto program = Program::open(kPrograms + row.file);
  REQUIRE(program.has_value());
  const CheckReport report = check(*program, {}, {}, tools(), {});
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  if (row.line == 0) {
    CHECK(report.ok());
    return;
  }
  REQUIRE_FALSE(report.errors.empty());
  CHECK(report.errors[0].line == row.line);
  CHECK(report.errors[0].code == row.code);
}

TEST_CASE("A 3D print of the corpus runs on a 3D printer", "[GCO-12][LNG-11]") {
  if (corpus_missing()) return;
  const auto program = Program::open(kPrograms + "joewalnes--15mm_cube.gcode");
  REQUIRE(program.has_value());
  InterpreterSettings printer;
  printer.is_3d_printer = true;
  const CheckReport report = check(*program, printer, {}, {}, {});
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  CHECK(report.ok());
  CHECK(report.motion.highest[Axis::A] > 280.0);  // E282.07859, its last extrusion
}

TEST_CASE("Every program of the corpus has a row", "[LNG-11]") {
  if (corpus_missing()) return;
  std::set<std::string> rows;
  for (const Row& row : kRows) rows.insert(row.file);
  std::size_t programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kPrograms)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".expected.txt")) continue;
    INFO(name);
    CHECK(rows.contains(name));
    ++programs;
  }
  CHECK(programs == kRows.size());
}
