// What a move must be before the planner takes it.
#pragma once

#include "config/error.h"
#include "motion/extents.h"
#include "motion/planner.h"

namespace cnc::motion {

[[nodiscard]] Result<void> check_end(const Position& end);
[[nodiscard]] Result<void> check_options(const MoveOptions& options);
[[nodiscard]] Result<void> check_arc(const ArcShape& arc);
/// Every axis that moves within `extents` has limits to move by.
[[nodiscard]] Result<void> check_axes(const Extents& extents, const AxisLimits& limits);

}  // namespace cnc::motion
