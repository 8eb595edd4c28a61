// An electrical contact between something mechanical and an input: it bounces after each edge, and
// it can get stuck. Same seed, same bounces.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::sim {

class Contact {
 public:
  using Ticks = cpu5::firmware::Ticks;

  /// `bounce`: for so long after an edge the contact flickers. The edge itself is seen at once.
  Contact(Ticks bounce, std::uint64_t seed) : bounce_(bounce), seed_(seed) {}

  /// Stuck open or closed; unset: free again.
  void stick(std::optional<bool> state) { stuck_ = state; }

  /// Open, and it would still be without being read.
  [[nodiscard]] bool is_asleep(Ticks now) const {
    return !closed_ && !stuck_ && now - edge_ >= bounce_;
  }
  /// What the input sees at `now`, which never goes back.
  [[nodiscard]] bool read(bool closed, Ticks now) {
    if (stuck_) closed = *stuck_;
    if (closed != closed_) {
      closed_ = closed;
      edge_ = now;
      ++edges_;
    }
    const Ticks since = now - edge_;
    if (edges_ == 0 || since >= bounce_ || since < kFlicker) return closed;
    return (noise(since / kFlicker) & 1U) != 0;
  }

 private:
  static constexpr Ticks kFlicker = cpu5::firmware::kTicksPerSecond / 10'000;

  // SplitMix64's finalizer (G. Steele et al., OOPSLA 2014): neighbouring numbers in, noise out.
  [[nodiscard]] std::uint64_t noise(Ticks flicker) const {
    std::uint64_t z =
        seed_ + 0x9e3779b97f4a7c15U * (edges_ << 20U ^ static_cast<std::uint64_t>(flicker));
    z = (z ^ z >> 30U) * 0xbf58476d1ce4e5b9U;
    z = (z ^ z >> 27U) * 0x94d049bb133111ebU;
    return z ^ z >> 31U;
  }

  Ticks bounce_;
  std::uint64_t seed_;
  std::optional<bool> stuck_{};
  bool closed_ = false;
  Ticks edge_ = 0;
  std::uint64_t edges_ = 0;
};

}  // namespace cnc::hal::sim
