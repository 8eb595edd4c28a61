// The machine's configuration as the interpreter and the planner want it.
#pragma once

#include "config/machine_config.h"
#include "interpreter/interpreter.h"
#include "motion/planner.h"

namespace cnc::server {

[[nodiscard]] inline interp::InterpreterSettings interpreter_settings(
    const config::MachineConfig& config) {
  interp::InterpreterSettings settings;
  settings.default_unit = config.unit == config::MachineUnit::inch ? interp::LengthUnit::inch
                                                                   : interp::LengthUnit::millimetre;
  settings.absolute_arc_centres = config.interpreter.absolute_arc_centres;
  settings.block_delete = config.interpreter.block_delete;
  return settings;
}

[[nodiscard]] inline motion::AxisLimits axis_limits(const config::MachineConfig& config) {
  motion::AxisLimits limits;
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& from = config.axes[axis];
    limits.max_velocity[axis] = from.connected() ? from.velocity : 0.0;
    limits.max_acceleration[axis] = from.connected() ? from.acceleration : 0.0;
  }
  return limits;
}

[[nodiscard]] inline motion::PlannerSettings planner_settings(const config::MachineConfig& config) {
  return {axis_limits(config), config.trajectory.interpolation_time, config.trajectory.laf_angle};
}

}  // namespace cnc::server
