// Wires from digital outputs to the inputs of the same number, through relays: an input follows its
// output when that has not changed for the relay's delay. Shorter pulses do not get through.
#pragma once

#include <array>
#include <cstdint>

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::sim {

class LoopBack {
 public:
  using Ticks = cpu5::firmware::Ticks;

  explicit LoopBack(Ticks delay) : delay_(delay) {}

  void set_outputs(std::uint64_t outputs, Ticks now) {
    for (std::uint64_t bit = 0; bit < kBits; ++bit) {
      if ((((outputs ^ outputs_) >> bit) & 1U) != 0) changed_[bit] = now;
    }
    outputs_ = outputs;
  }

  [[nodiscard]] std::uint64_t inputs(Ticks now) {
    if (inputs_ == outputs_) return inputs_;
    for (std::uint64_t bit = 0; bit < kBits; ++bit) {
      const std::uint64_t mask = std::uint64_t{1} << bit;
      if (now - changed_[bit] >= delay_) inputs_ = (inputs_ & ~mask) | (outputs_ & mask);
    }
    return inputs_;
  }

 private:
  static constexpr std::uint64_t kBits = 64;

  Ticks delay_;
  std::uint64_t outputs_ = 0;
  std::uint64_t inputs_ = 0;
  std::array<Ticks, kBits> changed_{};  // when each output last changed
};

}  // namespace cnc::hal::sim
