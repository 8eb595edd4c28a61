// Outputs, inputs and states of the Controller as the board's numbers, and back.
#pragma once

#include "hal/controller.h"
#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5 {

/// PWM values beyond 0 … 1 count as the nearest of these; not a number as 0.
[[nodiscard]] firmware::Outputs to_board(const Outputs& outputs);
[[nodiscard]] firmware::OutputChange to_board(const OutputChange& change);
[[nodiscard]] firmware::PerGuardRule<firmware::GuardRule> to_board(
    const std::array<config::GuardRule, config::kGuardRules>& rules);
[[nodiscard]] Outputs from_board(const firmware::Outputs& outputs);
[[nodiscard]] Inputs from_board(const firmware::Inputs& inputs);
[[nodiscard]] PathStop from_board(firmware::PathStop stop);

}  // namespace cnc::hal::cpu5
