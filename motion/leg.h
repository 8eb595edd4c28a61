// The forward half of the speed plan: how the motion goes on from here, one stretch of constant
// d²s/dt² at a time.
#pragma once

#include <cmath>
#include <optional>

#include "motion/step.h"

namespace cnc::motion {

/// A stretch with constant w = d²s/dt² inside one step.
struct Leg {
  double w = 0.0;
  double length = 0.0;
  double start_speed = 0.0;
  double end_speed = 0.0;

  [[nodiscard]] double duration() const { return 2.0 * length / (start_speed + end_speed); }
};

/// What the step's end demands: the largest x there for the machine, and with the feed.
struct Exit {
  double machine_x;
  double wanted_x;
};

/// The next leg from `done` mm inside `step` at `speed`: as fast as the limits allow, or with
/// `braking` to a standstill as soon as they allow. Nothing when it stands still and is to stay so.
///
/// It needs no memory of earlier decisions: whatever happened to feed and override, from a speed
/// that keeps to the machine's entry of this step it finds a way that keeps to it further on. A
/// speed above what is wanted is reduced as fast as the machine can.
[[nodiscard]] std::optional<Leg> next_leg(const Step& step, double done, double speed,
                                          const Exit& exit, bool braking);

}  // namespace cnc::motion
