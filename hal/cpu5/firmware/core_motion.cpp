// The core's planning: segments to slices, slices to steps.
#include "hal/cpu5/firmware/core.h"
#include "hal/cpu5/firmware/slice_steps.h"

namespace cnc::hal::cpu5::firmware {
namespace {

/// Real time in which path time goes on by `way`, which is at most kSliceTicks * kTopScale.
constexpr Ticks time_of(PathTime way, TimeScale scale) {
  const PathTime passing = scale == kFullScale ? way : (way << kScaleBits) / scale;
  return (passing + path_time(1) / 2) >> kPathFractionBits;
}

}  // namespace

void Core::advance(Ticks ticks) {
  const Ticks end = player_.time() + ticks;
  Ticks now;
  do {
    plan();
    now = player_.slice_end();
    now = now < end ? now : end;
    player_.run_until(now);
  } while (now < end);
  plan();
}

void Core::plan() {
  if (host_inside_) {
    plan_put_off_ = true;
  } else {
    plan_now();
  }
}

void Core::plan_now() {
  if (const FaultBits alarms = player_.take_alarms(); alarms != 0) fail(alarms);
  const Played played = player_.played();
  spindle_.see(played.inputs.index_count, played.inputs.index_time);
  watch_spindle(played.time);
  watch_guards(played.inputs.ports);
  if (probe_awaited_ && played.probe_latch.caught) {
    probe_awaited_ = false;
    begin_stop();
  }
  // What a silent host has sent need not end at a standstill: the board brakes along it. A host
  // that speaks again meanwhile is told all the same: the path that it knows is not driven any
  // more.
  if (faults_ == 0 && host_silent()) host_is_lost_ = true;
  if (host_is_lost_) begin_stop();
  while (!player_.full() && has_path()) plan_slice();
  if (stop_is_planned_ && player_.idle()) complete_stop();
  if (host_is_lost_ && path_stop_ == PathStop::stopped) fail(kLinkLost);
}

/// A spindle that does not turn holds what waits for it or follows it, but not for ever.
void Core::watch_spindle(Ticks now) {
  const bool follows = executing_ && segment_.spindle_period != 0;
  if (!waiting_for_index_ && !(follows && spindle_.period(now) == 0)) wait_begin_ = now;
  if (setup_.index_timeout > 0 && now - wait_begin_ > setup_.index_timeout) fail(kIndexMissing);
}

bool Core::host_silent() const {
  if (!host_known_) return false;
  return host_heard_ == kHostGone ||
         (setup_.host_timeout > 0 && player_.time() - host_heard_ > setup_.host_timeout);
}

// A segment that waits for the spindle does so at a standstill, and is planned slice by slice, so
// that the pulse is seen soon.
bool Core::has_path() {
  if (stop_is_planned_) return false;
  if (waiting_for_index_) return player_.idle();
  if (executing_) return true;
  if (fifo_.empty() || (fifo_[0].wait_for_index && !player_.idle())) return false;
  start_next_segment();
  return true;
}

void Core::start_next_segment() {
  segment_ = fifo_.pop();
  fifo_ticks_ -= segment_.duration;
  executing_ = true;
  change_is_due_ = true;
  elapsed_ = 0;
  start_position_ = position_;
  moving_axes_ = 0;
  waiting_for_index_ = segment_.wait_for_index;
  if (waiting_for_index_) index_count_before_ = player_.played().inputs.index_count;
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
}

void Core::plan_slice() {
  if (waiting_for_index_) wait_for_index();
  if (!executing_) return;
  Slice& slice = player_.next_slice();
  slice.begin = player_.planned_until();
  slice.from = place();
  slice.step_count = 0;
  const bool begins = change_is_due_ && !waiting_for_index_;
  slice.change = begins ? segment_.change : OutputChange{};
  change_is_due_ = change_is_due_ && !begins;
  const TimeScale scale_before = time_scale_;
  PathTime way = 0;
  if (owed_ > 0) {
    slice.length = 0;
    way = owed_ < path_time(kSliceTicks) ? owed_ : path_time(kSliceTicks);
    owed_ -= way;
  } else {
    slice.length = slice_length();
    if (!waiting_for_index_) way = path_time_passing(slice.length);
  }
  slice.scale = waiting_for_index_ ? 0 : (scale_before + time_scale_) / 2;
  const PathTime made = plan_steps(slice, way);
  if (made < way) shorten(slice, made, way, scale_before);
  if (path_stop_ == PathStop::stopping && time_scale_ == 0) stop_is_planned_ = true;
  slice.to = place();
  const bool stands = !executing_ && start_velocity_ == kStandstill;
  slice.goes_on = !stands && !stop_is_planned_ && !waiting_for_index_;
  player_.commit();
}

PathPlace Core::place() const {
  return {.id = segment_.id, .duration = segment_.duration, .elapsed = elapsed_};
}

// While path time runs as time does, a slice ends with its segment at the latest.
Ticks Core::slice_length() const {
  if (waiting_for_index_ || time_scale_ != kFullScale) return kSliceTicks;
  const Ticks rest = segment_.duration - (elapsed_ >> kPathFractionBits);
  return rest < kSliceTicks ? rest : kSliceTicks;
}

// What has passed since the pulse is path time already.
void Core::wait_for_index() {
  const Played played = player_.played();
  if (played.inputs.index_count == index_count_before_) return;
  constexpr Ticks kMostOwed = 4 * kSliceTicks;
  waiting_for_index_ = false;
  time_scale_ = scale_from_standstill();
  const Ticks since = player_.planned_until() - played.inputs.index_time;
  const Ticks passed = since < 0 ? 0 : since < kMostOwed ? since : kMostOwed;
  owed_ = passed * time_scale_ >> (kScaleBits - kPathFractionBits);
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
  const Ticks period = spindle_.period(player_.time());
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

// Each segment's own piece of the way is stepped by itself, so that a corner is not cut. A slice
// that finds no segment for its whole way, or comes to one that switches outputs, becomes shorter:
// the next one goes on without a pause.
PathTime Core::plan_steps(Slice& slice, PathTime way) {
  PathTime made = 0;
  while (made < way) {
    if (!executing_) {
      if (!next_follows()) break;
      start_next_segment();
    }
    const PathTime rest = path_time(segment_.duration) - elapsed_;
    const PathTime piece = way - made < rest ? way - made : rest;
    plan_piece(slice, made, piece);
    made += piece;
    if (piece == rest) finish_segment();
  }
  return made;
}

void Core::shorten(Slice& slice, PathTime made, PathTime way, TimeScale scale_before) {
  if (slice.length == 0) {
    if (start_velocity_ != kStandstill) owed_ += way - made;
    return;
  }
  slice.length = time_of(made, slice.scale);
  time_scale_ = scale_before + (time_scale_ - scale_before) * made / way;
}

// Within the same slice.
bool Core::next_follows() const {
  return !stop_is_planned_ && !fifo_.empty() && !fifo_[0].wait_for_index && fifo_[0].change.empty();
}

void Core::plan_piece(Slice& slice, PathTime made, PathTime piece) {
  const PathTime begin = elapsed_;
  SliceSteps steps;
  add_axes(steps, piece);
  while (!steps.empty() && slice.step_count < kMostSteps) {
    const SliceSteps::Step step = steps.take();
    const Ticks due = slice.length == 0 ? 0 : time_of(made + step.moment - begin, slice.scale);
    const Ticks offset = due < slice.length ? due : slice.length;
    slice.steps[slice.step_count++] = {.offset = static_cast<std::uint16_t>(offset),
                                       .axis = static_cast<std::uint8_t>(step.axis),
                                       .direction = static_cast<std::int8_t>(step.direction)};
  }
}

// Takes the axes on by a piece of the segment.
void Core::add_axes(SliceSteps& steps, PathTime piece) {
  const PathTime before = elapsed_;
  elapsed_ += piece;
  const bool at_end = elapsed_ == path_time(segment_.duration);
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((moving_axes_ & axis_bit(axis)) == 0) continue;
    const StepPosition target = at_end
                                    ? segment_.position[axis]
                                    : start_position_[axis] + cubics_[axis].distance_at(elapsed_);
    steps.add(axis, {.cubic = cubics_[axis],
                     .origin = start_position_[axis],
                     .from = position_[axis],
                     .to = target,
                     .after = before,
                     .before = elapsed_});
    position_[axis] = target;
  }
}

void Core::finish_segment() {
  executing_ = false;
  start_velocity_ = segment_.velocity;
  const bool stands = start_velocity_ == kStandstill;
  if (stands) owed_ = 0;  // to this path; the next may wait for another pulse, or come much later
  stop_is_planned_ = stands && path_stop_ == PathStop::stopping;
}

}  // namespace cnc::hal::cpu5::firmware
