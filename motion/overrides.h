// The operator's overrides of speed.
#pragma once

#include <cstdint>

namespace cnc::motion {

/// Which of them acts on a move; none on threads and taps, whose feed is their pitch.
enum class Override : std::uint8_t { feed, rapid, none };

/// As factors.
struct Overrides {
  double feed = 1.0;
  double rapid = 1.0;

  [[nodiscard]] double of(Override which) const {
    if (which == Override::none) return 1.0;
    return which == Override::feed ? feed : rapid;
  }
  bool operator==(const Overrides&) const = default;
};

}  // namespace cnc::motion
