#include "hal/cpu5/firmware/slice_steps.h"

namespace cnc::hal::cpu5::firmware {

void SliceSteps::add(std::size_t axis, const AxisPiece& piece) {
  const std::int64_t first = nearest_step(piece.from);
  const std::int64_t last = nearest_step(piece.to);
  if (first == last) return;

  const bool upwards = last > first;
  const StepPosition middle = position_of_step(first) + (upwards ? kOneStep / 2 : -kOneStep / 2);
  Lane& lane = lanes_[lane_count_++];
  lane = {.axis = axis,
          .direction = upwards ? 1 : -1,
          .steps_left = upwards ? last - first : first - last,
          .cubic = &piece.cubic,
          .next = {.distance = middle - piece.origin,
                   .upwards = upwards,
                   .after = piece.after,
                   .before = piece.before},
          .moment = 0};
  lane.find_moment();
}

SliceSteps::Step SliceSteps::take() {
  std::size_t earliest = 0;
  for (std::size_t i = 1; i < lane_count_; ++i) {
    if (lanes_[i].moment < lanes_[earliest].moment) earliest = i;
  }
  Lane& lane = lanes_[earliest];
  const Step step{lane.axis, lane.direction, lane.moment};
  if (--lane.steps_left == 0) {
    // Closing the gap keeps the lanes in axis order, which decides between simultaneous steps.
    --lane_count_;
    for (std::size_t i = earliest; i < lane_count_; ++i) lanes_[i] = lanes_[i + 1];
  } else {
    lane.next.distance += lane.direction * kOneStep;
    lane.next.after = lane.moment;
    lane.find_moment();
  }
  return step;
}

}  // namespace cnc::hal::cpu5::firmware
