// The core's time from one free-running counter, and the alarm for the next step.
#pragma once

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5::target {

class BoardClock {
 public:
  using Ticks = firmware::Ticks;

  void start();
  /// Ticks since start(). From the step interrupt only, at least every 85 s: the counter wraps.
  Ticks now();
  /// The step interrupt at `when`, or as soon as possible; `now` is what now() said last. Not while
  /// another alarm is set.
  void set_alarm(Ticks when, Ticks now);
  void take_alarm();

  /// Of the counter, for measuring; 25 MHz, counts up.
  [[nodiscard]] static std::uint32_t count();

 private:
  std::uint32_t last_count_ = 0;
  std::uint32_t fifths_ = 0;  // of a tick, that are not in ticks_ yet
  Ticks ticks_ = 0;
};

}  // namespace cnc::hal::cpu5::target
