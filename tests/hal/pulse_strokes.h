// Strokes to and fro at 100 kHz for any length of time, with every single pulse looked at: its
// direction, its distance from the one before, and the exact count at the end of each stroke.
#pragma once

#include "hal/cpu5/firmware/core.h"

namespace cnc::hal::cpu5::firmware {

class PulseStrokes final : public BoardIo {
 public:
  PulseStrokes() { good_ = core_.set_up({.max_velocity = kSpeed + 10}); }

  /// One stroke: run-up of 0.1 s, `seconds` at full speed, run-out of 0.1 s. False as soon as a
  /// pulse was lost, doubled, out of its time or in the wrong direction.
  bool stroke(int seconds) {
    direction_ = -direction_;
    last_ = core_.status().time;
    const std::uint64_t before = pulses_;
    push(kSpeed, 1);
    for (int i = 0; i < 10 * seconds; ++i) push(kSpeed, 2);
    push(0, 1);
    core_.advance(core_.status().queued_time);
    const Status status = core_.status();
    const std::int64_t end = position_ >> kFractionBits;
    good_ = good_ && status.faults == 0 && !status.moving && status.counts[0] == end;
    return good_ &&
           pulses_ - before == kStepsPerSegment * (10U * static_cast<unsigned>(seconds) + 1);
  }

  [[nodiscard]] std::uint64_t pulses() const { return pulses_; }
  [[nodiscard]] Ticks time() const { return core_.time(); }

 private:
  static constexpr StepVelocity kSpeed = kOneStep / 100;  // 100 kHz
  static constexpr Ticks kSegment = kTicksPerSecond / 10;
  static constexpr std::uint64_t kStepsPerSegment = 10'000;
  static constexpr Ticks kPeriod = 100;

  // A segment of 0.1 s makes as many halves of 10'000 steps as said.
  void push(StepVelocity end_velocity, int halves) {
    position_ += direction_ * position_of_step(halves * static_cast<int>(kStepsPerSegment) / 2);
    Segment segment{.id = ++id_, .duration = static_cast<std::uint32_t>(kSegment)};
    if (id_ == 0) segment.id = ++id_;
    segment.position[0] = position_;
    segment.velocity[0] = direction_ * end_velocity;
    if (core_.status().fifo_free == 0) core_.advance(200 * kSegment);
    good_ = core_.push(segment) && good_;
  }

  void step(std::size_t axis, int direction, Ticks when) override {
    good_ = good_ && axis == 0 && direction == direction_ && when - last_ >= kPeriod - 1;
    last_ = when;
    ++pulses_;
  }
  Inputs inputs(Ticks) override { return {}; }
  void set_outputs(const Outputs&) override {}

  Core core_{*this};
  bool good_ = true;
  int direction_ = -1;
  std::uint32_t id_ = 0;
  StepPosition position_ = 0;
  Ticks last_ = 0;
  std::uint64_t pulses_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
