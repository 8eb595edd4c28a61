// From the machine's axes to its motors, the joints, and back.
//
// Everything that plans speaks of axes; everything that counts steps speaks of joints. This is the
// one place that knows both, so that planner and machine stay as they are when a machine with other
// kinematics comes. Here every motor moves one axis in proportion: its own or, as a slave, that of
// its master (a gantry with a motor on either side).
//
// A slave stands beside its master by its skew, which is kept: connecting to a machine or losing a
// position never moves one motor of a gantry against the other.
#pragma once

#include "config/axis.h"
#include "motion/limits.h"

namespace cnc::motion {

/// The axis that each motor moves.
using MotorAxes = AxisArray<Axis>;
inline constexpr MotorAxes kOwnAxes{kAllAxes};

class Kinematics {
 public:
  Kinematics() = default;
  /// A master moves its own axis.
  explicit Kinematics(const MotorAxes& axes) : axes_(axes) {}

  [[nodiscard]] bool is_slave(Axis joint) const { return axes_[joint] != joint; }
  [[nodiscard]] Axis axis_of(Axis joint) const { return axes_[joint]; }

  /// Inverse kinematics. The axis that a slave's letter names does not exist: its value is unused.
  [[nodiscard]] Position joints_at(const Position& machine) const;
  [[nodiscard]] Position joint_velocity(const Position& machine_velocity) const;
  /// Forward kinematics; 0 for the axis of a slave's letter.
  [[nodiscard]] Position machine_at(const Position& joints) const;

  /// What the axes may do so that no motor exceeds its limits: of several the slowest counts.
  [[nodiscard]] AxisLimits machine_limits(const AxisLimits& joints) const;

  /// The motors stand here: a slave that is further off than `tolerance` keeps its place from now
  /// on. Less is what steps of another length leave when both stop.
  void accept(const Position& joints, const Position& tolerance);
  [[nodiscard]] double skew(Axis joint) const { return skew_[joint]; }

 private:
  MotorAxes axes_ = kOwnAxes;
  Position skew_;
};

}  // namespace cnc::motion
