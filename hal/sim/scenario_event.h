// What a scenario makes happen, and when.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "hal/sim/virtual_motor.h"

namespace cnc::hal::sim {

// --- what ----------------------------------------------------------------------------------------

struct CableMoves {
  bool out;
};
/// What is set is changed, the rest of LinkTrouble stays.
struct LinkChanges {
  std::optional<double> loss;
  std::optional<double> duplication;
  std::optional<double> corruption;
  std::optional<double> delay;
  std::optional<double> jitter;
};
struct BoardRestarts {};
/// `state`: closed, open, or unset: free again.
struct SwitchSticks {
  Axis axis;
  VirtualMotor::Switch which;
  std::optional<bool> state;
};
struct ProbeSticks {
  std::optional<bool> state;
};
struct DoorContactSticks {
  std::optional<bool> state;
};
struct EstopButton {
  bool channel1;
  bool channel2;
  bool pressed;
};
struct ExternalError {
  bool raised;
};
struct StepsAreLost {
  Axis axis;
  std::int64_t steps;  ///< that the axis goes, unknown to the board
};
struct DriveAlarm {
  Axis axis;
  bool raised;
};
struct IndexSensor {
  bool missing;
};
struct DoorMoves {
  bool open;
};
struct AnalogChanges {
  std::size_t input;
  double part;  ///< 0 … 1
};
struct PortChanges {
  std::size_t port;
  bool active;
};
struct HandWheelTurns {
  std::int32_t counts;
};
struct ToolIsLoaded {
  int number;
};

using ScenarioAction =
    std::variant<CableMoves, LinkChanges, BoardRestarts, SwitchSticks, ProbeSticks,
                 DoorContactSticks, EstopButton, ExternalError, StepsAreLost, DriveAlarm,
                 IndexSensor, DoorMoves, AnalogChanges, PortChanges, HandWheelTurns, ToolIsLoaded>;

// --- when ----------------------------------------------------------------------------------------

/// Once, when the axis comes from the other side of `place`, in machine coordinates.
struct PlacePassed {
  Axis axis;
  double place;
  bool upwards;
};

struct ScenarioEvent {
  std::variant<cpu5::firmware::Ticks, PlacePassed> when;  ///< time since power-up, or a place
  ScenarioAction action;
};

}  // namespace cnc::hal::sim
