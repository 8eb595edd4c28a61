// A spindle that follows its PWM, and its index pulse: one per revolution. Near the wanted speed it
// follows with a first-order lag; further away the drive's torque and the spindle's inertia limit
// how fast the speed changes.
#pragma once

#include <cstdint>

#include "hal/sim/step_clock.h"

namespace cnc::hal::sim {

struct SpindleOptions {
  double time_constant = 0.1;     ///< s, above 0; after five of them the speed is within 1 %
  double acceleration = 500'000;  ///< rpm per second at most, above 0
  double sync_width = 0.1;        ///< of a revolution that the sync input is active for
};

class VirtualSpindle {
 public:
  using Ticks = cpu5::firmware::Ticks;

  explicit VirtualSpindle(const SpindleOptions& options);

  /// Wanted speed in rpm; negative: backwards.
  void set_target(double speed) { target_ = speed; }
  void advance(Ticks now);
  /// The index sensor's cable: without it no pulse is seen.
  void set_index_missing(bool missing) { index_missing_ = missing; }

  [[nodiscard]] double speed() const { return speed_; }  ///< rpm, signed
  [[nodiscard]] bool sync_input() const;
  [[nodiscard]] std::uint32_t pulses() const { return pulses_; }
  [[nodiscard]] Ticks last_pulse() const { return last_pulse_; }

 private:
  void turn();

  SpindleOptions options_;
  StepClock clock_;
  double gain_;            // of the speed's way to its target in one step
  double highest_change_;  // of the speed in one step, rpm
  bool index_missing_ = false;
  double target_ = 0.0;
  double speed_ = 0.0;
  double angle_ = 0.5;  // revolutions; the pulse is where it passes a whole one
  std::uint32_t pulses_ = 0;
  Ticks last_pulse_ = 0;
};

}  // namespace cnc::hal::sim
