#include "hal/cpu5/firmware/core.h"

#include <utility>

#include "hal/counting_round.h"
#include "hal/cpu5/firmware/pulse_shaper.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr bool within(std::int64_t value, std::int64_t limit) {
  return -limit <= value && value <= limit;
}

// The tests come in this order because each makes the arithmetic of the next one safe. Velocity is
// a parabola between its ends and a third value, m (hermite.cpp): where that is no higher than the
// limit either, as in most segments, nothing has to be divided.
bool slow_enough(const AxisMotion& motion, StepVelocity max_velocity) {
  const StepPosition limit = max_velocity * motion.duration;
  if (!within(motion.distance, limit) || !within(motion.end_velocity, max_velocity)) return false;
  const StepVelocity ends = motion.start_velocity + motion.end_velocity;
  return within(3 * motion.distance - ends * motion.duration, limit) ||
         peak_speed(motion) <= max_velocity;
}

bool in_range(const Setup& setup) {
  for (const StepAcceleration limit : setup.max_acceleration) {
    if (limit < 0 || limit > kTopAcceleration) return false;
  }
  return setup.max_velocity > 0 && setup.max_velocity <= kTopVelocity && setup.host_timeout >= 0 &&
         setup.index_timeout >= 0 && pulses_possible(setup);
}

}  // namespace

class Core::HostCall {
 public:
  explicit HostCall(Core& core) : core_(core) { core_.host_inside_ = true; }
  HostCall(const HostCall&) = delete;
  HostCall& operator=(const HostCall&) = delete;
  // Another plan() may be put off while one is made up for.
  ~HostCall() {
    core_.host_inside_ = false;
    while (core_.plan_put_off_.exchange(false)) {
      core_.host_inside_ = true;
      core_.plan_now();
      core_.host_inside_ = false;
    }
  }

 private:
  Core& core_;
};

Core::Core(BoardIo& io) : io_(io), player_(io) {
  if (player_.inputs_now().estop()) fail(kEstop);
}

bool Core::set_up(const Setup& setup) {
  const HostCall call(*this);
  if (!in_range(setup) || moving()) return false;
  stop_pulses();
  stop_again_ = false;
  setup_ = setup;
  io_.set_up(setup_);
  guards_.set_rules(setup_.guards);
  return true;
}

// --- the host's requests -------------------------------------------------------------------------

void Core::host_alive() {
  const HostCall call(*this);
  host_known_ = true;
  host_heard_ = player_.time();
}

void Core::host_left() {
  const HostCall call(*this);
  host_known_ = moving();
  if (moving()) {
    host_heard_ = kHostGone;
  } else {
    player_.set_outputs(safe_outputs());
  }
}

bool Core::push(const Segment& segment) {
  const HostCall call(*this);
  if (faults_ != 0 || path_stop_ == PathStop::stopped || cut_late_ || fifo_.free() == 0) {
    return false;
  }
  if (!acceptable(segment)) {
    fail(kBadSegment);
    return false;
  }
  fifo_.push(segment);
  fifo_ticks_ += segment.duration;
  tail_position_ = segment.position;
  tail_velocity_ = segment.velocity;
  tail_scaled_ = may_be_scaled(segment) && segment.velocity != kStandstill;
  tail_id_ = segment.id;
  any_id_ = false;
  return true;
}

bool Core::acceptable(const Segment& segment) const {
  const bool in_order = any_id_ ? segment.id != 0 : segment.id == id_after(tail_id_);
  if (!in_order || segment.duration == 0 || segment.duration > kMaxSegmentTicks) return false;
  if (segment.wait_for_index && tail_velocity_ != kStandstill) return false;
  const StepVelocity max_velocity =
      may_be_scaled(segment) ? setup_.max_velocity * kFullScale / kTopScale : setup_.max_velocity;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if (!within(segment.position[axis], kMaxPosition)) return false;
    const AxisMotion motion{.distance = segment.position[axis] - tail_position_[axis],
                            .start_velocity = tail_velocity_[axis],
                            .end_velocity = segment.velocity[axis],
                            .duration = segment.duration};
    if (!slow_enough(motion, max_velocity)) return false;
  }
  return true;
}

// A scale that differs from 1 stays with the path until it stands.
bool Core::may_be_scaled(const Segment& segment) const {
  return segment.spindle_period != 0 || tail_scaled_;
}

void Core::cut_behind(std::uint32_t id) {
  const HostCall call(*this);
  if (faults_ != 0) return;
  const bool tail_stays = path_stop_ == PathStop::stopping && id == tail_id_;
  if (tail_stays) any_id_ = true;
  cut_late_ = !tail_stays && (path_stop_ != PathStop::none || !cut_fifo_behind(id));
}

bool Core::cut_fifo_behind(std::uint32_t id) {
  if (under_way() && segment_.id == id) {
    keep_waiting(0);
    return true;
  }
  for (std::uint32_t i = 0; i < fifo_.size(); ++i) {
    if (fifo_[i].id != id) continue;
    keep_waiting(i + 1);
    return true;
  }
  // The whole path is made: nothing is left to be dropped.
  if (moving() || tail_id_ != id) return false;
  any_id_ = true;
  return true;
}

