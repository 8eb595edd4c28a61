// What a board switches, as a whole and in part.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/ports.h"

namespace cnc::hal {

/// Every output of the board. A fault switches all of them off, the drives as the driver's settings
/// say.
struct Outputs {
  bool drives_enabled = false;
  bool spindle_on = false;      ///< a relay for the inverter's enable; the CPU5 itself has none
  bool tool_direction = false;  ///< TOOLDIR: M3 and M84 on, M4, M5 and M85 off
  double spindle_pwm = 0.0;     ///< 0 … 1: M3, M4 and M86; 0: M5 and M87
  bool mist = false;
  bool flood = false;
  Ports ports{};                        ///< AUX and I/O cards: M54, M55
  std::array<double, kPwmCount> pwm{};  ///< 0 … 1, [0] is PWM1: M54 E; heaters

  friend bool operator==(const Outputs&, const Outputs&) = default;
};

/// A change of some of them: what is unset stays as it is on the board. Drives are never changed on
/// the way.
struct OutputChange {
  struct Port {
    std::uint8_t bit = 0;  ///< of Ports
    bool on = false;

    friend bool operator==(const Port&, const Port&) = default;
  };
  struct Pwm {
    std::uint8_t channel = 0;  ///< 0 is PWM1
    double value = 0.0;        ///< 0 … 1

    friend bool operator==(const Pwm&, const Pwm&) = default;
  };

  std::optional<bool> spindle_on{};
  std::optional<bool> tool_direction{};
  std::optional<double> spindle_pwm{};  ///< 0 … 1
  std::optional<bool> mist{};
  std::optional<bool> flood{};
  std::optional<Port> port{};
  std::optional<Pwm> pwm{};

  [[nodiscard]] bool empty() const { return *this == OutputChange{}; }
  /// Whether both at one moment come to the same as one behind the other but for a value of PWM
  /// that would have been there between: nothing is switched to and fro, and there is room.
  [[nodiscard]] bool can_add(const OutputChange& later) const;
  /// Takes over what `later` changes.
  void add(const OutputChange& later);
  void apply_to(Outputs& outputs) const;

  friend bool operator==(const OutputChange&, const OutputChange&) = default;
};

/// What leads from one to the other; empty when they are the same. None when that takes more than a
/// change can hold.
[[nodiscard]] std::optional<OutputChange> change_between(const Outputs& before,
                                                         const Outputs& after);

}  // namespace cnc::hal
