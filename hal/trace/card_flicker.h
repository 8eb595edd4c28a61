// Inputs of I/O cards that changed for less than an exchange: no status shows them, but the board
// has counted a guard rule that acted.
#pragma once

#include <array>

#include "config/guard_rule.h"
#include "hal/controller.h"

namespace cnc::hal::trace {

/// What the inputs were for a moment between two statuses of a session, so that the rules acted
/// that `after` counts. Those of `after` if they explain it.
[[nodiscard]] Ports flickered(const ControllerStatus& before, const ControllerStatus& after,
                              const std::array<config::GuardRule, config::kGuardRules>& rules);

}  // namespace cnc::hal::trace
