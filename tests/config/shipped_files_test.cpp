// The files that a new installation starts with fit each other.
#include <catch2/catch.hpp>

#include "config/config_checks.h"
#include "config/ini_file.h"
#include "config/parameter_store.h"
#include "config/schema.h"
#include "config/tool_table.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;

namespace {

const std::filesystem::path kShipped = CNC_SOURCE_DIR "/config";
constexpr double kInch = 25.4;

MachineConfig machine() { return load_machine_config(kShipped / "cnc.ini").value(); }
ParameterStore parameters() {
  return ParameterStore::load(kShipped / "default_parameters.txt").value();
}
ToolTable tools() { return ToolTable::load(kShipped / "default_tools.txt").value(); }

/// Corners of what a program reaches in the work coordinates of G54, in inches, and the length of
/// the tool that is in use there.
struct Extent {
  double x_min, x_max, y_min, y_max, z_min, z_max;
  std::int32_t tool;
};

void check_inside(const Extent& extent) {
  const MachineConfig config = machine();
  const Position zero = parameters().work_offset(1);
  const double length = tools().tool(extent.tool).length;
  const auto inside = [&](Axis axis, double inches, double offset) {
    const double position = zero[axis] + inches * kInch + offset;
    INFO(axis_name(axis) << " at " << position);
    CHECK(position >= config.axes[axis].negative_limit);
    CHECK(position <= config.axes[axis].positive_limit);
  };
  inside(Axis::X, extent.x_min, 0.0);
  inside(Axis::X, extent.x_max, 0.0);
  inside(Axis::Y, extent.y_min, 0.0);
  inside(Axis::Y, extent.y_max, 0.0);
  inside(Axis::Z, extent.z_min, length);
  inside(Axis::Z, extent.z_max, length);
}

}  // namespace

TEST_CASE("The shipped machine needs no caution", "[CFG-1][LNK-4]") {
  CHECK(find_cautions(machine()).empty());
}

TEST_CASE("The shipped machine is a homed three-axis mill", "[CFG-1][CFG-2]") {
  const MachineConfig config = machine();
  for (const Axis axis : kLinearAxes) {
    CHECK(config.axes[axis].connected());
    CHECK(config.axes[axis].visible);
    CHECK(config.axes[axis].home_velocity != 0.0);
    CHECK(config.axes[axis].home_position >= config.axes[axis].negative_limit);
    CHECK(config.axes[axis].home_position <= config.axes[axis].positive_limit);
  }
  for (const Axis axis : kRotaryAxes) CHECK_FALSE(config.axes[axis].connected());
  CHECK(config.axes[Axis::Z].home_velocity > 0.0);  // up, away from the workpiece
  CHECK(config.safety.homing_mandatory);
}

TEST_CASE("The shipped machine takes a rotary axis by two settings", "[CFG-2]") {
  const std::vector<std::string> rotary{"AXIS_A.visible=1", "AXIS_A.port=4"};
  CHECK(load_machine_config(kShipped / "cnc.ini", rotary).value().axes[Axis::A].connected());
}

TEST_CASE("The shipped cnc.ini shows every setting but those of spare axes and further guard rules",
          "[CFG-1][CFG-16]") {
  const std::string text = test::content_of(kShipped / "cnc.ini");
  for (const Setting& setting : settings()) {
    if (setting.axis == Axis::B || setting.axis == Axis::C) continue;
    const bool is_further_rule =
        setting.section == "GPIO_RULES" && !setting.key.starts_with("card_1_rule_1_");
    if (is_further_rule) continue;
    INFO(setting.name());
    const auto section = text.find("[" + std::string(setting.section) + "]");
    REQUIRE(section != std::string::npos);
    const auto body = text.substr(section, text.find("\n[", section) - section);
    CHECK(body.find("\n" + std::string(setting.key) + " = ") != std::string::npos);
  }
}

TEST_CASE("The shipped tools have the lengths of the sample tool file, in mm", "[CFG-23]") {
  // PSCNC manual, the tool description file: T01 0.00, T02 2.623, T03 1.445 inch.
  const ToolTable table = tools();
  CHECK(table.tool(1).length == 0.0);
  CHECK(table.tool(2).length == Approx(2.623 * kInch));
  CHECK(table.tool(3).length == Approx(1.445 * kInch));
  CHECK(table.tool(4) == Tool{});
}

TEST_CASE("G54 is active and is the only offset of a new machine", "[CRD-1]") {
  const ParameterStore store = parameters();
  CHECK(store.active_system() == 1);
  for (std::int32_t system = 2; system <= 9; ++system) {
    CHECK(store.work_offset(system) == Position{});
  }
  CHECK(store.g92_offset() == Position{});
}

TEST_CASE("The example programs stay within the limits of the shipped machine", "[CFG-1]") {
  // What each program reaches, read off its words; the half circle of the contour swings to
  // Y -0.5, its arc in Y-Z to Y 0.5.
  check_inside({0.0, 3.0, 0.0, 1.5, -0.1, 0.25, 3});    // rounded_rectangle.ngc
  check_inside({-1.5, 1.5, -1.5, 1.5, -0.25, 3.0, 1});  // hole_pattern.ngc, centre drill
  check_inside({-1.5, 1.5, -1.5, 1.5, -0.5, 0.25, 2});  // hole_pattern.ngc, drill
  for (const std::int32_t tool : {0, 1, 2, 3}) {
    check_inside({0.0, 1.0, -0.5, 0.5, 0.0, 1.0, tool});  // multi_plane_contour.ngc
  }
}

TEST_CASE("The example programs are inch programs that end", "[GCO-2]") {
  for (const char* name : {"rounded_rectangle", "hole_pattern", "multi_plane_contour"}) {
    INFO(name);
    const auto text = test::content_of(kShipped / "examples" / (std::string(name) + ".ngc"));
    CHECK(text.find("\nG20 ") != std::string::npos);
    CHECK(text.find("\nG90") != std::string::npos);
    CHECK(text.ends_with("\nM30\n"));
  }
}
