// How a machine is stopped along its path: path time slows down until it stands.
//
// The path stays what it is, p(tau); only the speed at which tau passes changes, s = dtau/dt. By
// the chain rule an axis then moves with
//   velocity      p' s
//   acceleration  p'' s^2 + p' ds/dt
// The board takes, slice by slice, the steepest ds/dt <= 0 that keeps every axis within its
// acceleration limit A:
//   -ds/dt <= (A + sign(p') p'' s^2) / |p'|
// An axis that the plan already brakes with A (p'' against p') leaves nothing: its own plan is the
// fastest stop then. A constant rate would add to what the plan brakes, up to twice the limit.
#pragma once

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5::firmware {

/// One axis at a point of its path, in path time.
struct PathDerivatives {
  StepVelocity velocity = 0;
  StepAcceleration acceleration = 0;
};

/// How much scale an axis allows to be lost within `length` ticks; kFullScale if it sets no limit.
/// `max_acceleration` 0 … kTopAcceleration, 0 = none; `scale` 0 … kTopScale; length <= 2^10.
[[nodiscard]] TimeScale allowed_loss(const PathDerivatives& axis, StepAcceleration max_acceleration,
                                     TimeScale scale, Ticks length);
/// How much it allows to be gained: the same with the plan's acceleration turned round.
[[nodiscard]] TimeScale allowed_gain(const PathDerivatives& axis, StepAcceleration max_acceleration,
                                     TimeScale scale, Ticks length);

}  // namespace cnc::hal::cpu5::firmware
