// Compares what was recorded with what a virtual board did.
#pragma once

#include <span>

#include "config/machine_config.h"
#include "hal/trace/replay.h"

namespace cnc::hal::trace {

/// A recorded status, and what the virtual board showed at that moment.
struct Seen {
  std::size_t step = 0;
  Faults faults = 0;
  std::uint32_t executing_id = 0;
  PathStop path_stop = PathStop::none;
  bool moving = false;
  Position position;
};

[[nodiscard]] inline bool follows_spindle(const Segment& segment) {
  return segment.wait_for_index || segment.spindle_speed != 0.0;
}

/// Up to the first difference. `seen` in the order of its steps.
void judge(const Trace& trace, std::span<const Seen> seen, const config::MachineConfig& config,
           ReplayReport& report);

}  // namespace cnc::hal::trace
