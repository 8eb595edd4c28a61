// A probe move (G38.2): straight at a feed until the probe trips, or to the end.
//
// The board catches the place and stops by itself, within the acceleration of the axes; here is the
// sequence around it: arm, move, take over where the machine stands, release. Executor thread only.
#pragma once

#include <cstdint>
#include <optional>

#include "config/machine_config.h"
#include "motion/planner.h"
#include "server/machine/motion_feed.h"

namespace cnc::server {

class ProbeMotion {
 public:
  ProbeMotion(const config::MachineConfig& config, MotionFeed& feed);

  /// From where the machine stands; `feed` in mm/s. Refused for a move that leaves the travel.
  Result<void> start(const Position& end, double feed);
  /// Brakes along the path and waits; resume() goes on.
  void hold() { planner_.hold(); }
  void resume() { planner_.resume(); }
  /// The motion was ended from outside (fault, stop at rest): forget it.
  void drop();

  void cycle();
  [[nodiscard]] bool active() const { return phase_ != Phase::idle; }
  /// Held and standing still.
  [[nodiscard]] bool standing() const;
  /// When no longer active: an error, or whether and where the probe tripped; where the move ended
  /// if it did not.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] bool tripped() const { return tripped_; }
  [[nodiscard]] const Position& position() const { return position_; }

 private:
  enum class Phase : std::uint8_t {
    idle,
    arming,  // until the board says that the latch is armed
    moving,
    disarming,  // the move is over: until the probe cannot trip any more
    stopping,   // the probe has tripped: until the board stands
    releasing,  // until the board takes segments again
  };

  void look_at_latch();
  void feed_motion();
  void release();
  void end(bool tripped, const Position& position);

  const config::MachineConfig& config_;
  MotionFeed& feed_;
  motion::Planner planner_;
  Phase phase_ = Phase::idle;
  bool tripped_ = false;
  Position position_;
  std::optional<Error> error_;
};

}  // namespace cnc::server
