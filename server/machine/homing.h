// Homing of one axis after the other (HOM-1, HOM-2; Eding manual 2.10).
//
// An axis with home velocity 0 is homed by hand: where it stands is its home position. Otherwise it
// moves to its switch, stops, moves back, and the position at the very step at which the switch
// releases, latched by the board, becomes its home position. Executor thread only.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "config/machine_config.h"
#include "server/machine/manual_motion.h"

namespace cnc::server {

class Homing {
 public:
  Homing(const config::MachineConfig& config, MotionFeed& feed);

  void start(std::vector<Axis> axes);
  /// Brakes; the axis under way is not homed. finished() when at rest.
  void stop();
  /// The motion was ended from outside (fault): forget it.
  void drop();

  /// The axis that has just been homed, if any.
  [[nodiscard]] std::optional<Axis> cycle();
  [[nodiscard]] bool active() const { return phase_ != Phase::idle; }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  /// Order of a machine that says nothing else: Z first, to get the tool out of the way.
  [[nodiscard]] static std::vector<Axis> default_order(const config::MachineConfig& config);

 private:
  enum class Phase : std::uint8_t {
    idle,
    next_axis,
    to_switch,   // towards the switch until it activates
    at_switch,   // braking behind it
    arming,      // until the board has the latch armed: what it caught before must not count
    off_switch,  // back until it releases
    released,    // braking; then the latch is read
    counting,    // until the board counts from the new position: a fault may still come first
    stopping,    // ended by stop() or an error
  };

  [[nodiscard]] std::optional<Axis> advance();
  void begin_axis();
  void move(double velocity, double reach);
  void brake_into(Phase next);
  void take_latch();
  void set_position(double position);
  void fail(ErrorCode code, std::string_view what);
  [[nodiscard]] Axis axis() const { return axes_.front(); }
  [[nodiscard]] const config::AxisConfig& axis_config() const { return config_.axes[axis()]; }

  const config::MachineConfig& config_;
  MotionFeed& feed_;
  ManualMotion motion_;
  Phase phase_ = Phase::idle;
  std::vector<Axis> axes_;
  std::optional<Error> error_;
};

}  // namespace cnc::server
