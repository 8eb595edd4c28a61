// The output of this room: one piece of motion, and the cubic in time that it stands for.
#pragma once

#include <algorithm>
#include <cstdint>

#include "config/axis.h"

namespace cnc::motion {

enum class MoveKind : std::uint8_t { rapid, feed };

/// Goes with a move through the planner and comes back with each of its setpoints.
struct MoveTag {
  std::uint64_t id = 0;    ///< ascending; chosen by the caller
  std::uint32_t line = 0;  ///< source line of the job, 0 if none
  /// Speed of the spindle that the move was planned for and follows, rpm; 0 = none.
  double spindle_speed = 0.0;
  bool begins_at_index = false;  ///< the move's first setpoint waits for the spindle's index
};

/// One piece of motion. Position is a cubic in time: together with the end of the setpoint before
/// it, end position and end velocity define it completely (Hermite), and velocity is continuous.
struct Setpoint {
  double duration = 0.0;    ///< s, > 0
  Position position;        ///< at the end of the setpoint
  Position velocity;        ///< at the end of the setpoint
  double feed_limit = 0.0;  ///< programmed feed, mm/s; 0 for a rapid
  MoveTag tag;
};

/// Motion of one move without its setpoints, for predictions.
struct Stretch {
  double duration = 0.0;
  MoveTag tag;
};

/// The cubic of one axis during a setpoint: from (p0, v0) to (p1, v1) in `duration` seconds.
struct AxisCubic {
  double p0;
  double v0;
  double p1;
  double v1;
  double duration;

  /// The acceleration of a cubic is linear in time, so these two are its extremes.
  [[nodiscard]] constexpr double start_acceleration() const {
    return (6.0 * (p1 - p0) / duration - 4.0 * v0 - 2.0 * v1) / duration;
  }
  [[nodiscard]] constexpr double end_acceleration() const {
    return (-6.0 * (p1 - p0) / duration + 2.0 * v0 + 4.0 * v1) / duration;
  }
  [[nodiscard]] constexpr double jerk() const {
    return (end_acceleration() - start_acceleration()) / duration;
  }
  [[nodiscard]] constexpr double position(double t) const {
    return p0 + t * (v0 + t * (start_acceleration() / 2.0 + t * jerk() / 6.0));
  }
  [[nodiscard]] constexpr double velocity(double t) const {
    return v0 + t * (start_acceleration() + t * jerk() / 2.0);
  }
  [[nodiscard]] constexpr double acceleration(double t) const {
    return start_acceleration() + t * jerk();
  }
  /// Largest |velocity| of the setpoint: at an end, or where the acceleration is zero.
  [[nodiscard]] constexpr double fastest() const {
    const double ends = std::max(v0 < 0.0 ? -v0 : v0, v1 < 0.0 ? -v1 : v1);
    const double turning = -start_acceleration() / jerk();
    if (!(turning > 0.0 && turning < duration)) return ends;  // also when the jerk is zero
    const double between = velocity(turning);
    return std::max(ends, between < 0.0 ? -between : between);
  }
};

/// The cubic of `axis` when `setpoint` follows a motion that ended in `position` with `velocity`.
[[nodiscard]] constexpr AxisCubic cubic_of(Axis axis, const Position& position,
                                           const Position& velocity, const Setpoint& setpoint) {
  return {position[axis], velocity[axis], setpoint.position[axis], setpoint.velocity[axis],
          setpoint.duration};
}

}  // namespace cnc::motion
