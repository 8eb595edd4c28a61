// Whether a trace can be what it says: a file may come from anywhere.
//
// What no server writes makes a file none: numbers that are not finite, a clock of the host that
// goes back. What no board says is shown as it was recorded, because a mad board is worth looking
// at, but it is not replayed: that would take for ever, or mean nothing.
#pragma once

#include <optional>
#include <string>

#include "hal/trace/trace_file.h"

namespace cnc::hal::trace {

/// More than any server records in one file: it keeps 30 s.
inline constexpr double kLongestTrace = 60.0;  // s
inline constexpr std::size_t kMostRequests = 300'000;

/// "has, in exchange 3, a status.position.X that is not a finite number"; none: all is well.
[[nodiscard]] std::optional<std::string> what_no_server_writes(const Trace& trace);

/// "In exchange 3 the board's time is -5 s."; none: all is well.
[[nodiscard]] std::optional<std::string> what_no_board_says(const Trace& trace);

}  // namespace cnc::hal::trace
