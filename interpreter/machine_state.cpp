#include "interpreter/machine_state.h"

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

}  // namespace cnc::interp
