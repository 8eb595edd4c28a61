// The path as the third-order speed plan sees it: how position changes along its parameter.
#pragma once

#include <cstdint>

#include "config/axis.h"
#include "motion/curve.h"
#include "motion/overrides.h"

namespace cnc::motion {

/// A stretch of the path on which q(u) is a cubic of the parameter u. First and second derivative
/// are continuous from one interval to the next within a run; the third may jump. |q'| should be
/// near 1 (u is nearly the distance in mm): the choice of step lengths relies on it, no limit does.
struct PathInterval {
  double length = 0.0;  ///< of u, > 0
  Position first;       ///< q' at its begin
  Position second;      ///< q'' at its begin
  Position third;       ///< q''', constant
  /// Wanted speed of what `measure` names, mm/s or deg/s; > 0. Infinite: as fast as the axes can.
  double feed = 0.0;
  Measure measure = Measure::linear;
  Override override = Override::feed;
  std::uint64_t id = 0;  ///< the caller's

  [[nodiscard]] Position first_at(double u) const {
    return first + u * second + (0.5 * u * u) * third;
  }
  [[nodiscard]] Position second_at(double u) const { return second + u * third; }
  /// What the feed limits, of a velocity. A rotary move may move X Y Z by a residue of rounding.
  [[nodiscard]] double speed_of(const Position& velocity) const {
    return measure == Measure::linear ? linear_length(velocity) : rotary_length(velocity);
  }
};

/// Limits of the third-order plan, per axis; each > 0 for every axis that may move.
struct JerkLimits {
  Position velocity;
  Position acceleration;
  Position jerk;
};

}  // namespace cnc::motion
