#include "config/config_checks.h"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "config/ramp.h"

namespace cnc::config {
namespace {

using Finding = std::optional<Error>;

/// "[AXIS_X] velocity = 100 mm/s"
std::string shown(const MachineConfig& config, std::string_view section, std::string_view key) {
  const Setting& setting = *find_setting(section, key);
  const auto unit = unit_text(setting.unit, config.unit);
  return fmt::format("{} = {}{}{}", setting.name(),
                     setting_text(setting, setting.value(config), config.unit),
                     unit.empty() ? "" : " ", unit);
}

std::string shown(const MachineConfig& config, Axis axis, std::string_view key) {
  return shown(config, axis_section(axis), key);
}

Finding check_port_unique(const MachineConfig& config, Axis axis) {
  for (const Axis other : kAllAxes) {
    if (other == axis) return std::nullopt;
    if (config.axes[other].port != config.axes[axis].port) continue;
    return Error{ErrorCode::config_port_used_twice,
                 fmt::format("{} is the port of axis {} already; each motor needs its own.",
                             shown(config, axis, "port"), axis_name(other)),
                 std::nullopt};
  }
  return std::nullopt;
}

Finding check_master(const MachineConfig& config, Axis axis) {
  const Axis master = config.moved_by(axis);
  if (master == axis || config.axes[master].connected()) return std::nullopt;
  return Error{ErrorCode::config_slave_without_master,
               fmt::format("{}, but axis {} has no motor of its own.", shown(config, axis, "mode"),
                           axis_name(master)),
               std::nullopt};
}

Finding check_steps(const MachineConfig& config, Axis axis) {
  if (config.axes[axis].steps_per_unit != 0.0) return std::nullopt;
  return Error{ErrorCode::config_steps_zero,
               fmt::format("{}: a connected axis needs a number other than 0.",
                           shown(config, axis, "stepsPerUnit")),
               std::nullopt};
}

Finding check_limits(const MachineConfig& config, Axis axis) {
  if (config.axes[axis].negative_limit < config.axes[axis].positive_limit) return std::nullopt;
  return Error{ErrorCode::config_limits_reversed,
               fmt::format("{} must be below {}.", shown(config, axis, "negativeLimit"),
                           shown(config, axis, "positiveLimit")),
               std::nullopt};
}

Finding check_home_velocity(const MachineConfig& config, Axis axis) {
  if (std::abs(config.axes[axis].home_velocity) <= config.axes[axis].velocity) return std::nullopt;
  return Error{ErrorCode::config_home_velocity_too_high,
               fmt::format("{} must not exceed {} in either direction.",
                           shown(config, axis, "homeVelocity"), shown(config, axis, "velocity")),
               std::nullopt};
}

// Home switches may stand outside of the machine area, but not another whole machine away.
Finding check_home_position(const MachineConfig& config, Axis axis) {
  const AxisConfig& row = config.axes[axis];
  const double travel = row.positive_limit - row.negative_limit;
  const bool near = row.home_position >= row.negative_limit - travel &&
                    row.home_position <= row.positive_limit + travel;
  if (near || travel <= 0.0) return std::nullopt;
  return Error{
      ErrorCode::config_home_position_far,
      fmt::format("{} is further than the whole travel outside of {} and {}.",
                  shown(config, axis, "homePosition"), shown(config, axis, "negativeLimit"),
                  shown(config, axis, "positiveLimit")),
      std::nullopt};
}

/// s of motion that the board holds at the most: its FIFO has 1024 segments (hal/cpu5/PROTOCOL.md).
double motion_held(const MachineConfig& config) {
  return 1024.0 * config.trajectory.interpolation_time;
}

/// A board that hears nothing for hostTimeout stops along the motion that it holds. Where the plan
/// itself brakes an axis the board cannot do it any sooner, so that all of the ramp has to be there
/// before the silence begins. Where it ends too early the axis stops on the spot, and its position
/// is in doubt.
Finding check_way_to_brake(const MachineConfig& config, Axis axis) {
  constexpr double kRounding = 1e-9;
  const AxisConfig& row = config.axes[axis];
  const double braking = braking_time(row.velocity, row.acceleration, row.jerk);
  const double needed = config.connection.host_timeout + braking;
  const double held = motion_held(config);
  if (needed <= held + kRounding) return std::nullopt;
  return Error{
      ErrorCode::config_way_to_brake_short,
      fmt::format("{} and {}: a board that no longer hears the server would need {:.3f} s of "
                  "motion, {} s of silence and {:.3f} s to brake, and holds {:.3g} s, 1024 times "
                  "interpolationTime. It would stop at once, and the position be in doubt; the "
                  "acceleration or interpolationTime should be higher, or the velocity or "
                  "hostTimeout lower.",
                  shown(config, axis, "velocity"), shown(config, axis, "acceleration"), needed,
                  config.connection.host_timeout, braking, held),
      std::nullopt};
}

Finding check_step_frequency(const MachineConfig& config, Axis axis) {
  const AxisConfig& row = config.axes[axis];
  const double needed = row.velocity * std::abs(row.steps_per_unit);
  if (needed <= config.connection.max_step_frequency) return std::nullopt;
  return Error{ErrorCode::config_step_frequency_too_high,
               fmt::format("{} times {} needs {:.0f} steps per second, more than {}.",
                           shown(config, axis, "velocity"), shown(config, axis, "stepsPerUnit"),
                           std::ceil(needed), shown(config, "CONNECTION", "maxStepFrequency")),
               std::nullopt};
}

// Fewer than four segments ahead would run dry at the first late exchange.
Finding check_fifo_time(const MachineConfig& config, Axis) {
  constexpr double kFewestSegments = 4.0;
  const TrajectoryConfig& times = config.trajectory;
  if (times.fifo_time >= kFewestSegments * times.interpolation_time) return std::nullopt;
  return Error{
      ErrorCode::config_fifo_time_too_short,
      fmt::format("{} must be at least {} times {}.", shown(config, "TRAJECTORY", "fifoTime"),
                  kFewestSegments, shown(config, "TRAJECTORY", "interpolationTime")),
      std::nullopt};
}

/// A pulse and its pause, 1 % above the frequency as the board allows it.
Finding check_pulse_width(const MachineConfig& config, Axis) {
  const double period = 1e6 / (1.01 * config.connection.max_step_frequency);
  if (2.0 * config.connection.pulse_width <= period) return std::nullopt;
  return Error{ErrorCode::config_pulse_too_wide,
               fmt::format("{} does not fit into a period of {} twice; allowed is {:.2f} µs.",
                           shown(config, "CONNECTION", "pulseWidth"),
                           shown(config, "CONNECTION", "maxStepFrequency"),
                           std::floor(period * 50.0) / 100.0),
               std::nullopt};
}

Finding check_host_timeout(const MachineConfig& config, Axis) {
  if (config.connection.host_timeout < motion_held(config)) return std::nullopt;
  return Error{ErrorCode::config_host_timeout_too_long,
               fmt::format("{} must be less than {:.3g} s, 1024 times {}: what the board still has "
                           "is its way to brake.",
                           shown(config, "CONNECTION", "hostTimeout"), motion_held(config),
                           shown(config, "TRAJECTORY", "interpolationTime")),
               std::nullopt};
}

Finding check_spindle_range(const MachineConfig& config, Axis) {
  if (config.spindle.min_speed <= config.spindle.max_speed) return std::nullopt;
  return Error{ErrorCode::config_spindle_range,
               fmt::format("{} must not exceed {}.", shown(config, "SPINDLE_0", "spindleNmin"),
                           shown(config, "SPINDLE_0", "spindleNmax")),
               std::nullopt};
}

struct Rule {
  std::string_view key;  ///< of the setting to look at first
  Finding (*check)(const MachineConfig&, Axis);
};

constexpr std::array kAxisRules{
    Rule{"port", check_port_unique},           Rule{"stepsPerUnit", check_steps},
    Rule{"negativeLimit", check_limits},       Rule{"homeVelocity", check_home_velocity},
    Rule{"homePosition", check_home_position}, Rule{"velocity", check_step_frequency},
};

constexpr Rule kSlaveRule{"mode", check_master};

struct MachineRule {
  std::string_view section;
  Rule rule;
};

constexpr std::array kMachineRules{
    MachineRule{"CONNECTION", {"hostTimeout", check_host_timeout}},
    MachineRule{"CONNECTION", {"pulseWidth", check_pulse_width}},
    MachineRule{"TRAJECTORY", {"fifoTime", check_fifo_time}},
    MachineRule{"SPINDLE_0", {"spindleNmin", check_spindle_range}},
};

void run(const Rule& rule, std::string_view section, const MachineConfig& config, Axis axis,
         std::vector<ConfigConflict>& conflicts) {
  auto error = rule.check(config, axis);
  if (error) conflicts.push_back({std::move(*error), find_setting(section, rule.key)});
}

}  // namespace

std::vector<ConfigConflict> find_conflicts(const MachineConfig& config) {
  std::vector<ConfigConflict> conflicts;
  for (const Axis axis : kAllAxes) {
    if (!config.axes[axis].connected()) continue;
    for (const Rule& rule : kAxisRules) run(rule, axis_section(axis), config, axis, conflicts);
    if (is_rotary(axis)) run(kSlaveRule, axis_section(axis), config, axis, conflicts);
  }
  for (const auto& [section, rule] : kMachineRules) run(rule, section, config, Axis::X, conflicts);
  return conflicts;
}

std::vector<Error> find_cautions(const MachineConfig& config) {
  std::vector<Error> cautions;
  for (const Axis axis : kAllAxes) {
    if (!config.axes[axis].connected()) continue;
    if (auto caution = check_way_to_brake(config, axis)) cautions.push_back(std::move(*caution));
  }
  return cautions;
}

}  // namespace cnc::config
