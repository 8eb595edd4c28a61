// G10, G43 G43.1 G49, G54-G59.3, G92 family: where work coordinates lie in the machine.
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/words.h"

namespace cnc::interp {
namespace {

using config::parameter::kActiveSystem;
using config::parameter::kG92Offset;
using config::parameter::kWorkOffset;
using config::parameter::kWorkSystemStride;

/// `values` with those axes changed that the line names.
Position with_words(const Execution& x, Position values) {
  for (const Axis axis : kAllAxes) {
    if (x.block().has(axis)) values[axis] = x.block().value(axis) * x.state().scale(axis);
  }
  return values;
}

/// `offset` changed so that the present point gets the coordinates of the words and keeps the
/// others, given what else is `beside` it. Under rotation X and Y change together.
Position offset_from_position(const Execution& x, Position offset, const Position& beside) {
  const MachineState& state = x.state();
  const XyTransform& transform = state.coordinates.transform();
  const Position now = transform.undo(state.position - beside - offset);
  const Position wanted = transform.apply(with_words(x, now));
  const bool turns_plane = !transform.is_identity() && (x.block().has('X') || x.block().has('Y'));
  for (const Axis axis : kAllAxes) {
    const bool in_plane = axis == Axis::X || axis == Axis::Y;
    if (!x.block().has(axis) && !(in_plane && turns_plane)) continue;
    offset[axis] = state.position[axis] - beside[axis] - wanted[axis];
  }
  return offset;
}

void use_g92(Execution& x, const Position& offset, bool active) {
  x.state().modal.g92_active = active;
  x.state().coordinates.set_g92_offset(offset);
  x.emit(SetG92Offset{offset});
}

}  // namespace

Accepted set_coordinate_system(Execution& x) {
  constexpr std::int32_t kSetValues = 2;
  constexpr std::int32_t kSetFromPosition = 20;
  const auto kind = whole_word(x, 'L', 0, kSetFromPosition);
  if (!kind || (*kind != kSetValues && *kind != kSetFromPosition)) {
    return refuse(ErrorCode::word_out_of_range, x.block().span_of('L'),
                  fmt::format("G10 cannot be L{:.10g}.", x.block().value('L')), "L2 or L20.");
  }
  const auto system = whole_word(x, 'P', 1, config::kWorkSystemCount);
  if (!system) return std::unexpected(system.error());

  WorkCoordinates& coordinates = x.state().coordinates;
  const Position beside =
      coordinates.g92_offset() + coordinates.tool_length() + coordinates.head_offset();
  const Position stored = x.parameters().work_offset(*system);
  const Position offset =
      *kind == kSetFromPosition ? offset_from_position(x, stored, beside) : with_words(x, stored);
  x.set_six(kWorkOffset + (*system - 1) * kWorkSystemStride, offset);
  const bool is_active = *system == x.state().modal.work_system;
  if (is_active) coordinates.set_work_offset(offset);
  x.emit(SetWorkOffset{*system, is_active, offset});
  return {};
}

// H0 is accepted beside the manual's 1 to 99: it means no length, as on other controls.
Accepted use_tool_length(Execution& x) {
  ModalState& modal = x.state().modal;
  modal.length_source = LengthSource::spindle_tool;
  if (x.block().has('H')) {
    const auto tool = whole_word(x, 'H', 0, config::kMaxTool);
    if (!tool) return std::unexpected(tool.error());
    modal.length_source = LengthSource::table;
    modal.length_tool = *tool;
  }
  x.reload_tool_length();
  return {};
}

// A missing word is a length of 0: what is not written does not stay from an earlier tool.
Accepted use_length_words(Execution& x) {
  const Block& block = x.block();
  if (!block.has('I') && !block.has('K')) {
    return refuse(ErrorCode::word_missing, x.code_span(), "G43.1 has no length.",
                  "K along Z, I along X.");
  }
  const double scale = x.state().scale();
  x.state().modal.length_source = LengthSource::words;
  x.use_tool_length(block.find('I').value_or(0.0) * scale, block.find('K').value_or(0.0) * scale);
  return {};
}

Accepted cancel_tool_length(Execution& x) {
  x.state().modal.length_source = LengthSource::none;
  x.reload_tool_length();
  return {};
}

Accepted select_work_system(Execution& x) {
  const std::int32_t system = work_system_of(x.code());
  const Position offset = x.parameters().work_offset(system);
  x.state().modal.work_system = system;
  x.state().coordinates.set_work_offset(offset);
  x.set_parameter(kActiveSystem, system);
  x.emit(SetWorkOffset{system, true, offset});
  return {};
}

Accepted set_g92_offset(Execution& x) {
  const WorkCoordinates& coordinates = x.state().coordinates;
  const Position beside =
      coordinates.work_offset() + coordinates.tool_length() + coordinates.head_offset();
  const Position offset = offset_from_position(x, coordinates.g92_offset(), beside);
  x.set_six(kG92Offset, offset);
  use_g92(x, offset, true);
  return {};
}

Accepted clear_g92_offset(Execution& x) {
  x.set_six(kG92Offset, {});
  use_g92(x, {}, false);
  return {};
}

Accepted suspend_g92_offset(Execution& x) {
  use_g92(x, {}, false);
  return {};
}

Accepted restore_g92_offset(Execution& x) {
  use_g92(x, x.parameters().g92_offset(), true);
  return {};
}

}  // namespace cnc::interp
