#include "hal/cpu5/wire/messages.h"

#include <limits>

namespace cnc::hal::cpu5::wire {

using firmware::Edge;
using firmware::HomeLatch;
using firmware::HostFrame;
using firmware::Inputs;
using firmware::kAxisCount;
using firmware::LatchRequest;
using firmware::OutputChange;
using firmware::Outputs;
using firmware::PathStop;
using firmware::ProbeLatch;
using firmware::ProbeRequest;
using firmware::Segment;
using firmware::Setup;
using firmware::Status;

namespace {

[[nodiscard]] bool complete(const ByteReader& body) { return !body.bad() && body.at_end(); }

/// A number that stands for one of `count` things.
template <typename Enum>
[[nodiscard]] Enum get_one_of(ByteReader& body, std::uint8_t count) {
  const auto value = body.get<std::uint8_t>();
  if (value >= count) body.refuse();
  return static_cast<Enum>(value);
}

/// Truths in the bits of one byte, the first one lowest.
template <typename... Bools>
void put_bits(ByteWriter& body, Bools... values) {
  std::uint8_t bits = 0;
  std::uint8_t bit = 1;
  ((bits = static_cast<std::uint8_t>(bits | (values ? bit : 0)),
    bit = static_cast<std::uint8_t>(bit << 1)),
   ...);
  body.put(bits);
}

template <typename... Bools>
void get_bits(ByteReader& body, Bools&... values) {
  auto bits = body.get<std::uint8_t>();
  ((values = (bits & 1U) != 0, bits = static_cast<std::uint8_t>(bits >> 1)), ...);
  if (bits != 0) body.refuse();
}

template <typename T, std::size_t kSize>
void put_all(ByteWriter& body, const std::array<T, kSize>& values) {
  for (const T value : values) body.put(value);
}

template <typename T, std::size_t kSize>
void get_all(ByteReader& body, std::array<T, kSize>& values) {
  for (T& value : values) value = body.get<T>();
}

// Counts stay within kMaxPosition.
static_assert(firmware::nearest_step(firmware::kMaxPosition) <
              std::numeric_limits<std::int32_t>::max());

using Counts = firmware::PerAxis<std::int64_t>;

void put_count(ByteWriter& body, std::int64_t count) { body.put(static_cast<std::int32_t>(count)); }
[[nodiscard]] std::int64_t get_count(ByteReader& body) { return body.get<std::int32_t>(); }

void put_counts(ByteWriter& body, const Counts& counts) {
  for (const std::int64_t count : counts) put_count(body, count);
}
void get_counts(ByteReader& body, Counts& counts) {
  for (std::int64_t& count : counts) count = get_count(body);
}

/// A moment, as the time from there to the status. Whoever sends absurd ones gets absurd ones.
void put_moment(ByteWriter& body, firmware::Ticks moment, firmware::Ticks now) {
  const auto ago = static_cast<firmware::Ticks>(static_cast<std::uint64_t>(now) -
                                                static_cast<std::uint64_t>(moment));
  body.put(static_cast<std::uint32_t>(ago < 0 ? 0 : ago < kLongestAgo ? ago : kLongestAgo));
}
[[nodiscard]] firmware::Ticks get_moment(ByteReader& body, firmware::Ticks now) {
  const auto ago = body.get<std::uint32_t>();
  return static_cast<firmware::Ticks>(static_cast<std::uint64_t>(now) - ago);
}

// --- outputs and inputs --------------------------------------------------------------------------

void put_outputs(ByteWriter& body, const Outputs& outputs) {
  put_bits(body, outputs.drives_enabled, outputs.spindle_on, outputs.tool_direction, outputs.mist,
           outputs.flood);
  body.put(outputs.spindle_pwm);
  body.put(outputs.ports);
  put_all(body, outputs.pwm);
}

void get_outputs(ByteReader& body, Outputs& outputs) {
  get_bits(body, outputs.drives_enabled, outputs.spindle_on, outputs.tool_direction, outputs.mist,
           outputs.flood);
  outputs.spindle_pwm = body.get<std::uint32_t>();
  outputs.ports = body.get<firmware::PortBits>();
  get_all(body, outputs.pwm);
  bool in_range =
      outputs.spindle_pwm <= Outputs::kFullPwm && (outputs.ports >> firmware::kPortCount) == 0;
  for (const std::uint32_t pwm : outputs.pwm) in_range = in_range && pwm <= Outputs::kFullPwm;
  if (!in_range) body.refuse();
}

// Of a change: what follows the bits of OutputChange::changed.
constexpr std::uint8_t kChangeBits = (OutputChange::kSpindlePwm << 1) - 1;
constexpr std::uint8_t kRelayBits = OutputChange::kSpindlePwm - 1;
constexpr std::uint8_t kHasPort = 1U << 5;
constexpr std::uint8_t kHasPwm = 1U << 6;
constexpr std::uint8_t kPortOn = 1U << 7;

void put_change(ByteWriter& body, const OutputChange& change) {
  const std::uint8_t port = change.port != 0 ? kHasPort : std::uint8_t{0};
  const std::uint8_t pwm = change.pwm != 0 ? kHasPwm : std::uint8_t{0};
  body.put(static_cast<std::uint8_t>(change.changed | port | pwm));
  body.put(change.on);
  if ((change.changed & OutputChange::kSpindlePwm) != 0) body.put(change.spindle_pwm);
  if (change.port != 0) {
    body.put(static_cast<std::uint8_t>(change.port | (change.port_on ? kPortOn : 0)));
  }
  if (change.pwm == 0) return;
  body.put(change.pwm);
  body.put(change.pwm_value);
}

void get_change(ByteReader& body, OutputChange& change) {
  change = {};
  const auto bits = body.get<std::uint8_t>();
  change.changed = bits & kChangeBits;
  change.on = body.get<std::uint8_t>();
  const std::uint8_t relays = bits & kRelayBits;
  bool good = (bits >> 7) == 0 && (change.on | relays) == relays;
  if ((bits & OutputChange::kSpindlePwm) != 0) change.spindle_pwm = body.get<std::uint32_t>();
  if ((bits & kHasPort) != 0) {
    const auto port = body.get<std::uint8_t>();
    change.port = static_cast<std::uint8_t>(port & ~kPortOn);
    change.port_on = (port & kPortOn) != 0;
    good = good && change.port != 0 && change.port <= firmware::kPortCount;
  }
  if ((bits & kHasPwm) != 0) {
    change.pwm = body.get<std::uint8_t>();
    change.pwm_value = body.get<std::uint32_t>();
    good = good && change.pwm != 0 && change.pwm <= firmware::kPwmCount;
  }
  good = good && change.spindle_pwm <= Outputs::kFullPwm && change.pwm_value <= Outputs::kFullPwm;
  if (!good || change.empty()) body.refuse();
}

void put_inputs(ByteWriter& body, const Inputs& inputs) {
  body.put(inputs.home);
  put_bits(body, inputs.estop1, inputs.estop2, inputs.external_error, inputs.probe, inputs.sync,
           inputs.hand_wheel_a, inputs.hand_wheel_b);
  body.put(inputs.ports);
  put_all(body, inputs.analog);
  body.put(inputs.hand_wheel_count);
  body.put(inputs.alarm);
}

void get_inputs(ByteReader& body, Inputs& inputs) {
  inputs.home = body.get<std::uint8_t>();
  get_bits(body, inputs.estop1, inputs.estop2, inputs.external_error, inputs.probe, inputs.sync,
           inputs.hand_wheel_a, inputs.hand_wheel_b);
  inputs.ports = body.get<firmware::PortBits>();
  get_all(body, inputs.analog);
  inputs.hand_wheel_count = body.get<std::int32_t>();
  inputs.alarm = body.get<std::uint8_t>();
}

}  // namespace

// --- greeting ------------------------------------------------------------------------------------

void put_identity(ByteWriter& body, const Identity& identity) {
  body.put(identity.serial);
  body.put(identity.boot);
  body.put(identity.in_session);
  for (const char letter : identity.name) body.put(static_cast<std::uint8_t>(letter));
  body.put(identity.max_step_frequency);
  body.put(identity.fifo_capacity);
  body.put(identity.axes);
  body.put(identity.window);
  body.put(identity.features);
}

bool get_identity(ByteReader& body, Identity& identity) {
  identity.serial = body.get<std::uint64_t>();
  identity.boot = body.get<std::uint32_t>();
  identity.in_session = body.get_bool();
  for (char& letter : identity.name) letter = static_cast<char>(body.get<std::uint8_t>());
  identity.max_step_frequency = body.get<std::uint32_t>();
  identity.fifo_capacity = body.get<std::uint16_t>();
  identity.axes = body.get<std::uint8_t>();
  identity.window = body.get<std::uint8_t>();
  identity.features = body.get<std::uint32_t>();
  return complete(body);
}

void put_refusal(ByteWriter& body, const Refusal& refusal) {
  body.put(static_cast<std::uint8_t>(refusal.reason));
  body.put(refusal.lowest_version);
  body.put(refusal.highest_version);
  body.put(refusal.boot);
}

bool get_refusal(ByteReader& body, Refusal& refusal) {
  refusal.reason = static_cast<RefusalReason>(body.get<std::uint8_t>());
  refusal.lowest_version = body.get<std::uint8_t>();
  refusal.highest_version = body.get<std::uint8_t>();
  refusal.boot = body.get<std::uint32_t>();
  return complete(body);
}

void put_setup(ByteWriter& body, const Setup& setup) {
  body.put(setup.max_velocity);
  body.put(setup.host_timeout);
  body.put(setup.index_timeout);
  body.put(setup.drives_off_on_fault);
  put_all(body, setup.max_acceleration);
  body.put(setup.pulse_width);
  body.put(setup.direction_setup);
  body.put(setup.direction_hold);
  body.put(setup.step_inverted);
  body.put(setup.direction_inverted);
  for (const firmware::GuardRule& rule : setup.guards) {
    body.put(rule.participants);
    body.put(rule.compare);
    body.put(static_cast<std::uint8_t>(rule.action));
  }
}

bool get_setup(ByteReader& body, Setup& setup) {
  setup.max_velocity = body.get<firmware::StepVelocity>();
  setup.host_timeout = body.get<firmware::Ticks>();
  setup.index_timeout = body.get<firmware::Ticks>();
  setup.drives_off_on_fault = body.get_bool();
  get_all(body, setup.max_acceleration);
  setup.pulse_width = body.get<std::uint16_t>();
  setup.direction_setup = body.get<std::uint16_t>();
  setup.direction_hold = body.get<std::uint16_t>();
  setup.step_inverted = body.get<std::uint8_t>();
  setup.direction_inverted = body.get<std::uint8_t>();
  for (firmware::GuardRule& rule : setup.guards) {
    rule.participants = body.get<std::uint8_t>();
    rule.compare = body.get<std::uint8_t>();
    rule.action = get_one_of<firmware::GuardAction>(body, 4);
  }
  return complete(body);
}

// --- frames --------------------------------------------------------------------------------------

void put_numbers(ByteWriter& body, const FrameNumbers& numbers) {
  body.put(numbers.sequence);
  body.put(numbers.stops);
  body.put(numbers.stamp);
}

FrameNumbers get_frame_numbers(ByteReader& body) {
  FrameNumbers numbers;
  numbers.sequence = body.get<std::uint32_t>();
  numbers.stops = body.get<std::uint32_t>();
  numbers.stamp = body.get<std::uint32_t>();
  return numbers;
}

namespace {

// A segment's first word: duration in the lower bits, these above.
constexpr std::uint32_t kWaitForIndex = 1U << 31;
constexpr std::uint32_t kHasSpindlePeriod = 1U << 30;
constexpr std::uint32_t kHasChange = 1U << 29;
constexpr std::uint32_t kDurationMask = kHasChange - 1;

/// What does not fit becomes a velocity that the board refuses.
[[nodiscard]] std::int32_t narrowed(firmware::StepVelocity velocity) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  static_assert(firmware::kTopVelocity < kMost);
  return velocity > kMost || velocity < -kMost ? kMost : static_cast<std::int32_t>(velocity);
}

/// `before`: the segment before it in the same frame; null: every axis is written.
void put_segment(ByteWriter& body, const Segment& segment, const Segment* before) {
  body.put(segment.id);
  body.put((segment.duration & kDurationMask) | (segment.wait_for_index ? kWaitForIndex : 0) |
           (segment.spindle_period != 0 ? kHasSpindlePeriod : 0) |
           (segment.change.empty() ? 0 : kHasChange));
  if (segment.spindle_period != 0) body.put(segment.spindle_period);
  if (!segment.change.empty()) put_change(body, segment.change);
  std::uint8_t written = 0;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    const bool stands = before != nullptr && segment.velocity[axis] == 0 &&
                        segment.position[axis] == before->position[axis];
    if (!stands) written = static_cast<std::uint8_t>(written | firmware::axis_bit(axis));
  }
  body.put(written);
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((written & firmware::axis_bit(axis)) == 0) continue;
    body.put(segment.position[axis]);
    body.put(narrowed(segment.velocity[axis]));
  }
}

