// The machine's configuration as the interpreter and the planner want it.
#pragma once

#include "config/machine_config.h"
#include "interpreter/interpreter.h"
#include "motion/compensation.h"
#include "motion/planner.h"

namespace cnc::server {

[[nodiscard]] inline interp::MachineFacts machine_facts(const config::MachineConfig& config) {
  interp::MachineFacts facts;
  for (const Axis axis : kAllAxes) {
    facts.negative_limit[axis] = config.axes[axis].negative_limit;
    facts.positive_limit[axis] = config.axes[axis].positive_limit;
    facts.home_position[axis] = config.axes[axis].home_position;
  }
  const config::ToolChangeArea& area = config.tool_change_area;
  facts.tool_change_area_low[Axis::X] = area.x_low;
  facts.tool_change_area_low[Axis::Y] = area.y_low;
  facts.tool_change_area_low[Axis::Z] = area.z_low;
  facts.tool_change_area_high[Axis::X] = area.x_high;
  facts.tool_change_area_high[Axis::Y] = area.y_high;
  facts.tool_change_area_high[Axis::Z] = area.z_high;
  const auto position = [](const config::HeadOffset& offset) {
    Position result;
    result[Axis::X] = offset.x;
    result[Axis::Y] = offset.y;
    result[Axis::Z] = offset.z;
    return result;
  };
  facts.head_offset = {Position{}, position(config.spindle_1), position(config.spindle_2),
                       position(config.probe), position(config.camera)};
  facts.max_speed.fill(config.spindle.max_speed);
  return facts;
}

[[nodiscard]] inline interp::InterpreterSettings interpreter_settings(
    const config::MachineConfig& config, const interp::Library& library = {}) {
  interp::InterpreterSettings settings;
  settings.library = library;
  settings.machine = machine_facts(config);
  settings.automatic_tool_change = config.job.auto_tool_change;
  settings.dialect = config.interpreter.dialect == config::ProgramDialect::pscnc
                         ? interp::DialectId::pscnc
                         : interp::DialectId::eding;
  settings.strict = config.interpreter.strict;
  settings.diameter_programming = config.interpreter.diameter_programming;
  settings.front_tool_post = config.interpreter.front_tool_post;
  settings.feed_at_tip = config.axes[Axis::A].mode == config::AxisMode::mill;
  settings.is_3d_printer = config.interpreter.is_3d_printer;
  settings.default_unit = config.unit == config::MachineUnit::inch ? interp::LengthUnit::inch
                                                                   : interp::LengthUnit::millimetre;
  settings.absolute_arc_centres = config.interpreter.absolute_arc_centres;
  settings.block_delete = config.interpreter.block_delete;
  return settings;
}

[[nodiscard]] inline motion::AxisLimits motor_limits(const config::MachineConfig& config) {
  motion::AxisLimits limits;
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& from = config.axes[axis];
    limits.max_velocity[axis] = from.connected() ? from.velocity : 0.0;
    limits.max_acceleration[axis] = from.connected() ? from.acceleration : 0.0;
    limits.max_jerk[axis] = from.connected() ? from.jerk : 0.0;
  }
  return limits;
}

[[nodiscard]] inline motion::CompensationSettings compensation_settings(
    const config::MachineConfig& config) {
  motion::CompensationSettings settings{.joint_limits = motor_limits(config),
                                        .backlash_share = config.trajectory.backlash_share,
                                        .longest_setpoint = config.trajectory.interpolation_time};
  for (const Axis motor : kAllAxes) {
    const config::AxisConfig& from = config.axes[motor];
    if (!from.connected()) continue;
    settings.motor_axes[motor] = config.moved_by(motor);
    settings.backlash[motor] = from.backlash;
    if (!from.pitch_table.empty()) settings.pitch[motor] = motion::PitchCurve(from.pitch_table);
  }
  return settings;
}

/// What plans may use of the axes, with `limits` as MotionFeed has them.
[[nodiscard]] inline motion::PlannerSettings planner_settings(const config::MachineConfig& config,
                                                              const motion::AxisLimits& limits) {
  return {.limits = limits,
          .max_setpoint_duration = config.trajectory.interpolation_time,
          .laf_angle = config.trajectory.laf_angle,
          .tolerance_use = config.trajectory.tolerance_use};
}

/// Without a height map.
[[nodiscard]] inline motion::AxisLimits axis_limits(const config::MachineConfig& config) {
  return motion::Compensation(compensation_settings(config)).machine_limits();
}
[[nodiscard]] inline motion::PlannerSettings planner_settings(const config::MachineConfig& config) {
  return planner_settings(config, axis_limits(config));
}

/// For a job whose setpoints wait in the board's FIFO and can be replaced there. More than link and
/// board hold together.
[[nodiscard]] inline motion::PlannerSettings job_planner_settings(
    const config::MachineConfig& config, const motion::AxisLimits& limits) {
  motion::PlannerSettings settings = planner_settings(config, limits);
  settings.most_taken_back = 8192;
  return settings;
}

}  // namespace cnc::server
