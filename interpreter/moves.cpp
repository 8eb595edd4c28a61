#include "interpreter/moves.h"

#include <fmt/format.h>

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

}  // namespace

Position target(const Execution& x) {
  const Block& block = x.block();
  const MachineState& state = x.state();
  const bool machine = block.has(Step::machine_coordinates);
  const bool incremental = state.modal.distance == DistanceMode::incremental;
  const Position& offset = state.coordinates.total();

  Position end = state.position;
  for (const Axis axis : kAllAxes) {
    if (!block.has(axis)) continue;
    const double value = block.value(axis) * state.scale(axis);
    if (machine) {
      end[axis] = value;  // also under G91: G53 names a place
    } else if (incremental) {
      end[axis] += value;
    } else {
      end[axis] = value + offset[axis];
    }
  }
  return end;
}

Accepted check_feed(const Execution& x) {
  const ModalState& modal = x.state().modal;
  if (modal.feed_mode == FeedMode::inverse_time && !x.block().has('F')) {
    return refuse(
        ErrorCode::inverse_time_feed_missing, x.code_span(),
        fmt::format("{} needs F on its own line: G93 (inverse time) is active.", x.code_name()),
        "F on every line with G1 G2 G3.");
  }
  if (modal.feed > 0.0) return {};
  return refuse(ErrorCode::feed_not_set, x.code_span(),
                fmt::format("{} without a feed rate.", x.code_name()),
                "F above 0, on this line or before it.");
}

void use_feed_for(Execution& x, const Position& end) {
  ModalState& modal = x.state().modal;
  if (modal.feed_mode != FeedMode::per_minute || modal.linear_feed == modal.rotary_feed) return;
  const bool rotary = turns_rotary_axes_only(x.state().position, end);
  const double wanted = rotary ? modal.rotary_feed : modal.linear_feed;
  if (modal.feed == wanted) return;
  modal.feed = wanted;
  x.emit(SetFeedRate{modal.feed_mode, wanted});
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