void get_segment(ByteReader& body, Segment& segment, const Segment* before) {
  segment.id = body.get<std::uint32_t>();
  const auto word = body.get<std::uint32_t>();
  segment.duration = word & kDurationMask;
  segment.wait_for_index = (word & kWaitForIndex) != 0;
  segment.spindle_period =
      (word & kHasSpindlePeriod) != 0 ? body.get<std::uint32_t>() : std::uint32_t{0};
  segment.change = {};
  if ((word & kHasChange) != 0) get_change(body, segment.change);
  const auto written = body.get<std::uint8_t>();
  if ((written >> kAxisCount) != 0 || (before == nullptr && written != (1U << kAxisCount) - 1)) {
    body.refuse();
    return;
  }
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((written & firmware::axis_bit(axis)) != 0) {
      segment.position[axis] = body.get<firmware::StepPosition>();
      segment.velocity[axis] = body.get<std::int32_t>();
    } else {
      segment.position[axis] = before->position[axis];
      segment.velocity[axis] = 0;
    }
  }
}

[[nodiscard]] const Segment* segment_before(const HostFrame& frame, std::uint32_t index) {
  const bool first_of_path = index == 0 || (frame.has_cut && index == frame.segments_before_cut);
  return first_of_path ? nullptr : &frame.segments[index - 1];
}

}  // namespace

