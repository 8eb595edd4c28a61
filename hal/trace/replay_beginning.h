// Where in a trace a virtual board can take over.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "config/machine_config.h"
#include "hal/trace/timeline.h"

namespace cnc::hal::trace {

inline constexpr double kReplayCycle = 0.002;  // s, of exchanges where nothing was recorded

struct Beginning {
  std::size_t event = 0;
  std::vector<Segment> path{};  ///< the segment in execution and those behind it; empty at rest
  double rest = 0.0;            ///< s of the first that were still to be made
  double run_up = 0.0;          ///< s from a standstill to the end of the first
  std::uint32_t pieces = 0;     ///< segments of the run-up; the last is the first's, by its number
};

/// The first standstill with an empty FIFO, or segment in execution behind which all is known.
/// None: there is no such moment.
[[nodiscard]] std::optional<Beginning> find_beginning(const Trace& trace,
                                                      std::span<const Event> events,
                                                      const config::MachineConfig& config);

}  // namespace cnc::hal::trace
