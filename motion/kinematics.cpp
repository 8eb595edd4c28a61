#include "motion/kinematics.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

Position Kinematics::joints_at(const Position& machine) const {
  Position joints = joint_velocity(machine);
  return joints += skew_;
}

Position Kinematics::joint_velocity(const Position& machine_velocity) const {
  Position joints;
  for (const Axis joint : kAllAxes) joints[joint] = machine_velocity[axes_[joint]];
  return joints;
}

Position Kinematics::machine_at(const Position& joints) const {
  Position machine;
  for (const Axis axis : kAllAxes) machine[axis] = is_slave(axis) ? 0.0 : joints[axis];
  return machine;
}

AxisLimits Kinematics::machine_limits(const AxisLimits& joints) const {
  AxisLimits limits = joints;
  for (const Axis joint : kAllAxes) {
    if (!is_slave(joint)) continue;
    const Axis master = axes_[joint];
    limits.max_velocity[joint] = limits.max_acceleration[joint] = limits.max_jerk[joint] = 0.0;
    limits.max_velocity[master] = std::min(limits.max_velocity[master], joints.max_velocity[joint]);
    limits.max_acceleration[master] =
        std::min(limits.max_acceleration[master], joints.max_acceleration[joint]);
    double& jerk = limits.max_jerk[master];
    if (const double own = joints.max_jerk[joint]; own > 0.0) {
      jerk = jerk > 0.0 ? std::min(jerk, own) : own;
    }
  }
  return limits;
}

void Kinematics::accept(const Position& joints, const Position& tolerance) {
  for (const Axis joint : kAllAxes) {
    const double skew = joints[joint] - joints[axes_[joint]];
    if (std::abs(skew - skew_[joint]) > tolerance[joint]) skew_[joint] = skew;
  }
}

}  // namespace cnc::motion
