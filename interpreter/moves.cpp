#include "interpreter/moves.h"

#include <cmath>
#include <fmt/format.h>

#include "interpreter/arc_geometry.h"

namespace cnc::interp {
namespace {

[[nodiscard]] bool turns_rotary_axes_only(const Position& from, const Position& to) {
  for (const Axis axis : kLinearAxes) {
    if (from[axis] != to[axis]) return false;
  }
  for (const Axis axis : kRotaryAxes) {
    if (from[axis] != to[axis]) return true;
  }
  return false;
}

/// `position` with those axes changed that the line names.
[[nodiscard]] Position with_axis_words(const Execution& x, Position position) {
  for (const Axis axis : kAllAxes) {
    if (x.block().has(axis)) position[axis] = x.block().value(axis) * x.state().scale(axis);
  }
  return position;
}

[[nodiscard]] Position machine_target(const Execution& x) {
  return with_axis_words(x, x.state().position);
}

[[nodiscard]] Position incremental_target(const Execution& x) {
  const MachineState& state = x.state();
  return state.position + state.coordinates.transform().apply_to_distance(with_axis_words(x, {}));
}

// Axes that do not move keep their machine coordinate exactly, without a detour through work
// coordinates and their rounding.
[[nodiscard]] Position absolute_target(const Execution& x) {
  const Block& block = x.block();
  const MachineState& state = x.state();
  const Position& offset = state.coordinates.total();
  Position end = state.position;
  for (const Axis axis : kAllAxes) {
    if (block.has(axis)) end[axis] = block.value(axis) * state.scale(axis) + offset[axis];
  }
  const bool moves_plane = block.has('X') || block.has('Y');
  if (state.coordinates.transform().is_identity() || !moves_plane) return end;
  // Under G68 and G51 X and Y move together.
  const Position there = state.coordinates.to_machine(with_axis_words(x, state.work_position()));
  end[Axis::X] = there[Axis::X];
  end[Axis::Y] = there[Axis::Y];
  return end;
}

}  // namespace

Position target(const Execution& x) {
  const Block& block = x.block();
  if (block.has(Step::machine_coordinates)) return machine_target(x);  // also under G91
  if (x.state().modal.distance == DistanceMode::incremental) return incremental_target(x);
  return absolute_target(x);
}

Accepted check_feed(const Execution& x) {
  const ModalState& modal = x.state().modal;
  if (modal.feed_mode == FeedMode::inverse_time && !x.block().has('F')) {
    return refuse(
        ErrorCode::inverse_time_feed_missing, x.code_span(),
        fmt::format("{} needs F on its own line: G93 (inverse time) is active.", x.code_name()),
        "F on every line with G1 G2 G3.");
  }
  if (modal.feed_mode == FeedMode::per_revolution && modal.spindle == SpindleDirection::off) {
    return refuse(ErrorCode::feed_without_spindle, x.code_span(),
                  fmt::format("{} would never end: its feed is per revolution (G95) and the "
                              "spindle is off.",
                              x.code_name()),
                  "M3 or M4 before it, or G94.");
  }
  if (modal.feed > 0.0) return {};
  return refuse(ErrorCode::feed_not_set, x.code_span(),
                fmt::format("{} without a feed rate.", x.code_name()),
                "F above 0, on this line or before it.");
}

Accepted check_rotary_axes_stay(const Execution& x, const Position& end, ErrorCode code) {
  for (const Axis axis : kRotaryAxes) {
    if (std::abs(end[axis] - x.state().position[axis]) < kSamePoint) continue;
    const char letter = axis_name(axis)[0];
    return refuse(code, x.block().span_of(letter),
                  fmt::format("{} cannot turn {}.", x.code_name(), letter),
                  fmt::format("The turn on a line of its own, before {}.", x.code_name()));
  }
  return {};
}

void use_feed_for(Execution& x, const Position& end) {
  ModalState& modal = x.state().modal;
  if (modal.feed_mode == FeedMode::inverse_time || modal.linear_feed == modal.rotary_feed) return;
  const bool rotary = !x.settings().feed_at_tip && turns_rotary_axes_only(x.state().position, end);
  const double wanted = rotary ? modal.rotary_feed : modal.linear_feed;
  if (modal.feed == wanted) return;
  modal.feed = wanted;
  x.emit(SetFeedRate{modal.feed_mode, wanted});
}

bool is_mirrored(const Execution& x) {
  return x.settings().front_tool_post && x.state().modal.plane == Plane::xz;
}

void move_rapid(Execution& x, const Position& end) {
  x.emit(RapidMove{end});
  x.state().position = end;
}

void move_feed(Execution& x, const Position& end) {
  use_feed_for(x, end);
  x.emit(FeedMove{end});
  x.state().position = end;
}

}  // namespace cnc::interp
