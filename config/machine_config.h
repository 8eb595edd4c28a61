// The machine's description as the program uses it: everything of cnc.ini, typed and checked.
//
// Lengths are mm and degrees whatever the machine units of the file are; times are seconds. The
// values are valid by construction when they come from load_machine_config() (ini_file.h).
#pragma once

#include <cstdint>
#include <string>

#include "config/axis.h"

namespace cnc::config {

enum class MachineUnit : std::uint8_t { millimetre, inch };

/// CFG-2: one motor axis.
struct AxisConfig {
  bool visible = false;           ///< shown on screens
  std::int32_t port = 0;          ///< output port of the board, 1 … 6; 0 = not connected
  double steps_per_unit = 100.0;  ///< negative reverses the motor; mm or degree
  double negative_limit = 0.0;    ///< machine coordinates
  double positive_limit = 0.0;
  double velocity = 50.0;       ///< per second
  double acceleration = 200.0;  ///< per second squared
  double backlash = 0.0;
  double home_velocity = 0.0;  ///< signed: direction of the search; 0 = homed by hand
  double home_position = 0.0;  ///< machine position where the home switch releases

  [[nodiscard]] bool connected() const { return port != 0; }

  friend bool operator==(const AxisConfig&, const AxisConfig&) = default;
};

/// LNK-3
struct ConnectionConfig {
  std::int32_t max_step_frequency = 125'000;  ///< Hz; no axis may need more at its velocity

  friend bool operator==(const ConnectionConfig&, const ConnectionConfig&) = default;
};

struct TrajectoryConfig {
  double interpolation_time = 0.005;  ///< s
  double fifo_time = 0.25;            ///< s of motion kept in the board
  double laf_angle = 1.0;             ///< degrees

  friend bool operator==(const TrajectoryConfig&, const TrajectoryConfig&) = default;
};

struct SpindleConfig {
  double max_speed = 24000.0;  ///< rpm at 100 % PWM
  double min_speed = 0.0;      ///< rpm
  double ramp_up_time = 1.0;   ///< s

  friend bool operator==(const SpindleConfig&, const SpindleConfig&) = default;
};

struct SafetyConfig {
  bool homing_mandatory = true;
  bool home_sensor_is_estop = false;

  friend bool operator==(const SafetyConfig&, const SafetyConfig&) = default;
};

struct InterpreterConfig {
  bool absolute_arc_centres = false;
  bool block_delete = false;

  friend bool operator==(const InterpreterConfig&, const InterpreterConfig&) = default;
};

struct JobConfig {
  bool auto_tool_change = false;  ///< M6 does not stop for the operator

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

  friend bool operator==(const MachineConfig&, const MachineConfig&) = default;
};

}  // namespace cnc::config
