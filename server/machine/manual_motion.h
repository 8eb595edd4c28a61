// Axes driven one by one: what jogging and homing have in common.
//
// The board always holds what it takes to stop along the path should it hear nothing any more
// (MotionFeed::lead()). An order does not wait until that has been driven: what the board has
// not begun is cut off and planned anew, and the order acts within 10 ms. Executor thread only.
#pragma once

#include <optional>

#include "config/machine_config.h"
#include "motion/jog.h"
#include "server/machine/motion_feed.h"

namespace cnc::server {

class ManualMotion {
 public:
  ManualMotion(const config::MachineConfig& config, MotionFeed& feed);

  /// From where the machine stands; the `limited` axes stay within their travel.
  void begin(const AxisArray<bool>& limited);
  /// The motion was ended from outside (fault): forget it.
  void drop();

  /// An axis moves on at this velocity until told otherwise.
  Result<void> set_velocity(Axis axis, double velocity);
  /// Counted from where the axis is going, or from where it is while it follows a velocity.
  Result<void> move_by(Axis axis, double distance, double speed);
  /// All axes brake.
  void stop();
  /// The orders given since act from the first segment on that can still be replaced. Where the
  /// board has begun them all, cycle() goes on behind them.
  void apply();

  /// Keeps the board supplied. An error: a setpoint failed its last check, and the motion has no
  /// end.
  Result<void> cycle();
  /// Every order has been carried out, and the machine stands.
  [[nodiscard]] bool at_rest() const { return planner_.standing() && feed_.at_rest(); }

 private:
  void cut(std::size_t count);
  void draw();
  [[nodiscard]] motion::JogPlanner planner_at_rest() const;

  const config::MachineConfig& config_;
  MotionFeed& feed_;
  motion::JogPlanner planner_;
  bool apply_wanted_ = false;  // once it is known what became of the cut under way
  std::optional<Error> error_;
};

}  // namespace cnc::server
