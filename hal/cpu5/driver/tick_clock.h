// Durations in seconds to whole ticks, so that the total time keeps.
//
// What rounding adds or takes from one segment is given back in the next, at most one part in 256
// of its duration: more would show in its velocity. From 12.8 us up that covers the half tick that
// rounding can leave, and the sum of all ticks then stays within half a tick of the sum of all
// seconds. Segments that are too short for the board are stretched and paid back later.
#pragma once

#include <algorithm>
#include <cmath>

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5 {

class TickClock {
 public:
  /// Ticks for a segment of `duration` seconds; 0, which the board refuses, if it is not more than
  /// 0 or too long.
  [[nodiscard]] std::uint32_t ticks_for(double duration) {
    constexpr double kRepaidPart = 1.0 / 256.0;
    const double exact = duration * double{firmware::kTicksPerSecond};
    if (!(exact > 0.0 && exact <= double{firmware::kMaxSegmentTicks})) return 0;
    const double repaid = std::clamp(owed_, -exact * kRepaidPart, exact * kRepaidPart);
    const double ticks = std::clamp(std::round(exact + repaid), double{firmware::kMinSegmentTicks},
                                    double{firmware::kMaxSegmentTicks});
    owed_ += exact - ticks;
    return static_cast<std::uint32_t>(ticks);
  }

  void reset() { owed_ = 0.0; }

 private:
  double owed_ = 0.0;  // ticks that the segments so far should have been longer
};

}  // namespace cnc::hal::cpu5
