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

}  // namespace

Ports flickered(const ControllerStatus& before, const ControllerStatus& after,
                const std::array<config::GuardRule, config::kGuardRules>& rules) {
  Ports ports = after.inputs.ports;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (before.guard_counts[i] == after.guard_counts[i]) continue;
    const auto participants = static_cast<std::uint32_t>(rules[i].participants) & kCardMask;
    const auto compare = static_cast<std::uint32_t>(rules[i].compare);
    const auto is_true = [&](std::uint32_t inputs) {
      return participants != 0 && ((inputs ^ compare) & participants) == 0;
    };
    const CardInputs card(i);
    const bool was_true = is_true(card.of(before.inputs.ports));
    const bool now_true = is_true(card.of(after.inputs.ports));
    const std::uint32_t inputs = card.of(ports);
    if (now_true && was_true) {  // it was not for a moment
      card.put(inputs ^ (participants & (~participants + 1)), ports);
    } else if (!now_true) {  // it was for a moment
      card.put((inputs & ~participants) | (compare & participants), ports);
    }
  }
  return ports;
}

}  // namespace cnc::hal::trace
