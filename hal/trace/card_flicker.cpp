#include "hal/trace/card_flicker.h"

namespace cnc::hal::trace {
namespace {

constexpr std::uint32_t kCardMask = (1U << kCardPorts) - 1;

/// The eight inputs of a rule's card, among all ports.
struct CardInputs {
  explicit CardInputs(std::size_t rule)
      : first(kAuxCount + rule / config::kRulesPerCard * kCardPorts) {}

  [[nodiscard]] std::uint32_t of(const Ports& ports) const {
    return static_cast<std::uint32_t>(ports.to_ullong() >> first) & kCardMask;
  }
  void put(std::uint32_t inputs, Ports& ports) const {
    for (std::size_t i = 0; i < kCardPorts; ++i) ports[first + i] = (inputs >> i & 1U) != 0;
  }

  std::size_t first;
};

/// A rule that has acted, and how often no status explains it.
struct Unseen {
  [[nodiscard]] std::uint32_t inputs_for_a_moment(std::uint32_t inputs) const {
    return (inputs & ~changed) | (becomes & changed);
  }

  CardInputs card;
  std::uint32_t changed;  // inputs, bits
  std::uint32_t becomes;
  int times;
};

/// An action begins where the rule becomes true. One that is true in the end was not for a moment:
/// its lowest input was the contrary. One that is not was so for a moment.
Unseen unseen_of(std::size_t i, const config::GuardRule& rule, const ControllerStatus& before,
                 const ControllerStatus& after) {
  const CardInputs card(i);
  const auto participants = static_cast<std::uint32_t>(rule.participants) & kCardMask;
  const auto compare = static_cast<std::uint32_t>(rule.compare);
  const auto is_true = [&](const ControllerStatus& status) {
    return participants != 0 && ((card.of(status.inputs.ports) ^ compare) & participants) == 0;
  };
  const bool now_true = is_true(after);
  const int acted = static_cast<std::uint8_t>(after.guard_counts[i] - before.guard_counts[i]);
  const int explained = acted > 0 && now_true && !is_true(before) ? 1 : 0;
  return {.card = card,
          .changed = now_true ? participants & (~participants + 1) : participants,
          .becomes = now_true ? ~compare : compare,
          .times = acted - explained};
}

}  // namespace

std::vector<Ports> flickers(const ControllerStatus& before, const ControllerStatus& after,
                            const std::array<config::GuardRule, config::kGuardRules>& rules) {
  std::vector<Ports> moments;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const Unseen rule = unseen_of(i, rules[i], before, after);
    for (std::size_t k = 0; k < static_cast<std::size_t>(rule.times); ++k) {
      if (k == moments.size()) moments.push_back(after.inputs.ports);
      rule.card.put(rule.inputs_for_a_moment(rule.card.of(moments[k])), moments[k]);
    }
  }
  return moments;
}

}  // namespace cnc::hal::trace
