// Spindle, coolant, drives and the general outputs: what is wanted of them, and the outputs that
// follow from it; and the inputs that programs read.
//
// Outputs are sent when they change, only what changes, and take effect at once. What belongs to an
// instant of a motion travels with its segment instead (change_for()); when the board has executed
// it, this class is told (switched()), together with the command itself. Should an operator's
// override, say, have been sent while it was under way, and be overtaken by it, it is sent again
// then. Executor thread only.
#pragma once

#include <array>
#include <optional>

#include "config/machine_config.h"
#include "interpreter/canonical.h"
#include "server/machine/motion_feed.h"

namespace cnc::server {

/// What a program and the operator have made of the spindle's speed, at a place of the path.
struct SpindleSpeed {
  std::optional<double> programmed;  ///< rpm; unset: it follows the tool (G96)
  double override = 1.0;
  bool override_enabled = true;

  [[nodiscard]] double factor() const { return override_enabled ? override : 1.0; }
};

class MachineIo {
 public:
  MachineIo(const config::MachineConfig& config, MotionFeed& feed)
      : spindle_config_(config.spindle), feed_(feed) {}

  void enable_drives(bool on);
  void turn_spindle(interp::SpindleDirection direction);
  void set_spindle_speed(double rpm);
  void set_speed_override(double factor);
  void set_coolant(bool mist, bool flood);

  /// What such a command will switch, with the spindle's speed as it is `then`, behind it, and by
  /// what is wanted now otherwise. Empty: nothing on the way.
  [[nodiscard]] hal::OutputChange change_for(const interp::CommandBody& command,
                                             const SpindleSpeed& then) const;
  /// Such a change is sent with the path; the ticket is for switched().
  [[nodiscard]] std::uint64_t sent_with_path();
  /// The board has made it.
  void switched(const hal::OutputChange& change, std::uint64_t ticket);
  /// Sends again what may have come in the wrong order, as it has to be now.
  void correct();

  /// AUX and card outputs by the manual's numbers (hal/ports.h); PWM 1 … 8, `value` 0 … 1.
  Result<void> set_output(std::int32_t port, bool on);
  Result<void> set_analog_output(std::int32_t port, double value);
  /// One of the spindle's outputs by itself, until the spindle is told something else.
  void set_spindle_output(interp::SpindleOutput output, bool on);
  /// 0 or 1, or 0 … 1 of an analog input; ports as ReadInput numbers them.
  [[nodiscard]] Result<double> read(const interp::ReadInput& input) const;
  /// Spindle and coolant off: end of program, stop, fault. Whatever the board was told on the way.
  void all_off();
  /// Sends all outputs as they are wanted: some may have been dropped with the path.
  void send_all();
  /// The board switched everything off by itself; remember it without sending.
  void board_is_off();
  /// A new session: everything is off, but drives stay as they were.
  void board_is_back(const hal::Outputs& outputs);

  [[nodiscard]] interp::SpindleDirection spindle() const { return direction_; }
  [[nodiscard]] double spindle_speed() const { return speed_; }
  [[nodiscard]] const hal::Outputs& outputs() const { return outputs_; }

 private:
  void apply();
  [[nodiscard]] hal::Outputs wanted() const;
  void apply_spindle(hal::Outputs& wanted, double speed) const;
  [[nodiscard]] double spindle_part(double speed) const;

  const config::SpindleConfig& spindle_config_;
  MotionFeed& feed_;
  interp::SpindleDirection direction_ = interp::SpindleDirection::off;
  double speed_ = 0.0;  // programmed, rpm
  double override_ = 1.0;
  bool mist_ = false;
  bool flood_ = false;
  bool drives_ = false;
  hal::Ports ports_;
  std::array<double, hal::kPwmCount> pwm_{};
  std::optional<bool> direction_output_;  // M84 M85
  std::optional<bool> pwm_output_;        // M86 M87
  hal::Outputs outputs_;                  // of the board when it has got everything
  std::uint64_t sends_ = 0;
  hal::OutputChange in_doubt_;  // for correct()
  bool path_switches_ = false;  // since all were sent: the board may be ahead of outputs_
};

}  // namespace cnc::server
