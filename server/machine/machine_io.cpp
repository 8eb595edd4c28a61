#include "server/machine/machine_io.h"

#include <algorithm>

namespace cnc::server {

using interp::SpindleDirection;

void MachineIo::enable_drives(bool on) {
  drives_ = on;
  apply();
}

void MachineIo::turn_spindle(SpindleDirection direction) {
  direction_ = direction;
  apply();
}

void MachineIo::set_spindle_speed(double rpm) {
  speed_ = rpm;
  apply();
}

void MachineIo::set_speed_override(double factor) {
  override_ = factor;
  apply();
}

void MachineIo::set_coolant(bool mist, bool flood) {
  mist_ = mist;
  flood_ = flood;
  apply();
}

void MachineIo::all_off() {
  direction_ = SpindleDirection::off;
  mist_ = flood_ = false;
  apply();
}

void MachineIo::board_is_off() {
  direction_ = SpindleDirection::off;
  mist_ = flood_ = drives_ = false;
  outputs_ = {};
}

/// S0 leaves the spindle still even after M3 (manual 3.5.2); any other speed is kept within what
/// the spindle can do.
void MachineIo::apply() {
  hal::Outputs wanted;
  wanted.drives_enabled = drives_;
  wanted.mist = mist_;
  wanted.flood = flood_;
  const double speed = speed_ * override_;
  if (direction_ != SpindleDirection::off && speed > 0.0) {
    const double real = std::clamp(speed, spindle_config_.min_speed, spindle_config_.max_speed);
    wanted.spindle_on = true;
    wanted.tool_direction = direction_ == SpindleDirection::clockwise;
    wanted.spindle_pwm = real / spindle_config_.max_speed;
  }
  if (wanted == outputs_) return;
  outputs_ = wanted;
  feed_.send(SetOutputs{wanted});
}

}  // namespace cnc::server
