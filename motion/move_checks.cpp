#include "motion/move_checks.h"

#include <cmath>
#include <fmt/core.h>

namespace cnc::motion {

namespace {

bool is_usable(double value) { return std::abs(value) <= kLargestCoordinate; }  // false for NaN

}  // namespace

Result<void> check_end(const Position& end) {
  for (const Axis axis : kAllAxes) {
    if (is_usable(end[axis])) continue;
    return fail(ErrorCode::move_number_unusable,
                fmt::format("The target of axis {} is {}; it must be a number within ±{:.0f}.",
                            axis_name(axis), end[axis], kLargestCoordinate));
  }
  return {};
}

Result<void> check_options(const MoveOptions& options) {
  if (options.kind == MoveKind::feed && !(options.feed > 0.0 && options.feed <= kLargestFeed)) {
    return fail(ErrorCode::move_feed_unusable,
                fmt::format("The feed is {} mm/s; it must be above 0 and at most {:.0f}.",
                            options.feed, kLargestFeed));
  }
  for (const double tolerance : {options.tolerance, options.simplify}) {
    if (tolerance >= 0.0 && tolerance <= kLargestCoordinate) continue;
    return fail(ErrorCode::move_number_unusable,
                fmt::format("A tolerance of the path is {} mm; it must be 0 or more.", tolerance));
  }
  if (options.laf_angle && !std::isfinite(*options.laf_angle)) {
    return fail(ErrorCode::move_number_unusable,
                "The angle up to which corners are not stopped at is not a number.");
  }
  return {};
}

Result<void> check_axes(const Extents& extents, const AxisLimits& limits) {
  for (const Axis axis : kAllAxes) {
    const bool moves = extents.max[axis] > extents.min[axis];
    const double velocity = limits.max_velocity[axis];
    const double acceleration = limits.max_acceleration[axis];
    const bool can_move = velocity > 0.0 && acceleration > 0.0 && std::isfinite(velocity) &&
                          std::isfinite(acceleration);
    if (moves && !can_move) {
      return fail(ErrorCode::move_axis_without_limits,
                  fmt::format("Axis {} would move but has no velocity and acceleration limit "
                              "above 0.",
                              axis_name(axis)));
    }
  }
  return {};
}

Result<void> check_arc(const ArcShape& arc) {
  if (!is_usable(arc.first_centre) || !is_usable(arc.second_centre)) {
    return fail(ErrorCode::move_number_unusable,
                fmt::format("The centre of the arc is {}, {}; both must be numbers within ±{:.0f}.",
                            arc.first_centre, arc.second_centre, kLargestCoordinate));
  }
  if (arc.turns > kMostTurns || arc.turns < -kMostTurns) {
    return fail(ErrorCode::move_number_unusable,
                fmt::format("The arc has {} turns; {} are allowed.", arc.turns, kMostTurns));
  }
  return {};
}

}  // namespace cnc::motion
