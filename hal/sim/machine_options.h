// How a virtual machine is built and wired. The defaults are a sound machine that fits its
// configuration; a scenario file (docs/scenarios.md) says the rest.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "config/axis.h"
#include "hal/cpu5/firmware/segment.h"
#include "hal/ports.h"
#include "hal/sim/touch_surface.h"
#include "hal/sim/virtual_heater.h"
#include "hal/sim/virtual_spindle.h"

namespace cnc::hal::sim {

/// Unset values follow from the configured velocity and acceleration, with a margin of 1.5: a right
/// plan loses no step.
struct MotorOptions {
  std::optional<double> acceleration{};     ///< that the torque gives at low speed, above 0
  std::optional<double> corner_velocity{};  ///< from where it falls as 1 / speed, above 0
  std::optional<double> top_velocity{};     ///< from where there is none, above 0
  double microsteps = 4.0;                  ///< step pulses to a full step, above 0
  bool closed_loop = false;                 ///< the drive raises an alarm when a step was lost
};

struct AxisOptions {
  MotorOptions motor{};
  /// Port inputs (hal::port_bit()) of the limit switches at either end of the way.
  std::optional<std::size_t> limit_low_port{};
  std::optional<std::size_t> limit_high_port{};
  bool limits_in_estop_chain = false;
};

struct DoorOptions {
  std::optional<std::size_t> port{};  ///< input that is active while it is open
  bool open = false;                  ///< at power-up
  bool in_estop_chain = false;
  bool stops_spindle = false;
  bool stops_coolant = false;
};

struct MachineOptions {
  /// Where the axes stand at power-up, mm and degrees; unset: in the middle of their travel. An
  /// axis placed beyond a stop stands at the stop.
  std::optional<Position> start{};
  double stop_margin = 5.0;          ///< from the end of the travel to the hard stop, mm or degrees
  double limit_switch_margin = 2.0;  ///< from there to where the limit switch trips
  double switch_hysteresis = 0.2;    ///< between trip and release of a switch, mm or degrees
  double switch_bounce = 0.0;        ///< s that a switch flickers after an edge
  std::uint64_t seed = 1;            ///< of the bounces
  AxisArray<AxisOptions> axes{};
  TouchOptions touch{};
  SpindleOptions spindle{};
  std::vector<HeaterOptions> heaters{};
  std::optional<DoorOptions> door{};
  /// Wires every AUX and card output to the input of its number, through relays that take so long,
  /// s; unset: no wires.
  std::optional<double> loop_back_delay{};
  /// Ports of a card that is not there read inactive, and its outputs move nothing.
  std::array<bool, kCardCount> io_cards{true, true, true};
  cpu5::firmware::PortBits ports_on = 0;      ///< inputs that are active at power-up
  std::array<double, kAnalogCount> analog{};  ///< 0 … 1 of the range, at power-up
};

}  // namespace cnc::hal::sim
