// A C² path for tests of the third-order speed plan: the cubic smoothing spline inside a tube
// around a polyline (design notes' section 3, whole program at once), as intervals of its
// parameter.
#pragma once

#include <vector>

#include "motion/path_interval.h"

namespace cnc::motion::test {

/// Intervals of the smoothing spline that stays within about `tolerance` of `vertices`.
[[nodiscard]] std::vector<PathInterval> tube_path(const std::vector<Position>& vertices,
                                                  double tolerance, double feed);

/// One straight interval along X.
[[nodiscard]] PathInterval straight_interval(double length, double feed);

}  // namespace cnc::motion::test
