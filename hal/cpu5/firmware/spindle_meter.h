// The spindle's speed from its index pulses.
//
// The board's capture unit gives the number of pulses so far and the time of the last one, so the
// result does not depend on how often it is looked at. The period is the mean over at least kWindow
// (a tick of 0.1 us in 20 ms is 0.0005 %) and at least one revolution. When pulses fail to come, it
// grows with the time since the last.
#pragma once

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5::firmware {

class SpindleMeter {
 public:
  static constexpr Ticks kWindow = kTicksPerSecond / 50;
  /// Without a pulse for that long the spindle counts as standing: 20 rpm is the slowest measured.
  static constexpr Ticks kStandstill = 3 * kTicksPerSecond;

  void see(std::uint32_t pulses, Ticks last_pulse);

  /// Ticks per revolution; 0 when standing, or before the second pulse.
  [[nodiscard]] Ticks period(Ticks now) const;

 private:
  std::uint32_t pulses_ = 0;
  Ticks last_pulse_ = 0;
  Ticks period_ = 0;
  std::uint32_t window_pulses_ = 0;  // at the window's beginning
  Ticks window_begin_ = 0;
  bool turning_ = false;
};

}  // namespace cnc::hal::cpu5::firmware
