// The core's time: segments to slices, slices to steps.
#include "hal/cpu5/firmware/core.h"
#include "hal/cpu5/firmware/slice_steps.h"

namespace cnc::hal::cpu5::firmware {

void Core::advance(Ticks ticks) {
  time_given_ += ticks;
  while (executing_ || start_next_segment()) {
    const Ticks length = slice_length();
    if (time_ + length > time_given_) return;
    time_ += length;
    run_slice(length);
  }
  time_ = time_given_;
  sample_inputs();
  if (host_silent()) fail(kLinkLost);
}

// What the host has sent ends in a planned stop as long as the host is well, so a silent one's
// segments are still executed: that is gentler than a stop on the spot.
bool Core::host_silent() const {
  return host_known_ && setup_.host_timeout > 0 && time_ - host_heard_ > setup_.host_timeout;
}

bool Core::start_next_segment() {
  if (fifo_.empty()) return false;
  segment_ = fifo_.pop();
  fifo_ticks_ -= segment_.duration;
  executing_ = true;
  elapsed_ = 0;
  start_position_ = position_;
  moving_axes_ = 0;
  waiting_for_index_ = segment_.wait_for_index;
  index_count_before_ = inputs_.index_count;
  wait_begin_ = time_;
  if (start_velocity_ == kStandstill) time_scale_ = scale_from_standstill();
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    const AxisMotion motion{.distance = segment_.position[axis] - start_position_[axis],
                            .start_velocity = start_velocity_[axis],
                            .end_velocity = segment_.velocity[axis],
                            .duration = segment_.duration};
    if (motion.stands_still()) continue;
    cubics_[axis] = Cubic(motion);
    moving_axes_ |= axis_bit(axis);
  }
  return true;
}

// While path time runs as time does, a slice ends with its segment at the latest.
Ticks Core::slice_length() const {
  if (waiting_for_index_ || time_scale_ != kFullScale) return kSliceTicks;
  const Ticks rest = segment_.duration - (elapsed_ >> kPathFractionBits);
  return rest < kSliceTicks ? rest : kSliceTicks;
}

void Core::run_slice(Ticks length) {
  sample_inputs();
  if (!executing_) return;
  if (waiting_for_index_) return wait_for_index();
  run_path(path_time_passing(length));
  if (path_stop_ == PathStop::stopping && time_scale_ == 0) complete_stop();
}

// The pulse came within this slice, its exact time ago: that is what has passed of the segment.
void Core::wait_for_index() {
  if (inputs_.index_count == index_count_before_) {
    const bool missing = setup_.index_timeout > 0 && time_ - wait_begin_ > setup_.index_timeout;
    if (missing) fail(kIndexMissing);
    return;
  }
  waiting_for_index_ = false;
  time_scale_ = scale_from_standstill();
  const Ticks since = time_ - inputs_.index_time;
  const Ticks passed = since < 0 ? 0 : since < kSliceTicks ? since : kSliceTicks;
  run_path(passed * time_scale_ >> (kScaleBits - kPathFractionBits));
}

PathTime Core::path_time_passing(Ticks length) {
  const TimeScale before = time_scale_;
  const TimeScale wanted = wanted_scale();
  if (wanted < before) time_scale_ -= least_allowed(allowed_loss, before - wanted, length);
  if (wanted > before) time_scale_ += least_allowed(allowed_gain, wanted - before, length);
  return length * (before + time_scale_) >> (1 + kScaleBits - kPathFractionBits);
}

TimeScale Core::wanted_scale() const {
  if (path_stop_ == PathStop::stopping) return 0;
  if (segment_.spindle_period == 0) return kFullScale;
  return time_scale_ + (spindle_ratio() - time_scale_) / kFollowSmoothing;
}

TimeScale Core::scale_from_standstill() const {
  return segment_.spindle_period == 0 ? kFullScale : spindle_ratio();
}

// Measured speed as a part of the planned one.
TimeScale Core::spindle_ratio() const {
  const Ticks period = spindle_.period(time_);
  if (period == 0) return 0;
  const TimeScale ratio = (TimeScale{segment_.spindle_period} << kScaleBits) / period;
  return ratio < kTopScale ? ratio : kTopScale;
}

TimeScale Core::least_allowed(Allowance allowance, TimeScale change, Ticks length) const {
  const Ticks elapsed = elapsed_ >> kPathFractionBits;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((moving_axes_ & axis_bit(axis)) == 0) continue;
    const PathDerivatives derivatives{.velocity = cubics_[axis].velocity_after(elapsed),
                                      .acceleration = cubics_[axis].acceleration_after(elapsed)};
    const TimeScale allowed =
        allowance(derivatives, setup_.max_acceleration[axis], time_scale_, length);
    if (allowed < change) change = allowed;
  }
  return change;
}

// Each segment's own piece of the way is stepped by itself, so that a corner is not cut.
void Core::run_path(PathTime way) {
  while (executing_) {
    const PathTime rest = path_time(segment_.duration) - elapsed_;
    const PathTime piece = way < rest ? way : rest;
    elapsed_ += piece;
    way -= piece;
    SliceSteps steps;
    place_axes(steps);
    emit(steps);
    if (executing_ && piece == rest) finish_segment();
    if (way == 0 || (!executing_ && !start_next_segment()) || waiting_for_index_) return;
  }
}

void Core::place_axes(SliceSteps& steps) {
  const bool at_end = elapsed_ == path_time(segment_.duration);
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((moving_axes_ & axis_bit(axis)) == 0) continue;
    const StepPosition target = at_end
                                    ? segment_.position[axis]
                                    : start_position_[axis] + cubics_[axis].distance_at(elapsed_);
    steps.add(axis, position_[axis], target);
    position_[axis] = target;
  }
}

// An armed axis reads the inputs after each of its steps, an armed probe after every step: the
// latch catches the very step at which the switch changed, at any speed. An estop seen there ends
// the slice too.
void Core::emit(SliceSteps& steps) {
  while (!steps.empty() && executing_) {
    const SliceSteps::Step step = steps.take();
    counts_[step.axis] += step.direction;
    io_.step(step.axis, step.direction);
    if (probe_.armed || (armed_axes_ & axis_bit(step.axis)) != 0) sample_inputs();
  }
}

void Core::finish_segment() {
  executing_ = false;
  start_velocity_ = segment_.velocity;
  const bool stands = start_velocity_ == kStandstill;
  if (stands && path_stop_ == PathStop::stopping) return complete_stop();
  if (!stands && fifo_.empty()) fail(kFifoUnderrun);
}

}  // namespace cnc::hal::cpu5::firmware
