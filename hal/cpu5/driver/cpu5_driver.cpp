#include "hal/cpu5/driver/cpu5_driver.h"

#include <algorithm>
#include <fmt/format.h>

#include "hal/cpu5/driver/board_values.h"

namespace cnc::hal::cpu5 {
namespace {

static_assert(firmware::kAxisCount == cnc::kAxisCount);
static_assert(firmware::kFifoUnderrun == static_cast<Faults>(Fault::fifo_underrun));
static_assert(firmware::kEstop == static_cast<Faults>(Fault::estop));
static_assert(firmware::kBadSegment == static_cast<Faults>(Fault::bad_segment));
static_assert(firmware::kLinkLost == static_cast<Faults>(Fault::link_lost));
static_assert(firmware::kIndexMissing == static_cast<Faults>(Fault::index_missing));

constexpr double seconds(firmware::Ticks ticks) {
  return static_cast<double>(ticks) / double{firmware::kTicksPerSecond};
}

// The board refuses segments from 1 % above the frequency that the configuration may use: rounded
// durations and the cubic's ripple around a constant speed must not trip it. What no board can
// make, and what is not a number, still gets there as a number: refusing it is the board's part.
firmware::StepVelocity max_velocity_for(const DriverSettings& settings) {
  const double limit = std::fmin(std::fmax(settings.max_step_frequency * 1.01, 0.0), 1e6);
  return firmware::velocity_of_frequency(std::llround(limit));
}

constexpr double kTicksPerMinute = 60.0 * double{firmware::kTicksPerSecond};

// 0 for a speed that nothing can follow, and for what is not a number.
std::uint32_t period_of(double speed) {
  const bool usable = speed >= 1.0 && speed <= 1e6;
  return usable ? static_cast<std::uint32_t>(std::lround(kTicksPerMinute / speed)) : 0;
}

double speed_of(firmware::Ticks period) {
  return period == 0 ? 0.0 : kTicksPerMinute / static_cast<double>(period);
}

double phase_of(const firmware::Status& board) {
  if (board.executing_duration == 0) return 0.0;
  return static_cast<double>(board.executing_elapsed) /
         static_cast<double>(board.executing_duration);
}

}  // namespace

Cpu5Driver::Cpu5Driver(const config::MachineConfig& config, const DriverSettings& settings,
                       std::unique_ptr<BoardPort> port)
    : axes_(config.axes), settings_(settings), port_(std::move(port)) {
  for (const Axis axis : kAllAxes) scales_[axis] = MotorScale(axes_[axis].steps_per_unit);
}

// --- connection ----------------------------------------------------------------------------------

Result<Capabilities> Cpu5Driver::connect() {
  if (auto checked = check_axes(); !checked) return std::unexpected(checked.error());
  const auto opened = port_->open(setup());
  if (!opened) return std::unexpected(opened.error());
  frame_.reset();
  clock_.reset();
  board_ = *opened;
  read_status();
  status_.connected = true;
  return Capabilities{.fifo_capacity = firmware::kFifoCapacity,
                      .max_step_frequency = settings_.max_step_frequency,
                      .min_segment_duration = seconds(firmware::kMinSegmentTicks)};
}

// An axis without a motor loses nothing however hard it stops, so it sets no limit.
firmware::Setup Cpu5Driver::setup() const {
  firmware::Setup result{
      .max_velocity = max_velocity_for(settings_),
      .host_timeout = std::llround(settings_.host_timeout * double{firmware::kTicksPerSecond}),
      .index_timeout = std::llround(settings_.index_timeout * double{firmware::kTicksPerSecond}),
      .drives_off_on_fault = settings_.drives_off_on_fault};
  for (const Axis axis : kAllAxes) {
    if (!axes_[axis].connected()) continue;
    result.max_acceleration[index_of(axis)] =
        scales_[axis].to_step_acceleration(axes_[axis].acceleration);
  }
  return result;
}

Result<void> Cpu5Driver::check_axes() const {
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& motor = axes_[axis];
    if (!std::isfinite(motor.steps_per_unit) || motor.steps_per_unit == 0.0) {
      return fail(ErrorCode::axis_steps_per_unit_unusable,
                  fmt::format("Axis {} has {} steps per unit; it must be a number other than 0.",
                              axis_name(axis), motor.steps_per_unit));
    }
    const double frequency = std::abs(motor.steps_per_unit) * motor.velocity;
    if (motor.connected() && frequency > settings_.max_step_frequency) {
      return fail(ErrorCode::step_frequency_too_high,
                  fmt::format("Axis {} at {} per second with {} steps per unit needs {} steps/s; "
                              "the board makes {}.",
                              axis_name(axis), motor.velocity, motor.steps_per_unit, frequency,
                              settings_.max_step_frequency));
    }
  }
  return {};
}