void put_frame(ByteWriter& body, const HostFrame& frame) {
  put_bits(body, frame.quick_stop, frame.clear_faults, frame.release_stop, frame.stop_along_path,
           frame.has_outputs, frame.has_cut, !frame.change.empty(), frame.with_next);
  for (const LatchRequest request : frame.latch) body.put(static_cast<std::uint8_t>(request));
  body.put(static_cast<std::uint8_t>(frame.probe));
  if (frame.has_outputs) put_outputs(body, frame.outputs);
  if (!frame.change.empty()) put_change(body, frame.change);
  if (frame.has_cut) {
    body.put(frame.cut_behind);
    body.put(static_cast<std::uint8_t>(frame.segments_before_cut));
  }
  body.put(static_cast<std::uint8_t>(frame.segment_count));
  for (std::uint32_t i = 0; i < frame.segment_count; ++i) {
    put_segment(body, frame.segments[i], segment_before(frame, i));
  }
}

bool get_frame(ByteReader& body, HostFrame& frame) {
  bool has_change = false;
  get_bits(body, frame.quick_stop, frame.clear_faults, frame.release_stop, frame.stop_along_path,
           frame.has_outputs, frame.has_cut, has_change, frame.with_next);
  for (LatchRequest& request : frame.latch) request = get_one_of<LatchRequest>(body, 4);
  frame.probe = get_one_of<ProbeRequest>(body, 3);
  if (frame.has_outputs) get_outputs(body, frame.outputs);
  frame.change = {};
  if (has_change) get_change(body, frame.change);
  frame.segments_before_cut = 0;
  if (frame.has_cut) {
    frame.cut_behind = body.get<std::uint32_t>();
    frame.segments_before_cut = body.get<std::uint8_t>();
  }
  frame.segment_count = body.get<std::uint8_t>();
  if (frame.segment_count > firmware::kSegmentsPerFrame ||
      frame.segments_before_cut > frame.segment_count) {
    return false;
  }
  for (std::uint32_t i = 0; i < frame.segment_count && !body.bad(); ++i) {
    get_segment(body, frame.segments[i], segment_before(frame, i));
  }
  return complete(body);
}

