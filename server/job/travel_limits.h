// Soft limits: may the machine go there at all (STA-6).
#pragma once

#include "config/machine_config.h"
#include "motion/extents.h"

namespace cnc::server {

/// Refuses an extent that leaves the limits of a connected axis, naming axis, value and limit, and
/// any motion of an axis that is not connected.
[[nodiscard]] Result<void> check_travel(const config::MachineConfig& config,
                                        const motion::Extents& extents);

/// As much of a path's `tolerance` (mm) as lets it stay within the travel too, 0.1 µm at least.
[[nodiscard]] double tolerance_within_travel(const config::MachineConfig& config,
                                             const motion::Extents& extents, double tolerance);

/// Refuses a synchronised move that an axis cannot follow: `feed` along `way`, with the room that
/// the board keeps for a spindle that turns faster than planned (manual 3.4.9).
[[nodiscard]] Result<void> check_thread_speed(const config::MachineConfig& config,
                                              const Position& way, double feed);
/// Refuses a straight move that touches the tool change area (STA-7).
[[nodiscard]] Result<void> check_tool_change_area(const config::ToolChangeArea& area,
                                                  const Position& start, const Position& end);
/// The same for a curve within `extents`: the space around it counts.
[[nodiscard]] Result<void> check_tool_change_area(const config::ToolChangeArea& area,
                                                  const motion::Extents& extents);

}  // namespace cnc::server
