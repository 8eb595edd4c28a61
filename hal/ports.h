// The numbered digital inputs and outputs of the board and its I/O cards, as M54, M55 and M56 name
// them (manual 3.5.9): 1 … 16 are AUX1 … AUX16, 101 … 108 the ports of card 1, 201 … 208 of card 2,
// 301 … 308 of card 3.
#pragma once

#include <bitset>
#include <cstddef>
#include <optional>

namespace cnc::hal {

inline constexpr std::size_t kAuxCount = 16;
inline constexpr std::size_t kCardCount = 3;
inline constexpr std::size_t kCardPorts = 8;

/// One bit per port: AUX first, then card by card.
using Ports = std::bitset<kAuxCount + kCardCount * kCardPorts>;

/// The bit of a port's number; none if there is no such port.
[[nodiscard]] constexpr std::optional<std::size_t> port_bit(int number) {
  if (number < 1) return std::nullopt;
  const auto card = static_cast<std::size_t>(number) / 100;
  const auto port = static_cast<std::size_t>(number) % 100;
  if (card > kCardCount || port < 1 || port > (card == 0 ? kAuxCount : kCardPorts)) {
    return std::nullopt;
  }
  return card == 0 ? port - 1 : kAuxCount + (card - 1) * kCardPorts + port - 1;
}

/// The number of a port's bit.
[[nodiscard]] constexpr int port_number(std::size_t bit) {
  if (bit < kAuxCount) return static_cast<int>(bit) + 1;
  const std::size_t of_cards = bit - kAuxCount;
  return static_cast<int>(100 * (of_cards / kCardPorts + 1) + of_cards % kCardPorts + 1);
}

/// PWM1 … PWM8 and analog inputs 1 … 8, in arrays from 0.
inline constexpr std::size_t kPwmCount = 8;
inline constexpr std::size_t kAnalogCount = 8;

}  // namespace cnc::hal
