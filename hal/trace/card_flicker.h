// Inputs of I/O cards that changed for less than an exchange: no status shows them, but the board
// has counted a guard rule that acted.
#pragma once

#include <array>
#include <vector>

#include "config/guard_rule.h"
#include "hal/controller.h"

namespace cnc::hal::trace {

/// What the inputs were, one after the other and each for a moment, between two statuses of a
/// session: those of `after` and these in turn make the rules act as often as `after` counts.
[[nodiscard]] std::vector<Ports> flickers(
    const ControllerStatus& before, const ControllerStatus& after,
    const std::array<config::GuardRule, config::kGuardRules>& rules);

}  // namespace cnc::hal::trace
