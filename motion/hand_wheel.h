// A hand wheel on an axis: what turning it orders of the manual motion (MAN-3, manual "Hand wheel
// Setup").
//
// In position mode every count is a distance, and the axis goes there as fast as it may, also when
// the wheel was quicker. Counts beyond the end of the travel are kept: the wheel has to be turned
// back by them before the axis leaves the end. In velocity mode the axis moves as fast as the wheel
// turns and stops when it stops; counts that the axis could not follow are forgotten.
//
// No thread, no clock: whoever reads the counter calls follow().
#pragma once

#include <cstdint>

#include "motion/jog.h"

namespace cnc::motion {

enum class HandWheelMode : std::uint8_t { velocity, position };

struct HandWheelSettings {
  HandWheelMode mode = HandWheelMode::velocity;
  double way_per_count = 0.0;  ///< mm or degrees, signed: the wheel's x0.1 … x100
  double speed = 0.0;          ///< at most, per second
};

class HandWheel {
 public:
  /// From now on: the wheel counts `count`, the axis is at `position`. Begin anew after a stop.
  HandWheel(Axis axis, const HandWheelSettings& settings, std::int32_t count, double position);

  /// The wheel's counter (it wraps) at time `now`, s; to be called every few milliseconds.
  Result<void> follow(JogPlanner& jog, std::int32_t count, double now);

 private:
  Result<void> follow_position(JogPlanner& jog, std::int32_t turned);
  Result<void> follow_velocity(JogPlanner& jog, std::int32_t turned, double now);

  Axis axis_;
  HandWheelSettings settings_;
  std::int32_t count_;
  double origin_;
  std::int64_t turned_ = 0;  // in position mode since the beginning, else in the present window
  double window_began_ = 0.0;
  bool window_open_ = false;
};

}  // namespace cnc::motion
