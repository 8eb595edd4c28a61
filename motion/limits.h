// What the machine can do, per axis, and what follows for a direction of travel.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/axis.h"

namespace cnc::motion {

struct AxisLimits {
  Position max_velocity;      ///< mm/s, deg/s; > 0 for every axis that may move
  Position max_acceleration;  ///< mm/s², deg/s²; > 0 for every axis that may move
  Position max_jerk{};        ///< mm/s³, deg/s³; 0: no limit

  [[nodiscard]] bool limit_jerk() const {
    return std::any_of(kAllAxes.begin(), kAllAxes.end(),
                       [&](Axis axis) { return max_jerk[axis] > 0.0; });
  }
};

/// Time in which an axis comes to rest from `speed`: v/a, and a/j more to build the braking up and
/// to give it back; 2 sqrt(v/j) where it never reaches a.
[[nodiscard]] inline double braking_time(const AxisLimits& limits, Axis axis, double speed) {
  if (speed == 0.0) return 0.0;
  const double a = limits.max_acceleration[axis];
  const double j = limits.max_jerk[axis];
  if (j == 0.0) return speed / a;
  return speed * j < a * a ? 2.0 * std::sqrt(speed / j) : speed / a + a / j;
}

/// Largest factor that keeps |factor * direction| within `limit` on every axis; infinite for a
/// direction of zero.
[[nodiscard]] inline double largest_along(const Position& direction, const Position& limit) {
  double factor = std::numeric_limits<double>::infinity();
  for (const Axis axis : kAllAxes) {
    if (direction[axis] != 0.0) factor = std::min(factor, limit[axis] / std::abs(direction[axis]));
  }
  return factor;
}

}  // namespace cnc::motion
