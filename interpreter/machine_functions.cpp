// T, comments and the M codes: everything but motion, coordinates, F and S.
#include <fmt/format.h>

#include "interpreter/cutter_compensation.h"
#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/spindle.h"

namespace cnc::interp {
namespace {

void use_coolant(Execution& x, bool mist, bool flood) {
  x.state().modal.mist = mist;
  x.state().modal.flood = flood;
  x.emit(SetCoolant{mist, flood});
}

// Not in the manual's list, which is older than its G96. If it stayed, "S1000 M3" of the next
// program would be 1000 m/min.
void forget_surface_speed(Execution& x) {
  ModalState& modal = x.state().modal;
  modal.max_speed.reset();
  if (!modal.speed_by_surface) return;
  modal.speed_by_surface = false;
  modal.surface_speed = 0.0;
  modal.speed = 0.0;
  x.emit(SetSpindleSpeed{0.0});
}

}  // namespace

void turn_spindle_to(Execution& x, SpindleDirection direction) {
  ModalState& modal = x.state().modal;
  modal.spindle = direction;
  modal.spindle_pwm_output = modal.spindle_direction_output = false;
  x.emit(TurnSpindle{direction});
}

void stop_spindle(Execution& x) {
  const ModalState& modal = x.state().modal;
  const bool runs = modal.spindle != SpindleDirection::off || modal.spindle_pwm_output ||
                    modal.spindle_direction_output;
  if (runs) turn_spindle_to(x, SpindleDirection::off);
}

Accepted show_comment(Execution& x) {
  x.emit(x.block().comment());
  return {};
}

Accepted select_tool(Execution& x) {
  const double value = x.block().value('T');
  const auto tool = whole_number(value);
  if (!tool || !config::ToolTable::is_valid(*tool)) {
    return refuse(ErrorCode::word_out_of_range, x.block().span_of('T'),
                  fmt::format("T{:.10g} is not a tool.", value),
                  fmt::format("T0 (no tool) to T{}.", config::kMaxTool));
  }
  x.state().modal.selected_tool = *tool;
  x.emit(SelectTool{*tool});
  return {};
}

// The spindle stands after a tool change (manual 3.5.3).
Accepted change_tool(Execution& x) {
  ModalState& modal = x.state().modal;
  stop_spindle(x);
  modal.tool = modal.selected_tool;
  x.emit(ChangeTool{modal.tool});
  if (modal.length_source == LengthSource::spindle_tool) x.reload_tool_length();
  return {};
}

Accepted turn_spindle(Execution& x) {
  turn_spindle_to(x, x.code() == 3   ? SpindleDirection::clockwise
                     : x.code() == 4 ? SpindleDirection::counterclockwise
                                     : SpindleDirection::off);
  return {};
}

Accepted switch_coolant(Execution& x) {
  const ModalState& modal = x.state().modal;
  const bool off = x.code() == 9;
  use_coolant(x, !off && (modal.mist || x.code() == 7), !off && (modal.flood || x.code() == 8));
  return {};
}

Accepted stop_program(Execution& x) {
  if (x.code() == 1 && x.settings().is_3d_printer) return switch_heaters_off(x);
  x.note_stop();
  x.emit(ProgramStop{x.code() == 0   ? StopKind::program_stop
                     : x.code() == 1 ? StopKind::optional_stop
                                     : StopKind::pallet_stop});
  return {};
}

// What M30 puts back is the manual's list (3.5.1): work system and G92 stay, on purpose, and so do
// head, clamp, outputs and heaters. Torch height control ends with the torch: it moves Z by itself.
// Only what changes is said again.
Accepted end_program(Execution& x) {
  ModalState& modal = x.state().modal;
  end_compensation(x);
  if (modal.plane != Plane::xy) x.emit(SelectPlane{Plane::xy});
  if (!modal.overrides_enabled()) x.emit(EnableOverrides{true, true});
  if (modal.torch_height) x.emit(UseTorchHeight{false});
  stop_spindle(x);
  if (modal.mist || modal.flood) use_coolant(x, false, false);
  if (modal.feed_mode != FeedMode::per_minute) {
    modal.feed_mode = FeedMode::per_minute;
    modal.feed = modal.linear_feed = modal.rotary_feed = 0.0;
  }
  forget_surface_speed(x);
  modal.plane = Plane::xy;
  modal.distance = DistanceMode::absolute;
  modal.feed_override_enabled = modal.speed_override_enabled = true;
  modal.torch_height = false;
  modal.motion = 10;  // G1
  x.emit(ProgramEnd{});
  x.end_program();
  return {};
}

}  // namespace cnc::interp
