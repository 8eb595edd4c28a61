#include "config/pitch_table.h"

#include <catch2/catch.hpp>

#include "config/config_checks.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;

namespace {

MachineConfig with_pitch_table() {
  MachineConfig config;
  AxisConfig& x = config.axes[Axis::X];
  x.port = 1;
  x.positive_limit = 508.0;
  x.pitch_compensation = true;
  return config;
}

}  // namespace

TEST_CASE("The manual's pitch table is read with its comments", "[CFG-24]") {
  const auto points = parse_pitch_table(
      ";Pitch correction table for axis X\n"
      ";This table contains 6 correction points\n"
      "\n"
      "   0.0000    0.0000\n"
      "  50.0000   50.01000\t; here\r\n"
      " 200.0000  200.02000\n",
      "table");
  REQUIRE(points);
  CHECK(*points == std::vector<PitchPoint>{{0, 0}, {50, 50.01}, {200, 200.02}});
}

TEST_CASE("A pitch table that is none is refused with its line", "[CFG-24]") {
  struct Row {
    std::string_view rule;
    std::string_view text;
    ErrorCode code;
    std::uint32_t line;
  };
  for (const Row& row : {
           Row{"three numbers", "0 0\n1 1 1\n", ErrorCode::pitch_bad_line, 2},
           Row{"one number", "0 0\n\n1\n", ErrorCode::pitch_bad_line, 3},
           Row{"a word", "0 zero\n", ErrorCode::pitch_bad_line, 1},
           Row{"not finite", "0 inf\n", ErrorCode::pitch_bad_line, 1},
           Row{"falling", "0 0\n-1 -1\n", ErrorCode::pitch_bad_table, 2},
           Row{"the same place twice", "0 0\n0 0\n", ErrorCode::pitch_bad_table, 2},
           Row{"6 % long", "0 0\n100 106\n", ErrorCode::pitch_bad_table, 2},
           Row{"6 % short", "0 0\n100 94\n", ErrorCode::pitch_bad_table, 2},
           Row{"one line", "0 0\n", ErrorCode::pitch_bad_table, 0},
           Row{"empty", "", ErrorCode::pitch_bad_table, 0},
       }) {
    INFO(row.rule);
    const auto points = parse_pitch_table(row.text, "table");
    REQUIRE_FALSE(points);
    CHECK(points.error().code == row.code);
    CHECK(points.error().place->line == row.line);
  }
}

TEST_CASE("A missing pitch table is written as an example that corrects nothing", "[CFG-24]") {
  const test::TemporaryDirectory folder;
  MachineConfig config = with_pitch_table();
  REQUIRE(load_pitch_tables(config, folder.path()));
  CHECK(config.axes[Axis::X].pitch_table == std::vector<PitchPoint>{{0, 0}, {508, 508}});
  CHECK(std::filesystem::exists(folder.path() / "Joint-X-pitchCompTable.txt"));
  CHECK(config.axes[Axis::Y].pitch_table.empty());
}

TEST_CASE("The pitch table is in the unit of the machine", "[CFG-24][CFG-4]") {
  const test::TemporaryDirectory folder;
  MachineConfig config = with_pitch_table();
  config.unit = MachineUnit::inch;
  REQUIRE(load_pitch_tables(config, folder.path()));  // the example: 0 to 20 inch
  CHECK(config.axes[Axis::X].pitch_table == std::vector<PitchPoint>{{0, 0}, {508, 508}});
}

TEST_CASE("A motor without compensation has no table, whatever file lies there", "[CFG-24]") {
  const test::TemporaryDirectory folder;
  MachineConfig config = with_pitch_table();
  REQUIRE(load_pitch_tables(config, folder.path()));
  config.axes[Axis::X].pitch_compensation = false;
  REQUIRE(load_pitch_tables(config, folder.path()));
  CHECK(config.axes[Axis::X].pitch_table.empty());
}

TEST_CASE("A slave needs a master with a motor", "[CFG-3]") {
  MachineConfig config;
  for (const Axis axis : {Axis::X, Axis::A}) {
    config.axes[axis].port = axis == Axis::X ? 1 : 2;
    config.axes[axis].positive_limit = 100.0;
  }
  config.axes[Axis::A].mode = AxisMode::slave_x;
  CHECK(find_conflicts(config).empty());
  CHECK(config.moved_by(Axis::A) == Axis::X);
  CHECK_FALSE(config.axes[Axis::A].programmable());
  config.axes[Axis::A].mode = AxisMode::slave_y;
  const auto conflicts = find_conflicts(config);
  REQUIRE(conflicts.size() == 1);
  CHECK(conflicts[0].error.code == ErrorCode::config_slave_without_master);
  CHECK(conflicts[0].setting->name() == "[AXIS_A] mode");
}
