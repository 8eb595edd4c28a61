// Does a virtual board do again what a trace has recorded? The recorded requests go to the same
// firmware, in virtual time, at the moments at which they reached the board; inputs, cable and
// resets happen as recorded; and what it then does is compared with every recorded status.
//
// A trace begins in the middle of things. The virtual board takes over at the first moment that is
// known whole: a standstill with an empty FIFO, or a segment in execution of which all that follows
// was recorded; it then runs up to its end with the axes' acceleration.
//
// Faults, the stop along the path, late cuts, the segment in execution, positions, digital outputs,
// home and probe latches and how often guard rules have acted are compared.
//
// Not compared: motion that follows the spindle, which the virtual machine does not have, up to the
// next standstill behind it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/trace/trace_file.h"

namespace cnc::hal::trace {

struct Difference {
  std::size_t step = 0;
  std::string what;  ///< "X is at 12.5000, replayed 12.7000"
};

/// A change of the recorded faults.
struct FaultChange {
  std::size_t step = 0;
  Faults faults = 0;
};

struct ReplayReport {
  std::size_t begin = 0;   ///< step at which the virtual board took over
  bool in_motion = false;  ///< there
  std::size_t compared = 0;
  std::size_t following_spindle = 0;     ///< statuses that were not compared
  std::size_t late_cuts = 0;             ///< recorded: a cut that came too late for the board
  double largest_deviation = 0.0;        ///< of any axis, mm or degrees, at the same moment
  std::vector<FaultChange> faults;       ///< recorded, behind the beginning
  std::optional<Difference> difference;  ///< the first; none: reproduced
};

/// An error if the configuration in the trace cannot be read, the trace holds what no board says,
/// or there is no place to begin. Bounded in time, whatever the trace.
[[nodiscard]] Result<ReplayReport> replay(const Trace& trace);

}  // namespace cnc::hal::trace
