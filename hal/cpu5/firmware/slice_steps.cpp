#include "hal/cpu5/firmware/slice_steps.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr int kMomentBits = 24;

}  // namespace

// nearest_step() changes half-way between two steps; `to_first` is the way to the first such place,
// at most one step, so that 24 more bits still fit.
void SliceSteps::add(std::size_t axis, StepPosition from, StepPosition to) {
  const std::int64_t first = nearest_step(from);
  const std::int64_t last = nearest_step(to);
  if (first == last) return;

  const bool upwards = last > first;
  const StepPosition way = upwards ? to - from : from - to;
  const StepPosition from_step = from - position_of_step(first);
  const StepPosition to_first = kOneStep / 2 + (upwards ? -from_step : from_step);
  lanes_[lane_count_++] = {.axis = axis,
                           .direction = upwards ? 1 : -1,
                           .steps_left = upwards ? last - first : first - last,
                           .moment = (to_first << kMomentBits) / way,
                           .interval = (kOneStep << kMomentBits) / way};
}

SliceSteps::Step SliceSteps::take() {
  std::size_t earliest = 0;
  for (std::size_t i = 1; i < lane_count_; ++i) {
    if (lanes_[i].moment < lanes_[earliest].moment) earliest = i;
  }
  Lane& lane = lanes_[earliest];
  const Step step{lane.axis, lane.direction, lane.moment};
  lane.moment += lane.interval;
  if (--lane.steps_left == 0) {
    // Closing the gap keeps the lanes in axis order, which decides between simultaneous steps.
    --lane_count_;
    for (std::size_t i = earliest; i < lane_count_; ++i) lanes_[i] = lanes_[i + 1];
  }
  return step;
}

}  // namespace cnc::hal::cpu5::firmware
