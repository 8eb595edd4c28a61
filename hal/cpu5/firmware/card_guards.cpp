#include "hal/cpu5/firmware/card_guards.h"

namespace cnc::hal::cpu5::firmware {

void CardGuards::set_rules(const PerGuardRule<GuardRule>& rules) {
  rules_ = rules;
  counts_ = {};
  true_before_ = 0;
  looked_ = false;
}

GuardAction CardGuards::look(PortBits ports) {
  GuardAction strongest = GuardAction::nothing;
  if (looked_ && ports == ports_before_) return strongest;
  looked_ = true;
  ports_before_ = ports;
  std::uint32_t true_now = 0;
  for (std::size_t i = 0; i < kGuardRules; ++i) {
    const std::size_t first_port = kFirstCardPort + i / kRulesPerCard * kCardInputs;
    const GuardRule& rule = rules_[i];
    if (!rule.is_true(static_cast<std::uint8_t>(ports >> first_port))) continue;
    const std::uint32_t bit = std::uint32_t{1} << i;
    true_now |= bit;
    if ((true_before_ & bit) != 0 || rule.action == GuardAction::nothing) continue;
    ++counts_[i];
    if (rule.action > strongest) strongest = rule.action;
  }
  true_before_ = true_now;
  return strongest;
}

}  // namespace cnc::hal::cpu5::firmware
