// Compares what was recorded with what a virtual board did.
#pragma once

#include <span>

#include "config/machine_config.h"
#include "hal/trace/replay.h"

namespace cnc::hal::trace {

using GuardCounts = std::array<std::uint8_t, config::kGuardRules>;

/// How often guard rules have acted since a beginning. A new session counts from 0.
class GuardTally {
 public:
  void begin(const ControllerStatus& status) {
    session_ = status.sessions;
    at_beginning_ = status.guard_counts;
  }
  [[nodiscard]] GuardCounts since_beginning(const ControllerStatus& status) const {
    GuardCounts counts = status.guard_counts;
    if (status.sessions != session_) return counts;
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] = static_cast<std::uint8_t>(counts[i] - at_beginning_[i]);
    return counts;
  }

 private:
  std::uint32_t session_ = 0;
  GuardCounts at_beginning_{};
};

/// A recorded status, and what the virtual board showed at that moment.
struct Seen {
  std::size_t step = 0;
  Faults faults = 0;
  std::uint32_t executing_id = 0;
  PathStop path_stop = PathStop::none;
  bool cut_late = false;
  bool moving = false;
  Position position;
  Outputs outputs;
  AxisArray<Latch> home_latch{};
  ProbeLatch probe_latch{};
  GuardCounts guard_counts{};  ///< since the beginning
};

[[nodiscard]] inline bool follows_spindle(const Segment& segment) {
  return segment.wait_for_index || segment.spindle_speed != 0.0;
}

/// From `report.begin` up to the first difference. `seen` in the order of its steps.
void judge(const Trace& trace, std::span<const Seen> seen, const config::MachineConfig& config,
           ReplayReport& report);

}  // namespace cnc::hal::trace
