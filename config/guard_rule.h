// What the board does by itself when inputs of an I/O card become what a rule describes (CFG-16).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace cnc::config {

inline constexpr std::size_t kGuardedCards = 3;
inline constexpr std::size_t kRulesPerCard = 8;
inline constexpr std::size_t kGuardRules = kGuardedCards * kRulesPerCard;

enum class GuardAction : std::uint8_t {
  nothing,
  warning,
  smooth_stop,  ///< along the path
  quick_stop,   ///< without a ramp: axes that move may slip
};

/// It acts when all inputs that take part become what `compare` says; bit 0 is input 1.
struct GuardRule {
  std::string text{};  ///< for the operator
  std::int32_t participants = 0;
  std::int32_t compare = 0;
  GuardAction action = GuardAction::nothing;

  friend bool operator==(const GuardRule&, const GuardRule&) = default;
};

}  // namespace cnc::config
