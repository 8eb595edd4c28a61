// Manual motion: each axis for itself, at a velocity that may change at any moment or to a
// position.
//
// Time is divided into equal ticks with one acceleration, or one jerk, each (axis_ramp.h), so that
// a setpoint per tick is exact and an axis stops exactly where it should, without a last crumb of
// motion. Jogging with
// keys and hand wheel, step jog and the moves of homing are all driven with it. No thread, no
// clock: whoever draws setpoints gives the time. next() does not allocate.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "config/axis.h"
#include "config/error.h"
#include "motion/limits.h"
#include "motion/setpoint.h"

namespace cnc::motion {

/// Where an axis may be; infinite without soft limits.
struct TravelRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

class JogPlanner {
 public:
  /// `tick`: duration of each setpoint, s; 0.0005 … 0.1.
  JogPlanner(const AxisLimits& limits, double tick, const Position& start);

  /// Soft limits; an axis stops exactly at them. Outside already, it can only move back inside.
  void set_travel(Axis axis, const TravelRange& travel);

  /// Moves on at `velocity` (signed, per second) until told otherwise; 0 stops. Faster than the
  /// axis' limit is brought down to it. Refused: not a number, or an axis without limits.
  Result<void> set_velocity(Axis axis, double velocity);

  /// To a position, at `speed` (> 0) at most; brought inside the travel. From any state of motion.
  Result<void> move_to(Axis axis, double position, double speed);
  /// As much further as `distance`; counted from the target when it has one.
  Result<void> move_by(Axis axis, double distance, double speed);

  /// All axes brake to a standstill.
  void stop();

  /// The ticks that led on from here are void, orders stay, also those that such a tick had carried
  /// out: the next tick begins in the state that an earlier one has ended with.
  void go_back(const Position& position, const Position& velocity, const Position& acceleration);

  /// The next tick; nothing when every axis stands where it should.
  [[nodiscard]] std::optional<Setpoint> next();

  [[nodiscard]] bool standing() const;
  /// It was told a velocity, not a position to go to.
  [[nodiscard]] bool follows_velocity(Axis axis) const {
    return orders_[axis].velocity != 0.0 && !orders_[axis].target;
  }
  [[nodiscard]] const Position& position() const { return position_; }
  [[nodiscard]] const Position& velocity() const { return velocity_; }

  /// Standing still only: the machine was moved or its position was set by other means. Drops all
  /// targets.
  bool set_position(const Position& position);

 private:
  /// What an axis was told: a velocity, or the position to go to and the speed on the way. It keeps
  /// a position at which it has arrived.
  struct Order {
    double velocity = 0.0;
    std::optional<double> target;
  };

  [[nodiscard]] Result<void> check(Axis axis, double value, double speed) const;
  void advance(Axis axis);

  AxisLimits limits_;
  double tick_;
  AxisArray<TravelRange> travel_;
  AxisArray<Order> orders_;
  Position position_;
  Position velocity_;
  Position acceleration_;  ///< of axes with a limit of jerk
};

}  // namespace cnc::motion
