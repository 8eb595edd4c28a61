#include "motion/offset_ramp.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

void OffsetRamp::put(double value) {
  value_ = goal_ = value;
  velocity_ = 0.0;
}

void OffsetRamp::advance(double time) {
  while (time > 0.0 && !arrived()) {
    const Phase phase = next_phase();
    const double t = std::min(time, phase.duration);
    value_ += t * (velocity_ + 0.5 * phase.acceleration * t);
    velocity_ += phase.acceleration * t;
    if (phase.last && t == phase.duration) put(goal_);
    time -= t;
  }
}

/// Time-optimal: towards the side on which the goal lies when seen from where braking at once would
/// end; up to the top of the triangle or the velocity limit; then braking with just what it takes.
OffsetRamp::Phase OffsetRamp::next_phase() const {
  constexpr double kRounding = 1e-9;
  constexpr double kBrakingRounding = 10.0 * kRounding;
  constexpr double kLastDigits = 1e-13;  // of the value, mm
  const double a = max_acceleration_;
  const double speed = std::abs(velocity_);
  const double braking = 0.5 * speed * speed / a;
  const double braked = value_ + std::copysign(braking, velocity_);
  const double way = goal_ - value_;
  const double missed = std::abs(goal_ - braked);
  if (velocity_ * way > 0.0 && missed <= kBrakingRounding * braking + kLastDigits)
    return {-0.5 * velocity_ * speed / std::abs(way), 2.0 * std::abs(way) / speed, true};
  const double side = goal_ > braked ? 1.0 : -1.0;
  const double v = side * velocity_;
  const double d = side * way;
  const double top = std::min(max_velocity_, std::sqrt(std::max(0.0, a * d + 0.5 * v * v)));
  if (v < top * (1.0 - kRounding)) return {side * a, (top - v) / a, false};
  return {0.0, (d - 0.5 * v * v / a) / v, false};
}

}  // namespace cnc::motion
