// What a trace is made of: every request that a Controller is given, and what each exchange brought
// back, in the order in which it happened.
#pragma once

#include <variant>

#include "hal/controller.h"

namespace cnc::hal::trace {

struct CutBehind {
  std::uint32_t id = 0;
};
struct SetOutputs {
  Outputs outputs;
};
struct ChangeOutputs {
  OutputChange change;
};
struct QuickStop {};
struct StopAlongPath {};
struct ReleaseStop {};
struct ClearFaults {};
struct SetPosition {
  Axis axis = Axis::X;
  double position = 0.0;
};
struct ArmHomeLatch {
  Axis axis = Axis::X;
  LatchEdge edge = LatchEdge::activate;
};
struct DisarmHomeLatch {
  Axis axis = Axis::X;
};
struct ArmProbeLatch {};
struct DisarmProbeLatch {};

/// A Segment is one that the controller has taken.
using Request = std::variant<Segment, CutBehind, SetOutputs, QuickStop, StopAlongPath, ReleaseStop,
                             ClearFaults, SetPosition, ArmHomeLatch, DisarmHomeLatch, ArmProbeLatch,
                             DisarmProbeLatch, ChangeOutputs>;

struct Exchange {
  double now = 0.0;                 ///< the host's clock, s
  std::uint64_t frame = 0;          ///< the last in which the requests before it have gone out
  std::uint32_t machine_state = 0;  ///< of whoever asked, as he numbers his states
  std::uint64_t line = 0;           ///< of the program; 0: none
  ControllerStatus status;          ///< that it brought
};

}  // namespace cnc::hal::trace
