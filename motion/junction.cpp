#include "motion/junction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cnc::motion {

namespace {

/// A change of direction below this is rounding: at 1 m/s it is a change of speed of 1 nm/s.
constexpr double kSmooth = 1e-9;

/// A blend at a sharper turn would nearly stand still in its middle; stopping is as fast.
constexpr double kLargestBlendAngle = 150.0;

/// A blend shorter than this is not worth having, mm.
constexpr double kShortestCut = 1e-7;

/// Angle between two directions of all six axes, degrees. (acos would lose small angles.)
double angle_between(const Position& a, const Position& b) {
  const Position difference = a * (1.0 / norm(a)) - b * (1.0 / norm(b));
  const double half = std::min(1.0, 0.5 * norm(difference));
  return 2.0 * std::asin(half) * 180.0 / std::numbers::pi;
}

/// How far a blend may reach into the curves so that it leaves them by no more than `tolerance`.
/// For straight curves it is a parabola and passes the vertex at cut |u2 − u1| / 4. A curve with
/// curvature κ, replaced together with a straight one, adds at most κ cut²/48 (the cubic differs
/// from it by κ cut²/54 before and κ cut²/64 after the vertex); each gets half of the tolerance.
double largest_cut(double turn, double curvature, double tolerance) {
  if (curvature == 0.0) return 4.0 * tolerance / turn;
  return std::min(
      {2.0 * tolerance / turn, std::sqrt(24.0 * tolerance / curvature), 0.2 / curvature});
}

}  // namespace

Junction judge_junction(const Curve& before, double before_end, const Curve& after,
                        const BlendLimits& limits) {
  if (measure_of(before) != measure_of(after)) return {JunctionKind::corner};
  const Position u1 = tangent_of(before, before_end);
  const Position u2 = tangent_of(after, 0.0);
  const double turn = norm(u2 - u1);
  if (turn < kSmooth) return {JunctionKind::smooth};
  if (angle_between(u1, u2) > std::min(limits.angle, kLargestBlendAngle)) {
    return {JunctionKind::corner};
  }
  const double curvature = norm(bend_of(before, before_end)) + norm(bend_of(after, 0.0));
  const double cut = std::min(
      {largest_cut(turn, curvature, limits.tolerance), limits.free_before, limits.free_after});
  if (cut < kShortestCut) return {JunctionKind::corner};
  return {JunctionKind::blend, cut};
}

Cubic make_blend(const Curve& before, double before_end, const Curve& after, double cut) {
  const double start = before_end - cut;
  return hermite_cubic(point_of(before, start), tangent_of(before, start), point_of(after, cut),
                       tangent_of(after, cut), 2.0 * cut);
}

}  // namespace cnc::motion
