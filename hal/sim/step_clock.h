// Simulated physics in steps of a fixed length on the board's time, so that the result does not
// depend on how often the board looks.
#pragma once

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::sim {

class StepClock {
 public:
  using Ticks = cpu5::firmware::Ticks;

  explicit StepClock(Ticks step) : step_(step) {}

  [[nodiscard]] Ticks time() const { return time_; }
  [[nodiscard]] Ticks step() const { return step_; }
  [[nodiscard]] double step_seconds() const {
    return static_cast<double>(step_) / double{cpu5::firmware::kTicksPerSecond};
  }
  /// True, and one step later, while a whole step fits before `now`.
  bool take_step(Ticks now) {
    if (time_ + step_ > now) return false;
    time_ += step_;
    return true;
  }
  /// Leaves out every step before `now`.
  void skip_to(Ticks now) { time_ += (now - time_) / step_ * step_; }

 private:
  Ticks step_;
  Ticks time_ = 0;
};

}  // namespace cnc::hal::sim