void Cpu5Driver::disconnect() {
  port_->close();
  status_.connected = false;
}

const ControllerStatus& Cpu5Driver::exchange(double now) {
  if (!status_.connected) return status_;
  status_.connected = port_->exchange(now, frame_, board_);
  if (!status_.connected) return status_;
  frame_.reset();
  read_status();
  return status_;
}

// --- requests ------------------------------------------------------------------------------------

std::size_t Cpu5Driver::free_segments() const {
  const bool made_free = frame_.clear_faults || frame_.quick_stop || frame_.release_stop;
  const bool in_fault = status_.faults != 0 && !frame_.clear_faults;
  const bool held = status_.path_stop == PathStop::stopped && !made_free;
  if (!status_.connected || in_fault || held) return 0;
  const std::uint32_t board_free = made_free         ? firmware::kFifoCapacity
                                   : !frame_.has_cut ? board_.fifo_free
                                                     : firmware::kFifoCapacity - most_kept_by_cut();
  const std::uint32_t used =
      frame_.segment_count - (frame_.has_cut ? frame_.segments_before_cut : 0);
  return board_free > used ? board_free - used : 0;
}

// Numbers go up, so there are no more segments between two of them than their difference.
std::uint32_t Cpu5Driver::most_kept_by_cut() const {
  const std::uint32_t waiting = board_.fifo_count + frame_.segments_before_cut;
  return std::min({waiting, frame_.cut_behind - board_.executing_id, firmware::kFifoCapacity});
}

std::size_t Cpu5Driver::push(std::span<const Segment> segments) {
  const auto taken = segments.first(std::min(segments.size(), free_segments()));
  for (const Segment& segment : taken) frame_.segments[frame_.segment_count++] = to_board(segment);
  return taken.size();
}

firmware::Segment Cpu5Driver::to_board(const Segment& segment) {
  firmware::Segment result{.id = segment.id,
                           .duration = clock_.ticks_for(segment.duration),
                           .wait_for_index = segment.wait_for_index,
                           .spindle_period = period_of(segment.spindle_speed)};
  const bool refused = segment.spindle_speed != 0.0 && result.spindle_period == 0;
  if (refused) result.duration = 0;  // by the board, as every bad segment is
  for (const Axis axis : kAllAxes) {
    const MotorScale& scale = scales_[axis];
    result.position[index_of(axis)] = scale.to_steps(segment.position[axis]);
    result.velocity[index_of(axis)] = scale.to_step_velocity(segment.velocity[axis]);
  }
  return result;
}

void Cpu5Driver::set_outputs(const Outputs& outputs) {
  frame_.has_outputs = true;
  frame_.outputs = cpu5::to_board(outputs);
}

void Cpu5Driver::cut_behind(std::uint32_t id) {
  frame_.has_cut = true;
  frame_.cut_behind = id;
  frame_.segments_before_cut = frame_.segment_count;
  clock_.reset();
}

