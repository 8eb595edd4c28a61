// Spindle, coolant and drives: what is wanted of them, and the outputs that follow from it.
//
// Outputs are sent when they change. Executor thread only.
#pragma once

#include "config/machine_config.h"
#include "interpreter/canonical.h"
#include "server/machine/motion_feed.h"

namespace cnc::server {

class MachineIo {
 public:
  MachineIo(const config::MachineConfig& config, MotionFeed& feed)
      : spindle_config_(config.spindle), feed_(feed) {}

  void enable_drives(bool on);
  void turn_spindle(interp::SpindleDirection direction);
  void set_spindle_speed(double rpm);
  void set_speed_override(double factor);
  void set_coolant(bool mist, bool flood);
  /// Spindle and coolant off: end of program, stop, fault.
  void all_off();
  /// The board switched everything off by itself; remember it without sending.
  void board_is_off();

  [[nodiscard]] interp::SpindleDirection spindle() const { return direction_; }
  [[nodiscard]] double spindle_speed() const { return speed_; }
  [[nodiscard]] const hal::Outputs& outputs() const { return outputs_; }

 private:
  void apply();

  const config::SpindleConfig& spindle_config_;
  MotionFeed& feed_;
  interp::SpindleDirection direction_ = interp::SpindleDirection::off;
  double speed_ = 0.0;  // programmed, rpm
  double override_ = 1.0;
  bool mist_ = false;
  bool flood_ = false;
  bool drives_ = false;
  hal::Outputs outputs_;
};

}  // namespace cnc::server
