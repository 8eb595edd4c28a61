// The operator's overrides of speed.
#pragma once

#include <cstdint>

namespace cnc::motion {

/// Which of them acts on a move: on a feed per revolution (G95) also that of the spindle; none on
/// threads and taps, whose feed is their pitch.
enum class Override : std::uint8_t { feed, rapid, feed_per_turn, none };

/// As factors.
struct Overrides {
  double feed = 1.0;
  double rapid = 1.0;
  double speed = 1.0;  ///< of the spindle

  [[nodiscard]] double of(Override which) const {
    switch (which) {
      case Override::feed:
        return feed;
      case Override::rapid:
        return rapid;
      case Override::feed_per_turn:
        return feed * speed;
      case Override::none:
        break;
    }
    return 1.0;
  }
  bool operator==(const Overrides&) const = default;
};

}  // namespace cnc::motion
