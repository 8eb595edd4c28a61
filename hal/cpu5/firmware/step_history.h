// The last steps, each with its tick: for what a capture unit has timed by itself. The core hears
// of the spindle's index up to two slices later, and by then the axes are elsewhere.
#pragma once

#include <limits>

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5::firmware {

/// Belongs to the step interrupt.
class StepHistory {
 public:
  /// Two slices with six axes at 400 kHz make 480.
  static constexpr std::uint32_t kSteps = 512;
  static_assert((kSteps & (kSteps - 1)) == 0, "the number of steps made goes round");

  StepHistory() { moments_.fill(std::numeric_limits<Ticks>::min()); }

  /// `when` never goes back from step to step.
  void note(std::size_t axis, int direction, Ticks when) {
    const std::uint32_t place = noted_++ % kSteps;
    moments_[place] = when;
    axes_[place] = static_cast<std::uint8_t>(axis);
    directions_[place] = static_cast<std::int8_t>(direction);
  }

  /// What the counts, `counts` by now, were at `moment`, behind the steps of that very tick. Before
  /// the oldest step that is known: what they were before that one.
  [[nodiscard]] PerAxis<std::int64_t> counts_at(Ticks moment, PerAxis<std::int64_t> counts) const {
    for (std::uint32_t back = 1; back <= kSteps; ++back) {
      const std::uint32_t place = (noted_ - back) % kSteps;
      if (moments_[place] <= moment) break;
      counts[axes_[place]] -= directions_[place];
    }
    return counts;
  }

 private:
  std::array<Ticks, kSteps> moments_;
  std::array<std::uint8_t, kSteps> axes_{};
  std::array<std::int8_t, kSteps> directions_{};
  std::uint32_t noted_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
