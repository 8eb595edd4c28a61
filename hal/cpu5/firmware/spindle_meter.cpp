#include "hal/cpu5/firmware/spindle_meter.h"

namespace cnc::hal::cpu5::firmware {

void SpindleMeter::see(std::uint32_t pulses, Ticks last_pulse) {
  if (pulses == pulses_) return;
  const bool first = !turning_ || last_pulse - last_pulse_ > kStandstill;
  pulses_ = pulses;
  last_pulse_ = last_pulse;
  turning_ = true;
  if (first) {
    period_ = 0;
  } else {
    if (last_pulse - window_begin_ < kWindow) return;
    period_ = (last_pulse - window_begin_) / (pulses - window_pulses_);
  }
  window_pulses_ = pulses;
  window_begin_ = last_pulse;
}

Ticks SpindleMeter::period(Ticks now) const {
  const Ticks silence = now - last_pulse_;
  if (period_ == 0 || silence > kStandstill) return 0;
  return silence > period_ ? silence : period_;
}

}  // namespace cnc::hal::cpu5::firmware
