// How long an axis takes to come to rest.
#pragma once

#include <cmath>

namespace cnc::config {

/// From `speed` >= 0 with at most `acceleration` > 0 and `jerk` >= 0, 0: no limit. v/a, and a/j
/// more to build the braking up and to give it back; 2 sqrt(v/j) where it never reaches a.
[[nodiscard]] inline double braking_time(double speed, double acceleration, double jerk) {
  if (jerk == 0.0) return speed / acceleration;
  return speed * jerk < acceleration * acceleration ? 2.0 * std::sqrt(speed / jerk)
                                                    : speed / acceleration + acceleration / jerk;
}

}  // namespace cnc::config
