// What the machine can do, per axis, and what follows for a direction of travel.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/axis.h"
#include "config/ramp.h"

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

/// Time in which an axis comes to rest from `speed`; an axis without limits may be asked for 0.
[[nodiscard]] inline double braking_time(const AxisLimits& limits, Axis axis, double speed) {
  if (speed == 0.0) return 0.0;
  return config::braking_time(speed, limits.max_acceleration[axis], limits.max_jerk[axis]);
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
