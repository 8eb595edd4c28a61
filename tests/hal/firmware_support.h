// A board whose pins are watched by the test, and short ways to write segments for the core.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "hal/cpu5/firmware/core.h"

namespace cnc::hal::cpu5::firmware {

struct Pulse {
  std::size_t axis;
  int direction;
  Ticks when;

  friend bool operator==(const Pulse&, const Pulse&) = default;
};

/// The outputs as they became, and when: to the tick at which the inputs were looked at last.
struct Switching {
  Outputs outputs;
  Ticks when;
  PerAxis<std::int64_t> counts;
};

class WatchedBoard final : public BoardIo {
 public:
  void step(std::size_t axis, int direction, Ticks when) override {
    counts[axis] += direction;
    if (keep_pulses) pulses.push_back({axis, direction, when});
    ++pulse_count;
  }
  Inputs inputs(Ticks time) override {
    now = time;
    return read_inputs ? read_inputs() : Inputs{};
  }
  void set_outputs(const Outputs& outputs) override {
    if (outputs != last_outputs) switchings.push_back({outputs, now, counts});
    last_outputs = outputs;
    if (on_switching) on_switching();
  }

  PerAxis<std::int64_t> counts{};
  Ticks now = 0;  // of the inputs asked for
  bool keep_pulses = false;
  std::vector<Pulse> pulses;
  std::uint64_t pulse_count = 0;
  Outputs last_outputs{};
  std::vector<Switching> switchings;
  std::function<void()> on_switching;
  std::function<Inputs()> read_inputs;
};

inline constexpr Setup kFastBoard{.max_velocity = velocity_of_frequency(400'000)};

inline StepPosition steps(double count) { return std::llround(std::ldexp(count, kFractionBits)); }
inline StepVelocity steps_per_second(double frequency) {
  return std::llround(std::ldexp(frequency / double{kTicksPerSecond}, kFractionBits));
}
inline Ticks ticks(double seconds) { return std::llround(seconds * double{kTicksPerSecond}); }

/// A segment that moves X alone.
inline Segment x_segment(std::uint32_t id, double seconds, double end_step,
                         double end_frequency = 0.0) {
  Segment segment{.id = id, .duration = static_cast<std::uint32_t>(ticks(seconds))};
  segment.position[0] = steps(end_step);
  segment.velocity[0] = steps_per_second(end_frequency);
  return segment;
}

}  // namespace cnc::hal::cpu5::firmware
