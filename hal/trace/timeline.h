// What a trace says happened at the board, on one clock: when requests arrived, when inputs
// changed, when the cable was out, when the board was reset, and when each status was true.
//
// The clock is the host's; the board's is put beside it by the answer that came quickest. Requests
// arrive when the first status that knows of them was made, so the delays of the line drop out.
#pragma once

#include <vector>

#include "hal/trace/trace_file.h"

namespace cnc::hal::trace {

struct Event {
  /// In the order in which they happen at one moment.
  enum class Kind : std::uint8_t {
    inputs,      ///< become those of the step
    pulse,       ///< an estop was pressed and was gone when the status was made
    card_pulse,  ///< guard rules have acted, since the status before
    cable_in,
    requests,   ///< of the step arrive
    silence,    ///< the step's exchange brought nothing, and its requests did not arrive
    compare,    ///< the step's status was true
    reset,      ///< of the board
    cable_out,  ///< nothing was heard from here on
  };
  double time = 0.0;
  Kind kind = Kind::compare;
  std::size_t step = 0;
};

/// Sorted by time.
[[nodiscard]] std::vector<Event> timeline_of(const Trace& trace);

}  // namespace cnc::hal::trace
