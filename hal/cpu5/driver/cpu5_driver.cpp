#include "hal/cpu5/driver/cpu5_driver.h"

#include <algorithm>
#include <fmt/format.h>

#include "hal/cpu5/driver/board_values.h"

namespace cnc::hal::cpu5 {

using Kind = LinkObstacle::Kind;

namespace {

static_assert(firmware::kAxisCount == cnc::kAxisCount);
static_assert(firmware::kFifoUnderrun == static_cast<Faults>(Fault::fifo_underrun));
static_assert(firmware::kEstop == static_cast<Faults>(Fault::estop));
static_assert(firmware::kBadSegment == static_cast<Faults>(Fault::bad_segment));
static_assert(firmware::kLinkLost == static_cast<Faults>(Fault::link_lost));
static_assert(firmware::kStepLoss == static_cast<Faults>(Fault::step_loss));
static_assert(firmware::kGuardStop == static_cast<Faults>(Fault::guard_stop));
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

std::uint16_t ticks_of_pulse(double microseconds) {
  constexpr double kTicksPerMicrosecond = double{firmware::kTicksPerSecond} / 1e6;
  return static_cast<std::uint16_t>(std::lround(microseconds * kTicksPerMicrosecond));
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
  // Of a board that makes sense it is never more.
  return std::min(1.0, static_cast<double>(board.executing_elapsed) /
                           static_cast<double>(board.executing_duration));
}

}  // namespace

DriverSettings driver_settings(const config::MachineConfig& config) {
  return {.max_step_frequency = static_cast<double>(config.connection.max_step_frequency),
          .host_timeout = config.connection.host_timeout};
}

Cpu5Driver::Cpu5Driver(const config::MachineConfig& config, const DriverSettings& settings,
                       std::unique_ptr<BoardPort> port)
    : axes_(config.axes),
      connection_(config.connection),
      guards_(cpu5::to_board(config.guards)),
      settings_(settings),
      port_(std::move(port)) {
  for (const Axis axis : kAllAxes) scales_[axis] = MotorScale(axes_[axis].steps_per_unit);
}

// --- connection ----------------------------------------------------------------------------------

Result<Capabilities> Cpu5Driver::connect() {
  if (auto checked = check_axes(); !checked) return std::unexpected(checked.error());
  const auto board = port_->open(setup());
  if (!board) return std::unexpected(board.error());
  take(port_->exchange());
  if (const LinkObstacle unsuitable = obstacle_in(*board); unsuitable.kind != Kind::none)
    return std::unexpected(error_of(unsuitable));
  return Capabilities{.fifo_capacity = fifo_capacity_,
                      .max_step_frequency = settings_.max_step_frequency,
                      .min_segment_duration = seconds(firmware::kMinSegmentTicks)};
}

// An axis without a motor loses nothing however hard it stops, so it sets no limit.
firmware::Setup Cpu5Driver::setup() const {
  firmware::Setup result{
      .max_velocity = max_velocity_for(settings_),
      .host_timeout = std::llround(settings_.host_timeout * double{firmware::kTicksPerSecond}),
      .index_timeout = std::llround(settings_.index_timeout * double{firmware::kTicksPerSecond}),
      .drives_off_on_fault = settings_.drives_off_on_fault,
      .pulse_width = ticks_of_pulse(connection_.pulse_width),
      .direction_setup = ticks_of_pulse(connection_.direction_setup),
      .direction_hold = ticks_of_pulse(connection_.direction_hold),
      .guards = guards_};
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& motor = axes_[axis];
    const std::size_t i = index_of(axis);
    if (motor.step_active_low) result.step_inverted |= firmware::axis_bit(i);
    if (motor.direction_active_low) result.direction_inverted |= firmware::axis_bit(i);
    if (motor.connected())
      result.max_acceleration[i] = scales_[axis].to_step_acceleration(motor.acceleration);
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

/// Whatever the board itself thinks of it: another one may have taken its place.
LinkObstacle Cpu5Driver::obstacle_in(const wire::Identity& board) const {
  if (board.max_step_frequency >= settings_.max_step_frequency) return {};
  const double wanted = std::fmin(std::fmax(settings_.max_step_frequency, 0.0), 1e9);
  return {Kind::too_slow, 0, board.max_step_frequency,
          static_cast<std::uint32_t>(std::lround(wanted))};
}

void Cpu5Driver::disconnect() {
  port_->close();
  status_.connected = false;
}

const ControllerStatus& Cpu5Driver::exchange(double now) {
  port_->receive(now);
  if (has_requests_ && status_.connected) send_frames();
  take(port_->exchange());
  return status_;
}

/// As many as the line takes; the others move up. Where a path begins that is short in the first of
/// them, the board must not begin with it and then wait for the next, which may be lost and sent
/// again.
void Cpu5Driver::send_frames() {
  std::size_t sent = 0;
  while (sent < outbox_count_ && port_->room() > 0) {
    firmware::HostFrame& frame = outbox_[sent++];
    const bool next_goes_too = sent < outbox_count_ && port_->room() > 1;
    frame.with_next = start_is_short_behind(frame) && next_goes_too;
    on_their_way_[(port_->frames_sent() + 1) % kMostOnTheirWay] = summary_of(frame);
    port_->send(frame);
  }
  if (sent == outbox_count_) return empty_outbox();
  if (sent == 0) return;
  std::copy(outbox_.begin() + static_cast<std::ptrdiff_t>(sent),
            outbox_.begin() + static_cast<std::ptrdiff_t>(outbox_count_), outbox_.begin());
  outbox_count_ -= sent;
}

/// Whether the path that has begun with a standstill or a cut lasts less than a round trip or two
/// at the end of `frame`, and goes on.
bool Cpu5Driver::start_is_short_behind(const firmware::HostFrame& frame) {
  constexpr firmware::Ticks kLongEnough = firmware::kTicksPerSecond / 20;
  for (std::uint32_t i = 0; i < frame.segment_count; ++i) {
    const firmware::Segment& segment = frame.segments[i];
    const bool behind_cut = frame.has_cut && i == frame.segments_before_cut;
    if (path_ends_at_rest_ || behind_cut) begun_path_ = 0;
    begun_path_ += segment.duration;
    path_ends_at_rest_ = segment.velocity == firmware::PerAxis<firmware::StepVelocity>{};
  }
  return !path_ends_at_rest_ && begun_path_ < kLongEnough;
}

void Cpu5Driver::empty_outbox() {
  outbox_count_ = 1;
  asked().reset();
  has_requests_ = false;
}

bool Cpu5Driver::begin_frame() {
  if (outbox_count_ == kOutbox) return false;
  outbox_[outbox_count_++].reset();
  return true;
}

void Cpu5Driver::take(const BoardAnswer& answer) {
  status_.obstacle = answer.connected ? obstacle_in(answer.identity) : answer.obstacle;
  status_.connected = answer.connected && status_.obstacle.kind == Kind::none;
  status_.frames_done = answer.frames_done;
  status_.packets = answer.packets;
  if (!status_.connected) return;
  if (answer.greetings != greetings_) begin_session(answer);
  board_ = answer.status;
  status_.round_trip = answer.round_trip;
  read_status();
}

/// What was asked for while nobody listened is void. A board that was reset counts from 0 again:
/// the axes are shown where they were last seen, and whoever reads counts_lost knows what that is
/// worth.
void Cpu5Driver::begin_session(const BoardAnswer& answer) {
  greetings_ = answer.greetings;
  fifo_capacity_ = answer.identity.fifo_capacity;
  empty_outbox();
  clock_.reset();
  path_ends_at_rest_ = true;
  latch_frame_ = {};
  probe_frame_ = clear_frame_ = 0;
  status_.sessions = greetings_;
  status_.board = {.name = answer.identity.name, .serial = answer.identity.serial};
  status_.counts_lost = answer.counts_lost;
  if (!answer.counts_lost) return;
  status_.index_latch = status_.estop_latch = {};
  for (const Axis axis : kAllAxes) {
    scales_[axis].set_position(status_.position[axis], answer.status.counts[index_of(axis)]);
  }
}

// --- requests ------------------------------------------------------------------------------------

Cpu5Driver::OnItsWay Cpu5Driver::summary_of(const firmware::HostFrame& frame) {
  return {.empties_fifo = frame.empties_fifo(),
          .has_cut = frame.has_cut,
          .cut_behind = frame.cut_behind,
          .segments_before_cut = frame.has_cut ? frame.segments_before_cut : frame.segment_count,
          .segments = frame.segment_count};
}

/// In their order, those that are still here last.
template <typename Visit>
void Cpu5Driver::for_each_on_its_way(Visit visit) const {
  for (std::uint64_t number = status_.frames_done + 1; number <= port_->frames_sent(); ++number) {
    visit(on_their_way_[number % kMostOnTheirWay]);
  }
  for (std::size_t i = 0; i < outbox_count_; ++i) visit(summary_of(outbox_[i]));
}

bool Cpu5Driver::path_is_on_its_way() const {
  bool any = false;
  for_each_on_its_way([&](const OnItsWay& frame) { any = any || frame.segments > 0; });
  return any;
}

// As full as the FIFO can be when everything has arrived. A cut leaves no more segments than there
// are numbers between the one in execution and the one that it cuts behind.
std::size_t Cpu5Driver::free_segments() const {
  std::uint32_t waiting = fifo_capacity_ - std::min(board_.fifo_free, fifo_capacity_);
  bool emptied = false;
  for_each_on_its_way([&](const OnItsWay& frame) {
    if (frame.empties_fifo) waiting = 0;
    emptied = emptied || frame.empties_fifo;
    waiting += frame.segments_before_cut;
    if (!frame.has_cut) return;
    waiting = std::min(waiting, frame.cut_behind - board_.executing_id);
    waiting += frame.segments - frame.segments_before_cut;
  });
  const bool in_fault = status_.faults != 0 && status_.frames_done >= clear_frame_;
  const bool held = status_.path_stop == PathStop::stopped && !emptied;
  if (!status_.connected || in_fault || held || waiting >= fifo_capacity_) return 0;
  return fifo_capacity_ - waiting;
}

std::size_t Cpu5Driver::push(std::span<const Segment> segments) {
  const auto taken = segments.first(std::min(segments.size(), free_segments()));
  std::size_t count = 0;
  for (const Segment& segment : taken) {
    if (last_frame().segment_count == firmware::kSegmentsPerFrame && !begin_frame()) break;
    firmware::HostFrame& frame = last_frame();
    frame.segments[frame.segment_count++] = to_board(segment);
    has_requests_ = true;
    ++count;
  }
  return count;
}

firmware::Segment Cpu5Driver::to_board(const Segment& segment) {
  firmware::Segment result{.id = segment.id,
                           .duration = clock_.ticks_for(segment.duration),
                           .wait_for_index = segment.wait_for_index,
                           .spindle_period = period_of(segment.spindle_speed),
                           .change = cpu5::to_board(segment.change)};
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
  asked().has_outputs = true;
  asked().outputs = cpu5::to_board(outputs);
  asked().change = {};
  has_requests_ = true;
}

bool Cpu5Driver::change_outputs(const OutputChange& change) {
  if (asked().has_outputs) {
    firmware::apply(cpu5::to_board(change), asked().outputs);
  } else {
    if (asked().change.empty()) change_ = {};
    if (!change_.can_add(change)) return false;
    change_.add(change);
    asked().change = cpu5::to_board(change_);
  }
  has_requests_ = true;
  return true;
}

void Cpu5Driver::cut_behind(std::uint32_t id) {
  if (last_frame().has_cut) static_cast<void>(begin_frame());
  firmware::HostFrame& frame = last_frame();
  frame.has_cut = true;
  frame.cut_behind = id;
  frame.segments_before_cut = frame.segment_count;
  has_requests_ = true;
  clock_.reset();
}

void Cpu5Driver::quick_stop() {
  drop_segments();
  asked().quick_stop = true;
  has_requests_ = true;
  port_->quick_stop();
}

void Cpu5Driver::stop_along_path() {
  asked().stop_along_path = true;
  has_requests_ = true;
}

void Cpu5Driver::release_stop() {
  if (status_.path_stop != PathStop::stopped) return;
  drop_segments();
  asked().release_stop = true;
  has_requests_ = true;
}

// Outputs asked for before the reset do not survive it: a spindle must not start because a fault
// was cleared.
void Cpu5Driver::clear_faults() {
  drop_segments();
  asked().has_outputs = false;
  asked().change = {};
  asked().clear_faults = true;
  has_requests_ = true;
  clear_frame_ = port_->frames_sent() + 1;
}

void Cpu5Driver::drop_segments() {
  outbox_count_ = 1;
  asked().segment_count = 0;
  asked().has_cut = false;
  clock_.reset();
  path_ends_at_rest_ = true;
}

bool Cpu5Driver::set_position(Axis axis, double position) {
  if (status_.moving || path_is_on_its_way()) return false;
  scales_[axis].set_position(position, board_.counts[index_of(axis)]);
  status_.position[axis] = position;
  has_requests_ = true;  // an empty frame: what was asked for is done when it is answered
  return true;
}

void Cpu5Driver::arm_home_latch(Axis axis, LatchEdge edge) {
  asked().latch[index_of(axis)] = edge == LatchEdge::activate ? firmware::LatchRequest::arm_activate
                                                              : firmware::LatchRequest::arm_release;
  status_.home_latch[axis] = {.armed = true};
  latch_frame_[axis] = port_->frames_sent() + 1;
  has_requests_ = true;
}

void Cpu5Driver::disarm_home_latch(Axis axis) {
  asked().latch[index_of(axis)] = firmware::LatchRequest::disarm;
  status_.home_latch[axis].armed = false;
  latch_frame_[axis] = port_->frames_sent() + 1;
  has_requests_ = true;
}

void Cpu5Driver::arm_probe_latch() {
  asked().probe = firmware::ProbeRequest::arm;
  status_.probe_latch = {.armed = true};
  probe_frame_ = port_->frames_sent() + 1;
  has_requests_ = true;
}

void Cpu5Driver::disarm_probe_latch() {
  asked().probe = firmware::ProbeRequest::disarm;
  status_.probe_latch.armed = false;
  probe_frame_ = port_->frames_sent() + 1;
  has_requests_ = true;
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
  status_.outputs = from_board(board_.outputs);
  status_.position = position_of(board_.counts);
  status_.guard_counts = board_.guard_counts;
  read_latches();
  read_probe_latch();
  read_event(status_.index_latch, board_.inputs.index_count, board_.index_counts,
             board_.inputs.index_time);
  const firmware::EstopLatch& estop = board_.estop_latch;
  read_event(status_.estop_latch, estop.count, estop.counts, estop.time);
}

// A caught count is converted once, when it is first seen: a later set_position() must not move it.
// What the board says from before the last arming is about an earlier one.
void Cpu5Driver::read_latches() {
  for (const Axis axis : kAllAxes) {
    if (status_.frames_done < latch_frame_[axis]) continue;
    const firmware::HomeLatch& caught = board_.home_latch[index_of(axis)];
    Latch& latch = status_.home_latch[axis];
    if (caught.caught && !latch.caught) {
      latch.position = scales_[axis].position_of(caught.count);
      latch.time = seconds(caught.time);
    }
    latch.armed = caught.armed;
    latch.caught = caught.caught;
  }
}

void Cpu5Driver::read_probe_latch() {
  if (status_.frames_done < probe_frame_) return;
  const firmware::ProbeLatch& board = board_.probe_latch;
  ProbeLatch& latch = status_.probe_latch;
  if (board.caught && !latch.caught) {
    latch.position = position_of(board.counts);
    latch.time = seconds(board.time);
  }
  latch.armed = board.armed;
  latch.caught = board.caught;
  latch.active_at_arming = board.active_at_arming;
}

/// Once, too, and its time as long as the wire can tell it.
void Cpu5Driver::read_event(EventLatch& latch, std::uint32_t count,
                            const firmware::PerAxis<std::int64_t>& counts,
                            firmware::Ticks time) const {
  if (count == latch.count) return;
  latch = {.count = count, .position = position_of(counts), .time = seconds(time)};
}

Position Cpu5Driver::position_of(const firmware::PerAxis<std::int64_t>& counts) const {
  Position position;
  for (const Axis axis : kAllAxes) {
    position[axis] = scales_[axis].position_of(counts[index_of(axis)]);
  }
  return position;
}

}  // namespace cnc::hal::cpu5
