// Everything that host and board can tell each other, from the bytes of a fuzzer. A struct is
// varied in one place at a time, so that few bytes make a believable neighbour and a few more a mad
// one.
#pragma once

#include <algorithm>

#include "hal/cpu5/firmware/host_frame.h"
#include "tests/fuzz/fuzz_bytes.h"

namespace cnc::hal::cpu5::firmware {

using cnc::fuzz::Bytes;

inline constexpr StepVelocity kUsualLimit = velocity_of_frequency(400'000);

template <typename T, std::size_t N>
T& one_of(Bytes& bytes, std::array<T, N>& values) {
  return values[bytes.byte() % values.size()];
}

/// In range: 0 … the full range.
inline std::uint32_t next_pwm(Bytes& bytes) {
  return bytes.next<std::uint16_t>() + std::uint32_t{bytes.flag()};
}

inline OutputChange next_change(Bytes& bytes) {
  OutputChange change{.changed = bytes.below<std::uint8_t>(32)};
  change.on = static_cast<std::uint8_t>(bytes.byte() & change.changed & 15U);
  change.port = bytes.below<std::uint8_t>(kPortCount + 1);
  change.port_on = change.port != 0 && bytes.flag();
  change.pwm = bytes.below<std::uint8_t>(kPwmCount + 1);
  if ((change.changed & OutputChange::kSpindlePwm) != 0) change.spindle_pwm = next_pwm(bytes);
  if (change.pwm != 0) change.pwm_value = next_pwm(bytes);
  return change;
}

inline Outputs next_outputs(Bytes& bytes) {
  const auto bits = bytes.byte();
  Outputs outputs{.drives_enabled = (bits & 1U) != 0,
                  .spindle_on = (bits & 2U) != 0,
                  .tool_direction = (bits & 4U) != 0,
                  .spindle_pwm = next_pwm(bytes),
                  .mist = (bits & 8U) != 0,
                  .flood = (bits & 16U) != 0,
                  .ports = bytes.next<std::uint64_t>() >> (64 - kPortCount)};
  one_of(bytes, outputs.pwm) = next_pwm(bytes);
  return outputs;
}

/// Few inputs take part in a rule, so that it becomes true now and then.
inline GuardRule next_rule(Bytes& bytes) {
  return {.participants = static_cast<std::uint8_t>(bytes.byte() & bytes.byte()),
          .compare = bytes.byte(),
          .action = static_cast<GuardAction>(bytes.below(4))};
}

/// Mostly one that a board takes.
inline void vary(Bytes& bytes, Setup& setup) {
  switch (bytes.below(8)) {
    case 0:
      setup.max_velocity = bytes.flag() ? kTopVelocity : bytes.next<StepVelocity>();
      return;
    case 1:
      setup.host_timeout = bytes.next<std::int32_t>();
      return;
    case 2:
      setup.index_timeout = bytes.next<std::int32_t>();
      return;
    case 3:
      setup.drives_off_on_fault = bytes.flag();
      return;
    case 4:
      one_of(bytes, setup.max_acceleration) = StepAcceleration{1} << bytes.below(45);
      return;
    case 5:
      setup.pulse_width = bytes.byte();
      setup.direction_setup = bytes.next<std::uint16_t>() % 512;
      setup.direction_hold = bytes.next<std::uint16_t>() % 512;
      return;
    case 6:
      setup.step_inverted = bytes.byte();
      setup.direction_inverted = bytes.byte();
      return;
    default:
      one_of(bytes, setup.guards) = next_rule(bytes);
      return;
  }
}

inline Setup usual_setup() {
  Setup setup{.max_velocity = kUsualLimit,
              .host_timeout = kTicksPerSecond,
              .index_timeout = kTicksPerSecond / 4};
  for (std::size_t axis = 1; axis < kAxisCount; ++axis)
    setup.max_acceleration[axis] = StepAcceleration{1} << (20 + 4 * axis);
  return setup;
}

inline Setup next_setup(Bytes& bytes) {
  Setup setup = usual_setup();
  for (auto count = bytes.below(16); count > 0; --count) vary(bytes, setup);
  return setup;
}

inline void toggle(std::uint8_t& bits, std::uint8_t bit) {
  bits = static_cast<std::uint8_t>(bits ^ (1U << bit));
}

/// `now`: when an index pulse comes.
inline void vary(Bytes& bytes, Inputs& inputs, Ticks now) {
  switch (bytes.below(16)) {
    case 0:
      return toggle(inputs.home, bytes.below(8));
    case 1:
      inputs.estop1 = bytes.below(4) == 1;
      return;
    case 2:
      inputs.estop2 = bytes.below(4) == 1;
      return;
    case 3:
      inputs.external_error = bytes.flag();
      return;
    case 4:
      inputs.probe = bytes.flag();
      return;
    case 5:
      return toggle(inputs.alarm, bytes.below(kAxisCount));
    case 6:
      one_of(bytes, inputs.analog) = bytes.next<std::uint32_t>();
      return;
    case 7:
      inputs.hand_wheel_count = bytes.next<std::int32_t>();
      return;
    case 8:
      inputs.sync = bytes.flag();
      inputs.hand_wheel_a = bytes.flag();
      inputs.hand_wheel_b = bytes.flag();
      return;
    case 9:
    case 10:
    case 11:
      inputs.index_count += 1U + bytes.below(4);
      inputs.index_time = now;
      return;
    default:
      inputs.ports ^= PortBits{1} << bytes.below<std::uint8_t>(kPortCount);
      return;
  }
}

/// Half of the segments go a random way at a believable speed in the right order, so that the
/// fuzzer does not have to guess six 64-bit numbers to get anything moving.
inline Segment next_segment(Bytes& bytes, Segment& tail) {
  Segment segment{.id = tail.id + 1, .duration = bytes.next<std::uint16_t>()};
  const auto kind = bytes.byte();
  const bool wild = kind % 16 == 15;
  segment.wait_for_index = kind % 16 == 2;
  segment.spindle_period = kind % 4 == 2 ? bytes.next<std::uint32_t>() : 0;
  if (kind % 8 == 4) segment.change = next_change(bytes);
  if (wild) {
    segment.id = bytes.next<std::uint32_t>();
    segment.duration = bytes.next<std::uint32_t>() % (1U << 29);
  }
  const auto moves = bytes.byte();
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    segment.position[axis] = tail.position[axis];
    if ((moves & axis_bit(axis)) == 0) continue;
    if (wild) {
      segment.position[axis] = bytes.next<std::int64_t>();
      segment.velocity[axis] = bytes.next<std::int32_t>();
    } else {
      segment.position[axis] +=
          bytes.next<std::int16_t>() * (kUsualLimit / 32768) * segment.duration;
      segment.velocity[axis] = bytes.next<std::int16_t>() * (kUsualLimit / 32768);
    }
  }
  if (!wild) tail = segment;
  return segment;
}

/// As a host would see the end of its path: where the board stands when it dropped it.
inline Segment standstill_of(const Status& status, std::uint32_t id) {
  Segment tail{.id = id};
  for (std::size_t axis = 0; axis < kAxisCount; ++axis)
    tail.position[axis] = position_of_step(status.counts[axis]);
  return tail;
}

inline void add_requests(Bytes& bytes, HostFrame& frame) {
  const auto flags = bytes.byte();
  frame.quick_stop = flags % 16 == 1;
  frame.clear_faults = flags % 8 == 2;
  frame.stop_along_path = flags % 8 == 3;
  frame.release_stop = flags % 4 == 2;
  frame.with_next = flags % 8 == 7;
  frame.has_outputs = (flags & 16U) != 0;
  if (frame.has_outputs) frame.outputs = next_outputs(bytes);
  if ((flags & 32U) != 0) frame.change = next_change(bytes);
  if ((flags & 64U) != 0) one_of(bytes, frame.latch) = static_cast<LatchRequest>(bytes.below(4));
  if ((flags & 128U) != 0) frame.probe = static_cast<ProbeRequest>(bytes.below(3));
}

/// A frame for a board in this state; `tail` is the end of the path that it has been sent, and
/// `ends` are the last of them, by number: a cut goes on from one of these, or from anywhere.
class FrameMaker {
 public:
  void fill(Bytes& bytes, HostFrame& frame, const Status& board) {
    frame.reset();
    add_requests(bytes, frame);
    if (frame.empties_fifo() || board.path_stop == PathStop::stopped || board.faults != 0)
      tail_ = standstill_of(board, tail_.id);
    const auto count = bytes.below<std::uint32_t>(kSegmentsPerFrame + 1);
    const bool cuts = bytes.below(4) == 1;
    frame.segments_before_cut = cuts ? bytes.byte() % (count + 1) : 0;
    for (frame.segment_count = 0; frame.segment_count < count; ++frame.segment_count) {
      if (cuts && frame.segment_count == frame.segments_before_cut) cut(bytes, frame);
      frame.segments[frame.segment_count] = next_segment(bytes, tail_);
      ends_[tail_.id % ends_.size()] = tail_;
    }
    if (cuts && frame.segments_before_cut == count) cut(bytes, frame);
  }

