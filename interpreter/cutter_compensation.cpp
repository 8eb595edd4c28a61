#include "interpreter/cutter_compensation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"

namespace cnc::interp {
namespace {

/// The machine stands where it was sent when it is no further away than this, mm.
constexpr double kInPlace = 1e-3;

}  // namespace

void CutterCompensation::put_tip(PlanePoint point) {
  if (distance(tip, point) <= kInPlace) return;
  tip = point;
  has_entered = false;
}

namespace {

using config::kCentredOrientation;

/// Where the controlled point of a turning tool lies from the centre of its nose, in radii: manual
/// 3.1.2.1, orientations 1 … 9; numbered as on LinuxCNC, whose 2 is the one that the manual states.
struct TipDirection {
  double x;
  double z;
};
constexpr auto kTipDirections = std::to_array<TipDirection>(
    {{-1, 1}, {-1, -1}, {1, -1}, {1, 1}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}, {0, 0}});
static_assert(kTipDirections.size() == kCentredOrientation);

/// What D says about the tool: its own number, or, with G41.1 and G42.1, a diameter for the tool
/// in the spindle.
struct CompensatedTool {
  double radius;
  std::int32_t orientation;
};

Parsed<CompensatedTool> compensated_tool(const Execution& x) {
  const std::int32_t in_spindle = x.state().modal.tool;
  const double value = x.block().find('D').value_or(in_spindle);
  if (x.code() % 10 != 0) {
    return CompensatedTool{value * x.state().scale() / 2.0, x.tools().tool(in_spindle).orientation};
  }
  const auto number = whole_number(value);
  if (!number || !config::ToolTable::is_valid(*number)) {
    return refuse(
        ErrorCode::word_out_of_range, x.block().span_of('D'),
        fmt::format("{} takes the number of a tool; D{:.10g} is none.", x.code_name(), value),
        fmt::format("D0 to D{}; G41.1 and G42.1 take a diameter.", config::kMaxTool));
  }
  const config::Tool& tool = x.tools().tool(*number);
  return CompensatedTool{tool.diameter / 2.0, tool.orientation};
}

[[nodiscard]] PlanePoint tip_of(const CompensatedTool& tool, Plane plane) {
  if (plane != Plane::xz) return {};
  const TipDirection& tip = kTipDirections.at(static_cast<std::size_t>(tool.orientation - 1));
  return std::abs(tool.radius) * PlanePoint{tip.z, tip.x};
}

Accepted check_can_begin(const Execution& x) {
  const ModalState& modal = x.state().modal;
  if (modal.compensation != CompensationSide::off) {
    return refuse(ErrorCode::compensation_already_on, x.code_span(),
                  "Cutter compensation is on already.", "G40 before it is turned on again.");
  }
  if (modal.plane != Plane::yz) return {};
  return refuse(ErrorCode::compensation_plane, x.code_span(),
                "There is no cutter compensation in the YZ plane (G19).",
                "G17, or G18 for turning.");
}

}  // namespace

// A negative diameter is a tool smaller than the one that the path was made for: it runs on the
// other side (manual 5.3).
Accepted begin_cutter_compensation(Execution& x) {
  if (Accepted can = check_can_begin(x); !can) return can;
  const auto tool = compensated_tool(x);
  if (!tool) return std::unexpected(tool.error());
  constexpr std::int32_t kLastLeft = 411;
  MachineState& state = x.state();
  const bool left = x.code() <= kLastLeft;
  const bool left_of_path = left != is_mirrored(x);
  state.modal.compensation = left ? CompensationSide::left : CompensationSide::right;
  state.compensation = {};
  state.compensation.offset = left_of_path ? tool->radius : -tool->radius;
  state.compensation.to_tip = tip_of(*tool, state.modal.plane);
  state.compensation.tip = in_plane(state.position, state.modal.plane);
  return {};
}

void end_compensation(Execution& x) {
  MachineState& state = x.state();
  state.position = state.machine_position();
  state.compensation = {};
  state.modal.compensation = CompensationSide::off;
}

Accepted cancel_cutter_compensation(Execution& x) {
  end_compensation(x);
  return {};
}

// --- what cannot be done meanwhile ---------------------------------------------------------------

namespace {

/// Codes of one step, first to last number, that are refused: manual 5.4.
struct Forbidden {
  Step step;
  std::int32_t first;
  std::int32_t last;
  ErrorCode error;
  std::string_view what;
  bool (*changes_nothing)(const Execution& x);
};

bool never(const Execution&) { return false; }
bool has_no_effect_in_plane(const Execution& x) { return x.state().modal.plane == Plane::xy; }
bool is_plane_in_force(const Execution& x) { return plane_of(x.code()) == x.state().modal.plane; }
bool is_unit_in_force(const Execution& x) { return unit_of(x.code()) == x.state().modal.unit; }
bool is_system_in_force(const Execution& x) {
  return work_system_of(x.code()) == x.state().modal.work_system;
}

constexpr auto kForbidden = std::to_array<Forbidden>({
    {Step::plane, 170, 190, ErrorCode::compensation_plane_change, "change the plane",
     is_plane_in_force},
    {Step::units, 200, 710, ErrorCode::compensation_unit_change, "change the unit",
     is_unit_in_force},
    {Step::tool_length, 430, 490, ErrorCode::compensation_offset_change, "change the tool length",
     has_no_effect_in_plane},
    {Step::work_system, 540, 593, ErrorCode::compensation_offset_change, "change the work system",
     is_system_in_force},
    {Step::scaling, 500, 510, ErrorCode::compensation_offset_change, "change the scaling", never},
    {Step::rotation, 680, 690, ErrorCode::compensation_offset_change, "change the rotation", never},
    {Step::head, 90, 97, ErrorCode::compensation_offset_change, "change the head", never},
    {Step::non_modal, 100, 100, ErrorCode::compensation_offset_change, "change offsets", never},
    {Step::non_modal, 280, 309, ErrorCode::compensation_home_move, "move to a stored position",
     never},
    {Step::non_modal, 920, 923, ErrorCode::compensation_offset_change, "change offsets", never},
    {Step::machine_coordinates, 530, 530, ErrorCode::compensation_machine_move,
     "move in machine coordinates", never},
    {Step::motion, 380, 389, ErrorCode::compensation_probe, "probe", never},
    {Step::motion, 330, 339, ErrorCode::compensation_cycle, "cut a thread", never},
    {Step::motion, 730, 799, ErrorCode::compensation_cycle, "drill or cut a thread", never},
    {Step::motion, 810, 899, ErrorCode::compensation_cycle, "drill", never},
});

}  // namespace

Accepted check_under_compensation(const Execution& x) {
  const auto matches = [&](const Forbidden& row) {
    return row.step == x.step() && x.code() >= row.first && x.code() <= row.last;
  };
  const auto row = std::ranges::find_if(kForbidden, matches);
  if (row == kForbidden.end() || row->changes_nothing(x)) return {};
  return refuse(
      row->error, x.code_span(),
      fmt::format("{} cannot {} while cutter compensation is on.", x.code_name(), row->what),
      "G40 before it.");
}

}  // namespace cnc::interp
