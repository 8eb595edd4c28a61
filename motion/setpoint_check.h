// The last look at every setpoint before it leaves for the machine.
//
// It knows nothing of how a setpoint came about: limits are checked when motion is planned, and
// here again on the cubic that the controller will execute, so that a fault in planning cannot
// become a fault of the machine. Real-time: allocates only for the message of an error.
#pragma once

#include "config/axis.h"
#include "config/error.h"
#include "motion/extents.h"
#include "motion/limits.h"
#include "motion/setpoint.h"

namespace cnc::motion {

/// A planned setpoint keeps the limits but for rounding. The check lets a little more pass than the
/// planner uses: it is there for faults, and stopping a cut for the last digit would be one, or for
/// the micrometre by which an exact path with limits of jerk leaves the program at a corner.
inline constexpr double kRateTolerance = 1e-3;    ///< part of a limit of rate
inline constexpr double kTravelTolerance = 2e-3;  ///< mm or degrees beyond the travel

class SetpointCheck {
 public:
  /// `travel`: where the axes may be; infinite where an axis has no end or is not homed. `start`:
  /// where the machine stands. An axis that is outside already may move, but not further out.
  SetpointCheck(const AxisLimits& limits, const Extents& travel, const Position& start);

  /// Position, velocity, acceleration and jerk of the whole cubic from the end of the last setpoint
  /// that was good to the end of this one. After an error nothing has changed.
  [[nodiscard]] Result<void> check(const Setpoint& setpoint);

  /// The next setpoint begins here and with this velocity, by whatever means.
  void restart(const Position& position, const Position& velocity = {});

 private:
  AxisLimits limits_;
  Extents travel_;
  Position position_;
  Position velocity_;
};

}  // namespace cnc::motion
