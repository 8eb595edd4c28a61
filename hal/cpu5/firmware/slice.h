// A slice of the path: its steps within at most 100 us, found before their time has come, each with
// the tick at which it is due. Whoever plays it needs no more than comparisons and additions.
#pragma once

#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5::firmware {

inline constexpr Ticks kSliceTicks = 1000;
/// 50 steps at kTopVelocity, one more for where they begin, one for the rounding of both ends.
inline constexpr std::size_t kMostSteps = kAxisCount * 52;

/// Where on its path the board is.
struct PathPlace {
  std::uint32_t id = 0;        ///< of the segment; 0 = none yet
  std::uint32_t duration = 0;  ///< of the segment
  PathTime elapsed = 0;        ///< of the segment
};

struct TimedStep {
  std::uint16_t offset;  ///< ticks after the slice's beginning
  std::uint8_t axis;
  std::int8_t direction;  ///< +1 or -1
};

struct Slice {
  Ticks begin = 0;
  Ticks length = 0;  ///< 0 … kSliceTicks
  PathPlace from{};
  PathPlace to{};
  TimeScale scale = kFullScale;  ///< mean of the slice
  OutputChange change{};         ///< at its beginning
  bool goes_on = false;          ///< the axes move at its end: the next slice has to be there
  std::uint32_t step_count = 0;
  std::array<TimedStep, kMostSteps> steps;  ///< the first step_count, in the order of time

  [[nodiscard]] Ticks end() const { return begin + length; }
};

}  // namespace cnc::hal::cpu5::firmware
