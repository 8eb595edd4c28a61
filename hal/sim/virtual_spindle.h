// A spindle that follows its PWM with a first-order lag, and its index pulse: one per revolution.
#pragma once

#include <cstdint>

#include "hal/sim/step_clock.h"

namespace cnc::hal::sim {

struct SpindleOptions {
  double time_constant = 0.1;  ///< s; after five of them the speed is within 1 %
  double sync_width = 0.1;     ///< of a revolution that the sync input is active for
};

class VirtualSpindle {
 public:
  using Ticks = cpu5::firmware::Ticks;

  explicit VirtualSpindle(const SpindleOptions& options);

  /// Wanted speed in rpm; negative: backwards.
  void set_target(double speed) { target_ = speed; }
  void advance(Ticks now);

  [[nodiscard]] double speed() const { return speed_; }  ///< rpm, signed
  [[nodiscard]] bool sync_input() const;
  [[nodiscard]] std::uint32_t pulses() const { return pulses_; }
  [[nodiscard]] Ticks last_pulse() const { return last_pulse_; }

 private:
  void turn();

  SpindleOptions options_;
  StepClock clock_;
  double gain_;  // of the speed's way to its target in one step
  double target_ = 0.0;
  double speed_ = 0.0;
  double angle_ = 0.5;  // revolutions; the pulse is where it passes a whole one
  std::uint32_t pulses_ = 0;
  Ticks last_pulse_ = 0;
};

}  // namespace cnc::hal::sim