void Cpu5Driver::quick_stop() {
  drop_segments();
  frame_.quick_stop = true;
}

void Cpu5Driver::stop_along_path() { frame_.stop_along_path = true; }

void Cpu5Driver::release_stop() {
  if (status_.path_stop != PathStop::stopped) return;
  drop_segments();
  frame_.release_stop = true;
}

// Outputs asked for before the reset do not survive it: a spindle must not start because a fault
// was cleared.
void Cpu5Driver::clear_faults() {
  drop_segments();
  frame_.has_outputs = false;
  frame_.clear_faults = true;
}

void Cpu5Driver::drop_segments() {
  frame_.segment_count = 0;
  frame_.has_cut = false;
  clock_.reset();
}

bool Cpu5Driver::set_position(Axis axis, double position) {
  if (status_.moving || frame_.segment_count != 0) return false;
  scales_[axis].set_position(position, board_.counts[index_of(axis)]);
  status_.position[axis] = position;
  return true;
}

void Cpu5Driver::arm_home_latch(Axis axis, LatchEdge edge) {
  frame_.latch[index_of(axis)] = edge == LatchEdge::activate ? firmware::LatchRequest::arm_activate
                                                             : firmware::LatchRequest::arm_release;
  status_.home_latch[axis] = {.armed = true};
}

void Cpu5Driver::disarm_home_latch(Axis axis) {
  frame_.latch[index_of(axis)] = firmware::LatchRequest::disarm;
  status_.home_latch[axis].armed = false;
}

void Cpu5Driver::arm_probe_latch() {
  frame_.probe = firmware::ProbeRequest::arm;
  status_.probe_latch = {.armed = true};
}

void Cpu5Driver::disarm_probe_latch() {
  frame_.probe = firmware::ProbeRequest::disarm;
  status_.probe_latch.armed = false;
}

// --- status --------------------------------------------------------------------------------------

void Cpu5Driver::read_status() {
  status_.time = seconds(board_.time);
  status_.faults = board_.faults;
  status_.executing_id = board_.executing_id;
  status_.executing_phase = phase_of(board_);
  status_.fifo_count = board_.fifo_count;
  status_.fifo_time = seconds(board_.queued_time);
  status_.moving = board_.moving;
  status_.path_stop = from_board(board_.path_stop);
  status_.cut_late = board_.cut_late;
  status_.time_scale = static_cast<double>(board_.time_scale) / double{firmware::kFullScale};
  status_.inputs = from_board(board_.inputs);
  status_.spindle_speed = speed_of(board_.spindle_period);
  status_.spindle_index_count = board_.inputs.index_count;
  status_.outputs = from_board(board_.outputs);
  status_.position = position_of(board_.counts);
  read_latches();
  read_probe_latch();
}

// A caught count is converted once, when it is first seen: a later set_position() must not move it.
void Cpu5Driver::read_latches() {
  for (const Axis axis : kAllAxes) {
    const firmware::HomeLatch& caught = board_.home_latch[index_of(axis)];
    Latch& latch = status_.home_latch[axis];
    if (caught.caught && !latch.caught) latch.position = scales_[axis].position_of(caught.count);
    latch.armed = caught.armed;
    latch.caught = caught.caught;
  }
}

void Cpu5Driver::read_probe_latch() {
  const firmware::ProbeLatch& board = board_.probe_latch;
  ProbeLatch& latch = status_.probe_latch;
  if (board.caught && !latch.caught) latch.position = position_of(board.counts);
  latch.armed = board.armed;
  latch.caught = board.caught;
  latch.active_at_arming = board.active_at_arming;
}

Position Cpu5Driver::position_of(const firmware::PerAxis<std::int64_t>& counts) const {
  Position position;
  for (const Axis axis : kAllAxes) {
    position[axis] = scales_[axis].position_of(counts[index_of(axis)]);
  }
  return position;
}

}  // namespace cnc::hal::cpu5
