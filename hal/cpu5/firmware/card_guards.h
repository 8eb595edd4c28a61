// Rules on the inputs of the I/O cards that the board itself watches (PROTOCOL.md).
//
// A rule is true while all inputs that take part in it are as it says. It acts when it becomes
// true; one that is true already when it is set up, at once. One that stays true does nothing more.
#pragma once

#include "hal/cpu5/firmware/outputs.h"

namespace cnc::hal::cpu5::firmware {

inline constexpr std::size_t kFirstCardPort = 16;
inline constexpr std::size_t kCards = 3;
inline constexpr std::size_t kCardInputs = 8;
inline constexpr std::size_t kRulesPerCard = 8;
inline constexpr std::size_t kGuardRules = kCards * kRulesPerCard;

/// In the order from weak to strong.
enum class GuardAction : std::uint8_t {
  nothing,
  warning,      ///< the host is told, as of all of them
  smooth_stop,  ///< along the path
  quick_stop,   ///< the fault kGuardStop
};

struct GuardRule {
  std::uint8_t participants = 0;  ///< inputs, bits; none: the rule is never true
  std::uint8_t compare = 0;       ///< what they have to be
  GuardAction action = GuardAction::nothing;

  [[nodiscard]] constexpr bool is_true(std::uint8_t inputs) const {
    return participants != 0 && ((inputs ^ compare) & participants) == 0;
  }

  friend bool operator==(const GuardRule&, const GuardRule&) = default;
};

/// Card by card.
template <typename T>
using PerGuardRule = std::array<T, kGuardRules>;

class CardGuards {
 public:
  /// Nothing has been looked at, and no rule has acted.
  void set_rules(const PerGuardRule<GuardRule>& rules);

  /// The strongest action of the rules that have become true since the last look.
  [[nodiscard]] GuardAction look(PortBits ports);

  /// How often each rule has acted since it was set up; wraps.
  [[nodiscard]] const PerGuardRule<std::uint8_t>& counts() const { return counts_; }

 private:
  PerGuardRule<GuardRule> rules_{};
  PerGuardRule<std::uint8_t> counts_{};
  std::uint32_t true_before_ = 0;  // bits
  PortBits ports_before_ = 0;
  bool looked_ = false;
};

}  // namespace cnc::hal::cpu5::firmware
