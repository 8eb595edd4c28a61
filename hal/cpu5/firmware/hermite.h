// The cubic of one axis through a segment: from the end of the segment before it, with the velocity
// that one ended with, to the segment's own end position and end velocity. Velocity is therefore
// continuous within and between segments.
//
// With u = t / T, distance D, velocities v0 and v1 (per tick), Hermite interpolation is
//   p(u) = T v0 u  +  (3 D - 2 T v0 - T v1) u^2  +  (T v0 + T v1 - 2 D) u^3
#pragma once

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5::firmware {

/// What an axis does during a segment.
struct AxisMotion {
  StepPosition distance = 0;
  StepVelocity start_velocity = 0;
  StepVelocity end_velocity = 0;
  Ticks duration = 1;

  [[nodiscard]] bool stands_still() const {
    return distance == 0 && start_velocity == 0 && end_velocity == 0;
  }
};

/// The polynomial in x = t / 2^k, where 2^k is the power of two above T: only the coefficients need
/// divisions, once in a segment, and every value after that is three products. Units: 2^-38 step.
class Cubic {
 public:
  Cubic() = default;
  /// Every velocity of `motion`, the mean one included, is at most kTopVelocity, and its duration
  /// is 1 … kMaxSegmentTicks: then no value below exceeds 2^62.
  explicit Cubic(const AxisMotion& motion);

  /// Way made `elapsed` ticks after the segment's start. Within 2^-31 step of the true cubic; the
  /// caller takes the segment's stated end at its last tick, so the error never adds up.
  [[nodiscard]] StepPosition distance_after(Ticks elapsed) const;
  /// The same between two ticks, on the straight line between them. `elapsed` is before the end.
  [[nodiscard]] StepPosition distance_at(PathTime elapsed) const;
  [[nodiscard]] StepVelocity velocity_after(Ticks elapsed) const;
  [[nodiscard]] StepAcceleration acceleration_after(Ticks elapsed) const;

  /// When the way reaches `distance`, which it does between two moments: `upwards`, or downwards.
  struct Passage {
    StepPosition distance;
    bool upwards;
    PathTime after;
    PathTime before;
  };
  /// Within a hundredth of a tick at a constant speed, and at any acceleration that changes the
  /// speed by less than a hundredth within a tick.
  [[nodiscard]] PathTime moment_of(const Passage& passage) const;

 private:
  [[nodiscard]] std::uint32_t part_of_power(Ticks elapsed) const;

  int power_ = 0;  // k
  std::int64_t linear_ = 0;
  std::int64_t quadratic_ = 0;
  std::int64_t cubic_ = 0;
};

/// Highest speed (absolute) anywhere in the motion. Velocities of `motion` and its mean velocity
/// are at most kTopVelocity.
[[nodiscard]] StepVelocity peak_speed(const AxisMotion& motion);

}  // namespace cnc::hal::cpu5::firmware
