// Machine coordinates of one axis to the board's step counting and back.
//
// The board's counters are never set. The driver instead keeps the origin, the count at which the
// machine coordinate is 0, so a new position for the present count is exact and costs no step. Each
// position is converted by itself, never as a difference: nothing can add up.
#pragma once

#include <cmath>
#include <limits>

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5 {

class MotorScale {
 public:
  MotorScale() = default;
  /// Signed: negative when steps count against the axis. Finite, not 0.
  explicit MotorScale(double steps_per_unit) : steps_per_unit_(steps_per_unit) {}

  /// mm or degree, from now on, of the motor's present count.
  void set_position(double position, std::int64_t count) {
    origin_ = static_cast<double>(count) - position * steps_per_unit_;
  }

  [[nodiscard]] double position_of(std::int64_t count) const {
    return (static_cast<double>(count) - origin_) / steps_per_unit_;
  }
  [[nodiscard]] firmware::StepPosition to_steps(double position) const {
    return to_fixed(position * steps_per_unit_ + origin_);
  }
  [[nodiscard]] firmware::StepVelocity to_step_velocity(double velocity) const {
    return to_fixed(velocity * steps_per_unit_ / double{firmware::kTicksPerSecond});
  }

  /// Unsigned; what is too high, or is not a number, becomes 0: no limit.
  [[nodiscard]] firmware::StepAcceleration to_step_acceleration(double acceleration) const {
    constexpr double kTick = 1.0 / double{firmware::kTicksPerSecond};
    const double scaled = std::ldexp(std::abs(acceleration * steps_per_unit_) * kTick * kTick,
                                     firmware::kAccelerationBits);
    return scaled <= double{firmware::kTopAcceleration} ? std::llround(scaled) : 0;
  }

 private:
  // What does not fit, or is not a number, becomes a value that the board refuses as a bad segment.
  [[nodiscard]] static std::int64_t to_fixed(double steps) {
    const double scaled = std::ldexp(steps, firmware::kFractionBits);
    if (!(std::abs(scaled) <= std::ldexp(1.0, 62))) return std::numeric_limits<std::int64_t>::max();
    return std::llround(scaled);
  }

  double steps_per_unit_ = 1.0;
  double origin_ = 0.0;
};

}  // namespace cnc::hal::cpu5