// The tail becomes what it was when the last of them had been pushed.
void Core::keep_waiting(std::uint32_t count) {
  const auto scaled_behind = [](const Segment& segment, bool scaled_before) {
    return (scaled_before || segment.spindle_period != 0) && segment.velocity != kStandstill;
  };
  tail_scaled_ = under_way() && scaled_behind(segment_, time_scale_ != kFullScale);
  fifo_ticks_ = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    tail_scaled_ = scaled_behind(fifo_[i], tail_scaled_);
    fifo_ticks_ += fifo_[i].duration;
  }
  fifo_.cut(count);
  const Segment& last = count > 0 ? fifo_[count - 1] : segment_;
  tail_position_ = last.position;
  tail_velocity_ = last.velocity;
  tail_id_ = last.id;
  any_id_ = true;
}

void Core::quick_stop() {
  const HostCall call(*this);
  stop_pulses();
  stop_again_ = false;
}

void Core::stop_along_path() {
  const HostCall call(*this);
  begin_stop();
}

void Core::release_stop() {
  const HostCall call(*this);
  if (path_stop_ != PathStop::stopped) return;
  path_stop_ = PathStop::none;
  cut_late_ = false;
  if (std::exchange(stop_again_, false)) begin_stop();
}

void Core::clear_faults() {
  const HostCall call(*this);
  player_.forget_alarms();  // first: one that comes now is seen
  stop_pulses();
  stop_again_ = host_is_lost_ = false;
  faults_ = 0;
  if (player_.inputs_now().estop()) fail(kEstop);  // still pressed
}

bool Core::set_outputs(const Outputs& outputs) {
  const HostCall call(*this);
  if (faults_ != 0) return false;
  player_.set_outputs(outputs);
  return true;
}

bool Core::change_outputs(const OutputChange& change) {
  const HostCall call(*this);
  if (faults_ != 0) return false;
  player_.change_outputs(change);
  return true;
}

void Core::arm_latch(std::size_t axis, Edge edge) { player_.arm_latch(axis, edge); }

void Core::disarm_latch(std::size_t axis) { player_.disarm_latch(axis); }

void Core::arm_probe() {
  const HostCall call(*this);
  player_.arm_probe();
  probe_awaited_ = true;
  if (player_.played().probe_latch.active_at_arming) begin_stop();
}

void Core::disarm_probe() { player_.disarm_probe(); }

// --- stops ---------------------------------------------------------------------------------------

void Core::watch_guards(PortBits ports) {
  switch (guards_.look(ports)) {
    case GuardAction::nothing:
    case GuardAction::warning:
      return;
    case GuardAction::smooth_stop:
      // The release of a stop that is under way is not meant for this one.
      stop_again_ = path_stop_ != PathStop::none;
      return begin_stop();
    case GuardAction::quick_stop:
      return fail(kGuardStop);
  }
}

// While it waits for the spindle the machine stands, too.
void Core::begin_stop() {
  if (path_stop_ != PathStop::none) return;
  path_stop_ = PathStop::stopping;
  if (waiting_for_index_ || !under_way()) return complete_stop();
  stop_is_planned_ = !executing_ && start_velocity_ == kStandstill;
}

void Core::complete_stop() {
  stop_pulses();
  path_stop_ = PathStop::stopped;
}

// The position becomes the step on which each motor stands: what was still to be stepped is not
// owed to anyone.
void Core::stop_pulses() {
  player_.drop();
  executing_ = false;
  waiting_for_index_ = change_is_due_ = false;
  path_stop_ = PathStop::none;
  stop_is_planned_ = false;
  owed_ = 0;
  cut_late_ = false;
  time_scale_ = kFullScale;
  fifo_.clear();
  fifo_ticks_ = 0;
  any_id_ = true;
  const PerAxis<std::int64_t> counts = player_.played().counts;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    position_[axis] = position_of_step(counts[axis]);
  }
  start_velocity_ = {};
  tail_position_ = position_;
  tail_velocity_ = {};
  tail_scaled_ = false;
}

void Core::fail(FaultBits fault) {
  stop_pulses();
  host_is_lost_ = false;
  if ((faults_ & fault) == fault) return;
  faults_ = static_cast<FaultBits>(faults_ | fault);
  player_.set_outputs(safe_outputs());
}

Outputs Core::safe_outputs() const {
  return {.drives_enabled = player_.outputs().drives_enabled && !setup_.drives_off_on_fault};
}

bool Core::under_way() const { return executing_ || !player_.idle(); }

bool Core::moving() const { return under_way() || !fifo_.empty(); }

Status Core::status() {
  const HostCall call(*this);
  const Played played = player_.played();
  const Ticks planned_ahead = player_.idle() ? 0 : player_.planned_until() - played.time;
  Inputs inputs = played.inputs;
  inputs.alarm |= player_.alarmed_axes();
  const Ticks rest = executing_ ? segment_.duration - (elapsed_ >> kPathFractionBits) : 0;
  return {.time = played.time,
          .faults = faults_,
          .executing_id = played.place.id,
          .executing_elapsed = played.place.elapsed >> kPathFractionBits,
          .executing_duration = played.place.duration,
          .fifo_count = fifo_.size(),
          .fifo_free = fifo_.free(),
          .queued_time = planned_ahead + rest + fifo_ticks_,
          .moving = moving(),
          .counts = played.counts,
          .inputs = inputs,
          .spindle_period = spindle_.period(played.time),
          .home_latch = played.home_latch,
          .probe_latch = played.probe_latch,
          .estop_latch = played.estop_latch,
          .index_counts = played.index_counts,
          .path_stop = path_stop_,
          .cut_late = cut_late_,
          .time_scale = time_scale_,
          .outputs = player_.outputs(),
          .guard_counts = guards_.counts()};
}

}  // namespace cnc::hal::cpu5::firmware