// --- status --------------------------------------------------------------------------------------

namespace {

// Of what may be there or not.
constexpr std::uint8_t kProbeLatch = 1U << kAxisCount;
constexpr std::uint8_t kEstopLatch = kProbeLatch << 1;
static_assert(kEstopLatch == 1U << 7);

[[nodiscard]] bool tells_something(const HomeLatch& latch) { return latch.armed || latch.caught; }
[[nodiscard]] bool tells_something(const ProbeLatch& latch) {
  return latch.armed || latch.caught || latch.active_at_arming;
}

void put_latches(ByteWriter& body, const Status& status) {
  std::uint8_t present = 0;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if (tells_something(status.home_latch[axis])) {
      present = static_cast<std::uint8_t>(present | firmware::axis_bit(axis));
    }
  }
  if (tells_something(status.probe_latch)) present |= kProbeLatch;
  if (status.estop_latch.count != 0) present |= kEstopLatch;
  body.put(present);
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if ((present & firmware::axis_bit(axis)) == 0) continue;
    const HomeLatch& latch = status.home_latch[axis];
    put_bits(body, latch.armed, latch.caught, latch.edge == Edge::release);
    put_count(body, latch.count);
    put_moment(body, latch.time, status.time);
  }
  if ((present & kProbeLatch) != 0) {
    const ProbeLatch& latch = status.probe_latch;
    put_bits(body, latch.armed, latch.caught, latch.active_at_arming);
    put_counts(body, latch.counts);
    put_moment(body, latch.time, status.time);
  }
  if ((present & kEstopLatch) != 0) {
    body.put(status.estop_latch.count);
    put_counts(body, status.estop_latch.counts);
    put_moment(body, status.estop_latch.time, status.time);
  }
}

