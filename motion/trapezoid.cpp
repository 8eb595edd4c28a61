#include "motion/trapezoid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cnc::motion {

namespace {

/// At no more than `speed`: a trapezoid.
double trapezoid_time(double length, double speed, double acceleration) {
  if (speed <= 0.0) return std::numeric_limits<double>::infinity();
  if (length * acceleration < speed * speed) return 2.0 * std::sqrt(length / acceleration);
  return length / speed + speed / acceleration;
}

/// Along an arc the direction takes every value: |q'_i| <= 1 for the axes of its plane bounds it,
/// and half of each limit is left to the curvature.
Position direction_bound(const Curve& curve) {
  Position bound = tangent_of(curve, 0.0);
  if (is_straight(curve)) return bound;
  for (const Axis axis : kLinearAxes) {
    const bool moves = bound[axis] != 0.0 || bend_of(curve, 0.0)[axis] != 0.0;
    bound[axis] = moves ? 2.0 : 0.0;
  }
  return bound;
}

}  // namespace

double time_alone(const Piece& piece, double length, const AxisLimits& limits,
                  const Overrides& overrides) {
  const Position direction = direction_bound(piece.curve);
  const double machine = largest_along(direction, limits.max_velocity);
  const double factor = overrides.of(piece.override);
  const double speed =
      piece.kind == MoveKind::rapid ? machine * factor : std::min(machine, piece.feed * factor);
  return trapezoid_time(length, speed, largest_along(direction, limits.max_acceleration));
}

}  // namespace cnc::motion
