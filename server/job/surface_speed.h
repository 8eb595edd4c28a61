// Constant surface speed (G96): the spindle's speed from the radius that is turned.
#pragma once

#include <algorithm>
#include <numbers>

#include "interpreter/canonical.h"

namespace cnc::server {

/// rpm = 60 v / (2 pi r) (manual 3.4.25), at most D and at most what the spindle can do; that much
/// on the axis itself.
[[nodiscard]] inline double surface_rpm(const interp::UseSurfaceSpeed& surface, double radius,
                                        double spindle_limit) {
  constexpr double kSecondsPerMinute = 60.0;
  const double limit = std::min(surface.max_speed.value_or(spindle_limit), spindle_limit);
  const double circumference = 2.0 * std::numbers::pi * radius;
  const double wanted = kSecondsPerMinute * surface.surface_speed;
  return wanted >= limit * circumference ? limit : wanted / circumference;
}

}  // namespace cnc::server
