// From the planned track to setpoints.
//
// On a straight line the motion is quadratic in time between two changes of acceleration, which a
// setpoint's cubic repeats exactly; so setpoints end where the acceleration changes. On curves they
// are kept so short that the cubic stays within 1 nm of the path and within the reserve that the
// plan has left (step.h). Several short legs become one setpoint where its cubic keeps the axes'
// limits and passes through the planned motion's positions to 1 nm: what the machine does is the
// cubic, so judging the cubic is what makes merging safe.
#pragma once

#include <cstddef>
#include <optional>

#include "config/axis.h"
#include "motion/setpoint.h"
#include "motion/track.h"

namespace cnc::motion {

/// Legs that one setpoint may join.
inline constexpr std::size_t kMostLegs = 32;

class Sampler {
 public:
  explicit Sampler(double max_duration) : max_duration_(max_duration) {}

  /// The next setpoint from the track's place, and moves the track on to its end; nothing when the
  /// track stands still. Real-time: allocates nothing, takes bounded time.
  [[nodiscard]] std::optional<Setpoint> next(Track& track, bool braking) const;

 private:
  double max_duration_;
};

}  // namespace cnc::motion
