#include "hal/trace/card_flicker.h"

#include "hal/cpu5/driver/board_values.h"

namespace cnc::hal::trace {
namespace {

using cpu5::firmware::GuardRule;

/// The eight inputs of a rule's card, among all ports.
struct CardInputs {
  explicit CardInputs(std::size_t rule)
      : first(kAuxCount + rule / config::kRulesPerCard * kCardPorts) {}

  [[nodiscard]] std::uint8_t of(const Ports& ports) const {
    return static_cast<std::uint8_t>(ports.to_ullong() >> first);
  }
  void put(std::uint32_t inputs, Ports& ports) const {
    for (std::size_t i = 0; i < kCardPorts; ++i) ports[first + i] = (inputs >> i & 1U) != 0;
  }

  std::size_t first;
};

/// What the inputs of a rule were for a moment, and how often, for all of its actions.
struct Moments {
  [[nodiscard]] std::uint32_t inputs_for_a_moment(std::uint32_t inputs) const {
    return (inputs & ~changed) | (becomes & changed);
  }

  CardInputs card;
  std::uint32_t changed;  // inputs, bits
  std::uint32_t becomes;
  int times;
};

/// A rule acts when it becomes true. One that is true in the end was not for moments between: its
/// lowest input was the contrary. One that is not was true for moments.
Moments moments_of(std::size_t i, const GuardRule& rule, const ControllerStatus& before,
                   const ControllerStatus& after) {
  const CardInputs card(i);
  const std::uint32_t participants = rule.participants;
  const std::uint32_t compare = rule.compare;
  const bool was_true = rule.is_true(card.of(before.inputs.ports));
  const bool now_true = rule.is_true(card.of(after.inputs.ports));
  const int acted = static_cast<std::uint8_t>(after.guard_counts[i] - before.guard_counts[i]);
  const int explained = acted > 0 && now_true && !was_true ? 1 : 0;
  return {.card = card,
          .changed = now_true ? participants & (~participants + 1) : participants,
          .becomes = now_true ? ~compare : compare,
          .times = acted - explained};
}

}  // namespace

std::vector<Ports> flickers(const ControllerStatus& before, const ControllerStatus& after,
                            const std::array<config::GuardRule, config::kGuardRules>& rules) {
  const auto board_rules = cpu5::to_board(rules);
  std::vector<Ports> moments;
  for (std::size_t i = 0; i < board_rules.size(); ++i) {
    const Moments rule = moments_of(i, board_rules[i], before, after);
    for (std::size_t k = 0; k < static_cast<std::size_t>(rule.times); ++k) {
      if (k == moments.size()) moments.push_back(after.inputs.ports);
      rule.card.put(rule.inputs_for_a_moment(rule.card.of(moments[k])), moments[k]);
    }
  }
  return moments;
}

}  // namespace cnc::hal::trace
