// Random bytes as the board's host: whatever frames and times come, the core neither crashes nor
// moves faster than its limit, nor moves at all while a fault is pending.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "hal/cpu5/firmware/host_frame.h"

namespace {

using namespace cnc::hal::cpu5::firmware;

constexpr StepVelocity kLimit = velocity_of_frequency(400'000);

void require(bool condition) {
  if (!condition) std::abort();
}

/// Reads numbers from the input; zeros after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  [[nodiscard]] bool empty() const { return left_ == 0; }

  template <typename T>
  T next() {
    T value{};
    const std::size_t size = left_ < sizeof value ? left_ : sizeof value;
    std::memcpy(&value, data_, size);
    data_ += size;
    left_ -= size;
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// Counts the pulses of every axis since the last check, and lets the input press switches.
class FuzzedBoard final : public BoardIo {
 public:
  void step(std::size_t axis, int direction, Ticks when) override {
    require(axis < kAxisCount && (direction == 1 || direction == -1));
    require(when >= last_step);
    last_step = when;
    ++pulses[axis];
  }
  Inputs inputs(Ticks) override { return present; }
  void set_outputs(const Outputs& outputs) override { last_outputs = outputs; }

  PerAxis<std::int64_t> pulses{};
  Ticks last_step = 0;
  Inputs present{};
  Outputs last_outputs{};
};

OutputChange next_change(Bytes& bytes) {
  return {.changed = static_cast<std::uint8_t>(bytes.next<std::uint8_t>() % 32),
          .on = bytes.next<std::uint8_t>(),
          .port = static_cast<std::uint8_t>(bytes.next<std::uint8_t>() % (kPortCount + 1)),
          .pwm = static_cast<std::uint8_t>(bytes.next<std::uint8_t>() % (kPwmCount + 1))};
}

// Half of the segments go a random way at a believable speed in the right order, so that the fuzzer
// does not have to guess six 64-bit numbers to get anything moving.
Segment next_segment(Bytes& bytes, Segment& tail) {
  Segment segment{.id = tail.id + 1, .duration = bytes.next<std::uint16_t>()};
  const auto kind = bytes.next<std::uint8_t>();
  const bool wild = kind % 2 != 0;
  segment.wait_for_index = kind % 16 == 2;
  segment.spindle_period = kind % 4 == 2 ? bytes.next<std::uint32_t>() : 0;
  if (kind % 8 == 4) segment.change = next_change(bytes);
  if (wild) {
    segment.id = bytes.next<std::uint32_t>();
    segment.duration = bytes.next<std::uint32_t>();
  }
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if (wild) {
      segment.position[axis] = bytes.next<std::int64_t>();
      segment.velocity[axis] = bytes.next<std::int64_t>();
    } else {
      const StepVelocity mean = bytes.next<std::int16_t>() * (kLimit / 32768);
      segment.position[axis] = tail.position[axis] + mean * segment.duration;
      segment.velocity[axis] = bytes.next<std::int16_t>() * (kLimit / 32768);
    }
  }
  if (!wild) tail = segment;
  return segment;
}

void fill_frame(Bytes& bytes, HostFrame& frame, Segment& tail, Core& core) {
  const auto flags = bytes.next<std::uint8_t>();
  frame.reset();
  frame.quick_stop = flags % 16 == 1;
  frame.clear_faults = flags % 8 == 2;
  frame.stop_along_path = flags % 8 == 3;
  frame.release_stop = flags % 4 == 2;
  frame.probe = static_cast<ProbeRequest>(bytes.next<std::uint8_t>() % 3);
  frame.has_outputs = (flags & 16) != 0;
  frame.outputs.drives_enabled = true;
  if ((flags & 32) != 0) frame.change = next_change(bytes);
  frame.latch[flags % kAxisCount] = static_cast<LatchRequest>(bytes.next<std::uint8_t>() % 4);
  const bool stopped = core.status().path_stop == PathStop::stopped;
  if (frame.quick_stop || frame.clear_faults || stopped) {
    tail = {.id = tail.id};
    const Status status = core.status();
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      tail.position[axis] = position_of_step(status.counts[axis]);
    }
  }
  frame.segment_count = bytes.next<std::uint8_t>() % 8;
  for (std::uint32_t i = 0; i < frame.segment_count; ++i) {
    frame.segments[i] = next_segment(bytes, tail);
  }
}

// The way at the highest speed in that time; after an index pulse up to one slice (1000 ticks) may
// be owed, and rounding to whole steps is worth one more.
void check_pulses(FuzzedBoard& board, Ticks ticks, bool faulty_before) {
  const std::int64_t most = ((ticks + kSliceTicks) * kLimit >> kFractionBits) + 2;
  for (std::int64_t& pulses : board.pulses) {
    require(pulses <= (faulty_before ? 0 : most));
    pulses = 0;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  FuzzedBoard board;
  Core core(board);
  Setup setup{.max_velocity = kLimit, .host_timeout = kTicksPerSecond};
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    setup.max_acceleration[axis] = axis == 0 ? 0 : StepAcceleration{1} << (20 + 4 * axis);
  }
  require(core.set_up(setup));
  static const auto frame = std::make_unique<HostFrame>();
  Segment tail{};
  while (!bytes.empty()) {
    fill_frame(bytes, *frame, tail, core);
    execute(*frame, core);
    const bool faulty = core.status().faults != 0;
    require(!faulty || board.last_outputs == Outputs{});
    require(!faulty || !core.status().moving);
    require(core.status().path_stop != PathStop::stopped || !core.status().moving);

    board.present.home = bytes.next<std::uint8_t>();
    if (const auto pulses = bytes.next<std::uint8_t>(); pulses < 16) {
      board.present.index_count += pulses;
      board.present.index_time = core.status().time;
    }
    board.present.probe = bytes.next<std::uint8_t>() > 200;
    board.present.estop1 = bytes.next<std::uint8_t>() > 250;
    const Ticks ticks = bytes.next<std::uint16_t>();
    core.advance(ticks);
    check_pulses(board, ticks, faulty);
  }
  return 0;
}