 private:
  void cut(Bytes& bytes, HostFrame& frame) {
    const Segment& end = ends_[(tail_.id - bytes.below(8)) % ends_.size()];
    frame.has_cut = true;
    frame.cut_behind = bytes.below(8) == 7 ? bytes.next<std::uint32_t>() : end.id;
    const std::uint32_t newest = tail_.id;
    tail_ = end;
    tail_.id = newest;
  }

  Segment tail_{};
  std::array<Segment, 64> ends_{};
};

/// What a board says of itself; of what the wire can express anything.
inline void vary(Bytes& bytes, Status& status) {
  switch (bytes.below(20)) {
    case 0:
      status.time = bytes.flag() ? bytes.next<std::int64_t>()
                                 : status.time % kTicksPerSecond + bytes.next<std::uint16_t>();
      return;
    case 1:
      status.faults = bytes.next<FaultBits>();
      return;
    case 2:
      status.executing_id = bytes.flag() ? status.executing_id + 1 : bytes.next<std::uint32_t>();
      return;
    case 3:
      status.executing_elapsed = bytes.next<std::uint32_t>();
      status.executing_duration = bytes.next<std::uint32_t>();
      return;
    case 4:
      status.fifo_count = bytes.next<std::uint16_t>();
      return;
    case 5:
      status.fifo_free = bytes.next<std::uint16_t>();
      return;
    case 6:
      status.queued_time = bytes.next<std::int64_t>();
      return;
    case 7:
      status.moving = bytes.flag();
      status.cut_late = bytes.flag();
      return;
    case 8:
      one_of(bytes, status.counts) = bytes.next<std::int64_t>();
      return;
    case 9:
      status.inputs.ports = bytes.next<std::uint64_t>();
      status.inputs.alarm = bytes.byte();
      return;
    case 10:
      status.spindle_period = bytes.next<std::int64_t>();
      return;
    case 11:
      one_of(bytes, status.home_latch) = {bytes.flag(), bytes.flag(),
                                          bytes.flag() ? Edge::release : Edge::activate,
                                          bytes.next<std::int64_t>(), bytes.next<std::int64_t>()};
      return;
    case 12:
      status.probe_latch = {
          bytes.flag(), bytes.flag(), bytes.flag(), {}, bytes.next<std::int64_t>()};
      one_of(bytes, status.probe_latch.counts) = bytes.next<std::int64_t>();
      return;
    case 13:
      status.path_stop = static_cast<PathStop>(bytes.below(3));
      return;
    case 14:
      status.time_scale = bytes.next<std::uint32_t>();
      return;
    case 15:
      status.outputs = next_outputs(bytes);
      return;
    case 16:
      one_of(bytes, status.guard_counts) = bytes.byte();
      return;
    case 17:
      status.estop_latch = {bytes.next<std::uint32_t>(), {}, bytes.next<std::int64_t>()};
      one_of(bytes, status.estop_latch.counts) = bytes.next<std::int64_t>();
      return;
    case 18:
      status.inputs.index_count = bytes.next<std::uint32_t>();
      one_of(bytes, status.index_counts) = bytes.next<std::int64_t>();
      return;
    default:
      return vary(bytes, status.inputs, status.time);
  }
}

}  // namespace cnc::hal::cpu5::firmware
