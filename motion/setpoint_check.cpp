#include "motion/setpoint_check.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace cnc::motion {

namespace {

/// Last digits of positions, mm: the same motion computed twice may differ by this. Seen over the
/// duration h of a setpoint it is a velocity of 2/h, an acceleration of 6/h² and a jerk of 12/h³
/// times as much.
constexpr double kPositionRounding = 1e-10;

struct Bounds {
  double min;
  double max;
};

/// Where the velocity is zero inside the setpoint the position has an extreme.
Bounds positions_of(const AxisCubic& cubic) {
  Bounds bounds{std::min(cubic.p0, cubic.p1), std::max(cubic.p0, cubic.p1)};
  const double a = cubic.start_acceleration();
  const double root = std::sqrt(a * a - 2.0 * cubic.jerk() * cubic.v0);  // NaN: none
  // Both roots in the form that does not lose digits; q = 0 gives NaN or inf, which is passed over.
  const double q = -(a + std::copysign(root, a));
  for (const double t : {q / cubic.jerk(), 2.0 * cubic.v0 / q}) {
    if (!(t > 0.0 && t < cubic.duration)) continue;
    bounds.min = std::min(bounds.min, cubic.position(t));
    bounds.max = std::max(bounds.max, cubic.position(t));
  }
  return bounds;
}

Result<void> check_usable(const Setpoint& setpoint) {
  bool usable = setpoint.duration > 0.0 && std::isfinite(setpoint.duration);
  for (const Axis axis : kAllAxes) {
    usable =
        usable && std::isfinite(setpoint.position[axis]) && std::isfinite(setpoint.velocity[axis]);
  }
  if (usable) return {};
  return fail(
      ErrorCode::setpoint_unusable,
      fmt::format("A setpoint of {} s contains a number that is not usable.", setpoint.duration));
}

Result<void> check_travel(Axis axis, const AxisCubic& cubic, const Bounds& travel) {
  const Bounds positions = positions_of(cubic);
  const double below = std::min(travel.min, cubic.p0) - kTravelTolerance;
  const double above = std::max(travel.max, cubic.p0) + kTravelTolerance;
  if (positions.min >= below && positions.max <= above) return {};
  return fail(
      ErrorCode::setpoint_outside_travel,
      fmt::format("Axis {} would go to {:.4f}; its travel is {:.4f} to {:.4f}.", axis_name(axis),
                  positions.min < below ? positions.min : positions.max, travel.min, travel.max));
}

Result<void> check_velocity(Axis axis, const AxisCubic& cubic, double limit) {
  const double fastest = cubic.fastest();
  const double rounding = 2.0 * kPositionRounding / cubic.duration;
  if (fastest <= limit * (1.0 + kRateTolerance) + rounding) return {};
  return fail(ErrorCode::setpoint_too_fast,
              fmt::format("Axis {} would move at {:.6g} per second; its limit is {:.6g}.",
                          axis_name(axis), fastest, limit));
}

Result<void> check_acceleration(Axis axis, const AxisCubic& cubic, double limit) {
  const double hardest =
      std::max(std::abs(cubic.start_acceleration()), std::abs(cubic.end_acceleration()));
  const double rounding = 6.0 * kPositionRounding / (cubic.duration * cubic.duration);
  if (hardest <= limit * (1.0 + kRateTolerance) + rounding) return {};
  return fail(ErrorCode::setpoint_acceleration_too_high,
              fmt::format("Axis {} would accelerate with {:.6g} per second²; its limit is {:.6g}.",
                          axis_name(axis), hardest, limit));
}

Result<void> check_jerk(Axis axis, const AxisCubic& cubic, double limit) {
  const double jerk = std::abs(cubic.jerk());
  const double rounding = 12.0 * kPositionRounding / std::pow(cubic.duration, 3);
  if (limit <= 0.0 || jerk <= limit * (1.0 + kRateTolerance) + rounding) return {};
  return fail(ErrorCode::setpoint_jerk_too_high,
              fmt::format("Axis {} would jerk with {:.6g} per second³; its limit is {:.6g}.",
                          axis_name(axis), jerk, limit));
}

}  // namespace

SetpointCheck::SetpointCheck(const AxisLimits& limits, const Extents& travel, const Position& start)
    : limits_(limits), travel_(travel), position_(start) {}

Result<void> SetpointCheck::check(const Setpoint& setpoint) {
  if (auto good = check_usable(setpoint); !good) return good;
  for (const Axis axis : kAllAxes) {
    const AxisCubic cubic = cubic_of(axis, position_, velocity_, setpoint);
    const Bounds travel{travel_.min[axis], travel_.max[axis]};
    if (auto good = check_travel(axis, cubic, travel); !good) return good;
    if (auto good = check_velocity(axis, cubic, limits_.max_velocity[axis]); !good) return good;
    if (auto good = check_acceleration(axis, cubic, limits_.max_acceleration[axis]); !good) {
      return good;
    }
    if (auto good = check_jerk(axis, cubic, limits_.max_jerk[axis]); !good) return good;
  }
  position_ = setpoint.position;
  velocity_ = setpoint.velocity;
  return {};
}

void SetpointCheck::restart(const Position& position, const Position& velocity) {
  position_ = position;
  velocity_ = velocity;
}

}  // namespace cnc::motion
