// What a curve takes by itself, from standstill to standstill: for progress and estimates.
#pragma once

#include "motion/limits.h"
#include "motion/overrides.h"
#include "motion/piece.h"

namespace cnc::motion {

/// Seconds for `length` of the piece's curve alone; an upper bound without limits of jerk. Infinite
/// when an override of 0 bars the way.
[[nodiscard]] double time_alone(const Piece& piece, double length, const AxisLimits& limits,
                                const Overrides& overrides);

}  // namespace cnc::motion
