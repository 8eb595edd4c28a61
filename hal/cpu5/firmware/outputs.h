// What the board switches, and changes of some of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cnc::hal::cpu5::firmware {

/// Digital ports, one bit each: AUX1 … AUX16, then eight of each of three I/O cards.
using PortBits = std::uint64_t;
inline constexpr std::size_t kPortCount = 40;
inline constexpr std::size_t kPwmCount = 8;

struct Outputs {
  static constexpr std::uint32_t kFullPwm = 1U << 16;

  bool drives_enabled = false;
  bool spindle_on = false;
  bool tool_direction = false;
  std::uint32_t spindle_pwm = 0;  ///< 0 … kFullPwm
  bool mist = false;
  bool flood = false;
  PortBits ports = 0;
  std::array<std::uint32_t, kPwmCount> pwm{};  ///< 0 … kFullPwm

  friend bool operator==(const Outputs&, const Outputs&) = default;
};

/// What a program switches while it moves; all other outputs stay as they are. Small, because every
/// segment in the FIFO has room for one.
struct OutputChange {
  // Bits of `changed`, and but for the last of `on`.
  static constexpr std::uint8_t kSpindleOn = 1 << 0;
  static constexpr std::uint8_t kToolDirection = 1 << 1;
  static constexpr std::uint8_t kMist = 1 << 2;
  static constexpr std::uint8_t kFlood = 1 << 3;
  static constexpr std::uint8_t kSpindlePwm = 1 << 4;

  std::uint8_t changed = 0;
  std::uint8_t on = 0;
  std::uint8_t port = 0;  ///< 1 … kPortCount; 0: none
  bool port_on = false;
  std::uint8_t pwm = 0;  ///< 1 … kPwmCount; 0: none
  std::uint32_t spindle_pwm = 0;
  std::uint32_t pwm_value = 0;

  [[nodiscard]] bool empty() const { return changed == 0 && port == 0 && pwm == 0; }

  friend bool operator==(const OutputChange&, const OutputChange&) = default;
};

void apply(const OutputChange& change, Outputs& outputs);

}  // namespace cnc::hal::cpu5::firmware
