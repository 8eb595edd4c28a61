#include "interpreter/machine_state.h"

#include <utility>

namespace cnc::interp {

void WorkCoordinates::set_work_offset(const Position& offset) {
  work_offset_ = offset;
  sum_up();
}

void WorkCoordinates::set_g92_offset(const Position& offset) {
  g92_offset_ = offset;
  sum_up();
}

void WorkCoordinates::set_tool_length(double x, double z) {
  tool_length_[Axis::X] = x;
  tool_length_[Axis::Z] = z;
  sum_up();
}

void WorkCoordinates::set_head_offset(const Position& offset) {
  head_offset_ = offset;
  sum_up();
}

Position MachineState::machine_position() const {
  return compensation.acts() ? with_plane_point(position, modal.plane, compensation.tip) : position;
}

void MachineState::arrive(const Position& machine) {
  const Position programmed = std::exchange(position, machine);
  if (!compensation.acts()) return;
  compensation.put_tip(in_plane(machine, modal.plane));
  position = with_plane_point(position, modal.plane, in_plane(programmed, modal.plane));
}

void MachineState::put_back(const PlainState& before) {
  position = before.position;
  modal.motion = before.motion;
  modal.feed = before.feed;
  modal.linear_feed = before.linear_feed;
  modal.rotary_feed = before.rotary_feed;
}

}  // namespace cnc::interp