void get_latches(ByteReader& body, Status& status) {
  const auto present = body.get<std::uint8_t>();
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    HomeLatch& latch = status.home_latch[axis];
    latch = {};
    if ((present & firmware::axis_bit(axis)) == 0) continue;
    bool release = false;
    get_bits(body, latch.armed, latch.caught, release);
    latch.edge = release ? Edge::release : Edge::activate;
    latch.count = get_count(body);
    latch.time = get_moment(body, status.time);
  }
  status.probe_latch = {};
  if ((present & kProbeLatch) != 0) {
    ProbeLatch& latch = status.probe_latch;
    get_bits(body, latch.armed, latch.caught, latch.active_at_arming);
    get_counts(body, latch.counts);
    latch.time = get_moment(body, status.time);
  }
  status.estop_latch = {};
  if ((present & kEstopLatch) != 0) {
    status.estop_latch.count = body.get<std::uint32_t>();
    get_counts(body, status.estop_latch.counts);
    status.estop_latch.time = get_moment(body, status.time);
  }
}

void put_index(ByteWriter& body, const Status& status) {
  body.put(status.inputs.index_count);
  put_counts(body, status.index_counts);
  put_moment(body, status.inputs.index_time, status.time);
}

void get_index(ByteReader& body, Status& status) {
  status.inputs.index_count = body.get<std::uint32_t>();
  get_counts(body, status.index_counts);
  status.inputs.index_time = get_moment(body, status.time);
}

using GuardCounts = firmware::PerGuardRule<std::uint8_t>;

/// Those that are not 0.
void put_guard_counts(ByteWriter& body, const GuardCounts& counts) {
  std::uint32_t present = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] != 0) present |= std::uint32_t{1} << i;
  }
  body.put(present);
  for (const std::uint8_t count : counts) {
    if (count != 0) body.put(count);
  }
}

void get_guard_counts(ByteReader& body, GuardCounts& counts) {
  const auto present = body.get<std::uint32_t>();
  if ((present >> counts.size()) != 0) body.refuse();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = (present >> i & 1U) != 0 ? body.get<std::uint8_t>() : std::uint8_t{0};
  }
}

}  // namespace

void put_status(ByteWriter& body, const StatusNumbers& numbers, const Status& status) {
  body.put(numbers.answer);
  body.put(numbers.executed);
  body.put(numbers.waiting);
  body.put(numbers.stamp);
  body.put(status.time);
  body.put(status.faults);
  body.put(status.executing_id);
  body.put(static_cast<std::uint32_t>(status.executing_elapsed));
  body.put(static_cast<std::uint32_t>(status.executing_duration));
  body.put(static_cast<std::uint16_t>(status.fifo_count));
  body.put(static_cast<std::uint16_t>(status.fifo_free));
  body.put(status.queued_time);
  put_bits(body, status.moving, status.cut_late);
  body.put(static_cast<std::uint8_t>(status.path_stop));
  put_counts(body, status.counts);
  put_inputs(body, status.inputs);
  put_index(body, status);
  body.put(status.spindle_period);
  body.put(static_cast<std::uint32_t>(status.time_scale));
  put_outputs(body, status.outputs);
  put_latches(body, status);
  put_guard_counts(body, status.guard_counts);
}

bool get_status(ByteReader& body, StatusNumbers& numbers, Status& status) {
  numbers.answer = body.get<std::uint32_t>();
  numbers.executed = body.get<std::uint32_t>();
  numbers.waiting = body.get<std::uint32_t>();
  numbers.stamp = body.get<std::uint32_t>();
  status.time = body.get<firmware::Ticks>();
  status.faults = body.get<firmware::FaultBits>();
  status.executing_id = body.get<std::uint32_t>();
  status.executing_elapsed = body.get<std::uint32_t>();
  status.executing_duration = body.get<std::uint32_t>();
  status.fifo_count = body.get<std::uint16_t>();
  status.fifo_free = body.get<std::uint16_t>();
  status.queued_time = body.get<firmware::Ticks>();
  get_bits(body, status.moving, status.cut_late);
  status.path_stop = get_one_of<PathStop>(body, 3);
  get_counts(body, status.counts);
  get_inputs(body, status.inputs);
  get_index(body, status);
  status.spindle_period = body.get<firmware::Ticks>();
  status.time_scale = body.get<std::uint32_t>();
  get_outputs(body, status.outputs);
  get_latches(body, status);
  get_guard_counts(body, status.guard_counts);
  return complete(body);
}

}  // namespace cnc::hal::cpu5::wire
