// The machine's description as the program uses it: everything of cnc.ini, typed and checked.
//
// Lengths are mm and degrees whatever the machine units of the file are; times are seconds. The
// values are valid by construction when they come from load_machine_config() (ini_file.h).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "config/axis.h"
#include "config/guard_rule.h"

namespace cnc::config {

enum class MachineUnit : std::uint8_t { millimetre, inch };

/// CFG-24: at this position of the machine a measurement finds it in truth there.
struct PitchPoint {
  double machine = 0.0;
  double calibrated = 0.0;

  friend bool operator==(const PitchPoint&, const PitchPoint&) = default;
};

/// CFG-3: what the motor of a rotary axis' section does.
enum class AxisMode : std::uint8_t {
  axis,     ///< moves the axis of its own letter
  slave_x,  ///< a second motor of X, as of a gantry; its lengths are mm
  slave_y,
  slave_z,
  mill,  ///< A turns the work piece about work Y0 Z0; F is the speed of the tool's tip on it
};

/// CFG-2: one motor axis.
struct AxisConfig {
  bool visible = false;  ///< shown on screens
  AxisMode mode = AxisMode::axis;
  std::int32_t port = 0;          ///< output port of the board, 1 … 6; 0 = not connected
  double steps_per_unit = 100.0;  ///< negative reverses the motor; mm or degree
  bool step_active_low = false;
  bool direction_active_low = false;
  double negative_limit = 0.0;  ///< machine coordinates
  double positive_limit = 0.0;
  double velocity = 50.0;       ///< per second
  double acceleration = 200.0;  ///< per second squared
  double jerk = 0.0;            ///< per second cubed; 0: no limit
  double backlash = 0.0;
  bool pitch_compensation = false;
  std::vector<PitchPoint> pitch_table{};  ///< of the file of its own (pitch_table.h); empty: none
  double home_velocity = 0.0;             ///< signed: direction of the search; 0 = homed by hand
  double home_position = 0.0;             ///< machine position where the home switch releases

  /// There is a motor.
  [[nodiscard]] bool connected() const { return port != 0; }
  /// Programs and the operator can move it; a slave only follows.
  [[nodiscard]] bool programmable() const {
    return connected() && (mode == AxisMode::axis || mode == AxisMode::mill);
  }

  friend bool operator==(const AxisConfig&, const AxisConfig&) = default;
};

/// LNK-1, LNK-3: the controller board and the pulses that it makes.
struct ConnectionConfig {
  std::string board = "virtual";       ///< hal/cpu5/driver/board_address.h, as the next
  std::string local_address = "auto";  ///< of this computer, on the board's network
  double host_timeout = 0.2;           ///< s of silence after which the board stops the machine
  std::int32_t max_step_frequency = 125'000;  ///< Hz; no axis may need more at its velocity
  double pulse_width = 1.0;                   ///< µs; the pause behind it is as long at least
  double direction_setup = 5.0;               ///< µs from a change of direction to the next pulse
  double direction_hold = 5.0;  ///< µs from a pulse's beginning to a change of direction

  friend bool operator==(const ConnectionConfig&, const ConnectionConfig&) = default;
};

struct TrajectoryConfig {
  double interpolation_time = 0.005;  ///< s
  double fifo_time = 0.25;            ///< s of motion kept in the board
  double laf_angle = 1.0;             ///< degrees
  double path_tolerance = 0.02;       ///< mm; of G64 without P
  double tolerance_use = 1.0;         ///< 0 … 1
  double backlash_share = 0.25;       ///< of velocity and acceleration, kept for taking up play

  friend bool operator==(const TrajectoryConfig&, const TrajectoryConfig&) = default;
};

struct SpindleConfig {
  double max_speed = 24000.0;  ///< rpm at 100 % PWM
  double min_speed = 0.0;      ///< rpm
  double ramp_up_time = 1.0;   ///< s

  friend bool operator==(const SpindleConfig&, const SpindleConfig&) = default;
};

/// CRD-4: from the first spindle to another head, mm.
struct HeadOffset {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend bool operator==(const HeadOffset&, const HeadOffset&) = default;
};

struct SafetyConfig {
  bool homing_mandatory = true;
  bool home_sensor_is_estop = false;
  bool drives_hold_position = false;  ///< also while they are off
  bool shut_down_on_fatal = false;    ///< the server ends when it loses the board

  friend bool operator==(const SafetyConfig&, const SafetyConfig&) = default;
};

enum class ProgramDialect : std::uint8_t { eding, pscnc };

struct InterpreterConfig {
  bool absolute_arc_centres = false;
  bool block_delete = false;
  ProgramDialect dialect = ProgramDialect::eding;
  bool strict = false;                ///< what the manual does not allow is an error
  bool diameter_programming = false;  ///< X of a lathe
  bool front_tool_post = false;       ///< a lathe with X towards the operator
  bool is_3d_printer = false;

  friend bool operator==(const InterpreterConfig&, const InterpreterConfig&) = default;
};

/// STA-7: X Y Z where only a tool change may go, machine coordinates; none where low is not below
/// high.
struct ToolChangeArea {
  double x_low = 0.0;
  double x_high = 0.0;
  double y_low = 0.0;
  double y_high = 0.0;
  double z_low = 0.0;
  double z_high = 0.0;

  [[nodiscard]] bool exists() const { return x_low < x_high && y_low < y_high && z_low < z_high; }

  friend bool operator==(const ToolChangeArea&, const ToolChangeArea&) = default;
};

struct JobConfig {
  bool auto_tool_change = false;  ///< M6 calls change_tool and does not stop for the operator

  friend bool operator==(const JobConfig&, const JobConfig&) = default;
};

struct MachineConfig {
  MachineUnit unit = MachineUnit::millimetre;  ///< of the file and the screen; never of the values
  ConnectionConfig connection;
  AxisArray<AxisConfig> axes;
  TrajectoryConfig trajectory;
  SpindleConfig spindle;
  SafetyConfig safety;
  InterpreterConfig interpreter;
  JobConfig job;
  ToolChangeArea tool_change_area;
  HeadOffset spindle_1;                         ///< M91
  HeadOffset spindle_2;                         ///< M92 M93
  HeadOffset probe;                             ///< M95
  HeadOffset camera;                            ///< M97
  std::array<GuardRule, kGuardRules> guards{};  ///< card by card

  /// The axis that this motor moves: its own, or its master's.
  [[nodiscard]] Axis moved_by(Axis motor) const {
    switch (axes[motor].mode) {
      case AxisMode::axis:
      case AxisMode::mill:
        return motor;
      case AxisMode::slave_x:
        return Axis::X;
      case AxisMode::slave_y:
        return Axis::Y;
      case AxisMode::slave_z:
        return Axis::Z;
    }
    return motor;
  }

  friend bool operator==(const MachineConfig&, const MachineConfig&) = default;
};

}  // namespace cnc::config
