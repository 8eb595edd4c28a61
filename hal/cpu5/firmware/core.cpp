#include "hal/cpu5/firmware/core.h"

#include "hal/cpu5/firmware/slice_steps.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr bool within(std::int64_t value, std::int64_t limit) {
  return -limit <= value && value <= limit;
}

constexpr std::uint32_t id_after(std::uint32_t id) { return id + 1 == 0 ? 1 : id + 1; }

// The tests come in this order because each makes the arithmetic of the next one safe.
bool slow_enough(const AxisMotion& motion, StepVelocity max_velocity) {
  return within(motion.distance, max_velocity * motion.duration) &&
         within(motion.end_velocity, max_velocity) && peak_speed(motion) <= max_velocity;
}

}  // namespace

Core::Core(BoardIo& io) : io_(io) {
  io_.set_outputs(outputs_);
  sample_inputs();
}

bool Core::set_up(const Setup& setup) {
  const bool valid =
      setup.max_velocity > 0 && setup.max_velocity <= kTopVelocity && setup.host_timeout >= 0;
  if (!valid || executing_ || !fifo_.empty()) return false;
  setup_ = setup;
  return true;
}

// --- the host's requests -------------------------------------------------------------------------

void Core::host_alive() {
  host_known_ = true;
  host_heard_ = time_given_;
}

bool Core::push(const Segment& segment) {
  if (faults_ != 0 || fifo_.free() == 0) return false;
  if (!acceptable(segment)) {
    fail(kBadSegment);
    return false;
  }
  fifo_.push(segment);
  fifo_ticks_ += segment.duration;
  tail_position_ = segment.position;
  tail_velocity_ = segment.velocity;
  tail_id_ = segment.id;
  any_id_ = false;
  return true;
}

bool Core::acceptable(const Segment& segment) const {
  const bool in_order = any_id_ ? segment.id != 0 : segment.id == id_after(tail_id_);
  if (!in_order || segment.duration == 0 || segment.duration > kMaxSegmentTicks) return false;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if (!within(segment.position[axis], kMaxPosition)) return false;
    const AxisMotion motion{.distance = segment.position[axis] - tail_position_[axis],
                            .start_velocity = tail_velocity_[axis],
                            .end_velocity = segment.velocity[axis],
                            .duration = segment.duration};
    if (!slow_enough(motion, setup_.max_velocity)) return false;
  }
  return true;
}

void Core::quick_stop() { stop_pulses(); }

void Core::clear_faults() {
  stop_pulses();
  faults_ = 0;
  sample_inputs();  // an estop that is still pressed is a fault again
}

bool Core::set_outputs(const Outputs& outputs) {
  if (faults_ != 0) return false;
  outputs_ = outputs;
  io_.set_outputs(outputs_);
  return true;
}

void Core::arm_latch(std::size_t axis, Edge edge) {
  sample_inputs();  // an edge counts from now on
  latches_[axis] = {.armed = true, .caught = false, .edge = edge, .count = 0};
  armed_axes_ |= axis_bit(axis);
}

void Core::disarm_latch(std::size_t axis) {
  latches_[axis].armed = false;
  armed_axes_ &= static_cast<std::uint8_t>(~axis_bit(axis));
}

// --- time ----------------------------------------------------------------------------------------

void Core::advance(Ticks ticks) {
  time_given_ += ticks;
  while (executing_ || start_next_segment()) {
    const Ticks rest = segment_.duration - elapsed_;
    const Ticks length = rest < kSliceTicks ? rest : kSliceTicks;
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

void Core::run_slice(Ticks length) {
  sample_inputs();
  if (!executing_) return;
  elapsed_ += length;
  SliceSteps steps;
  place_axes(steps);
  emit(steps);
  if (executing_ && elapsed_ == segment_.duration) finish_segment();
}

void Core::place_axes(SliceSteps& steps) {
  const bool at_end = elapsed_ == segment_.duration;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((moving_axes_ & axis_bit(axis)) == 0) continue;
    const StepPosition target =
        at_end ? segment_.position[axis]
               : start_position_[axis] + cubics_[axis].distance_after(elapsed_);
    steps.add(axis, position_[axis], target);
    position_[axis] = target;
  }
}

// An armed axis reads the inputs after each of its steps: the latch catches the very step at which
// the switch changed, at any speed. An estop seen there ends the slice too.
void Core::emit(SliceSteps& steps) {
  while (!steps.empty() && executing_) {
    const SliceSteps::Step step = steps.take();
    counts_[step.axis] += step.direction;
    io_.step(step.axis, step.direction);
    if ((armed_axes_ & axis_bit(step.axis)) != 0) sample_inputs();
  }
}

void Core::finish_segment() {
  executing_ = false;
  start_velocity_ = segment_.velocity;
  constexpr PerAxis<StepVelocity> kStandstill{};
  if (fifo_.empty() && start_velocity_ != kStandstill) fail(kFifoUnderrun);
}

// --- inputs and stops ----------------------------------------------------------------------------

void Core::sample_inputs() {
  const std::uint8_t home_before = inputs_.home;
  inputs_ = io_.inputs();
  if (armed_axes_ != 0 && inputs_.home != home_before) catch_latches(home_before);
  if (inputs_.estop) fail(kEstop);
}

void Core::catch_latches(std::uint8_t home_before) {
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    HomeLatch& latch = latches_[axis];
    const bool was_active = (home_before & axis_bit(axis)) != 0;
    const bool is_active = (inputs_.home & axis_bit(axis)) != 0;
    if (!latch.armed || was_active == is_active) continue;
    if (is_active != (latch.edge == Edge::activate)) continue;
    latch.caught = true;
    latch.count = counts_[axis];
    disarm_latch(axis);
  }
}

// The position becomes the step on which each motor stands: what was still to be stepped is not
// owed to anyone.
void Core::stop_pulses() {
  executing_ = false;
  fifo_.clear();
  fifo_ticks_ = 0;
  any_id_ = true;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    position_[axis] = position_of_step(counts_[axis]);
  }
  start_velocity_ = {};
  tail_position_ = position_;
  tail_velocity_ = {};
}

void Core::fail(FaultBits fault) {
  if ((faults_ & fault) != 0) return;
  faults_ = static_cast<FaultBits>(faults_ | fault);
  stop_pulses();
  outputs_ = Outputs{.drives_enabled = outputs_.drives_enabled && !setup_.drives_off_on_fault};
  io_.set_outputs(outputs_);
}

Status Core::status() const {
  return {.time = time_,
          .faults = faults_,
          .executing_id = segment_.id,
          .executing_elapsed = elapsed_,
          .executing_duration = segment_.duration,
          .fifo_count = fifo_.size(),
          .fifo_free = fifo_.free(),
          .queued_time = fifo_ticks_ + (executing_ ? segment_.duration - elapsed_ : 0),
          .moving = executing_ || !fifo_.empty(),
          .counts = counts_,
          .inputs = inputs_,
          .home_latch = latches_,
          .outputs = outputs_};
}

}  // namespace cnc::hal::cpu5::firmware
