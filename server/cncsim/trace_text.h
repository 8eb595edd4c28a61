// A trace of the link as text for people, and as a table for programs.
#pragma once

#include <filesystem>
#include <string>

#include "hal/trace/replay.h"

namespace cnc::server {

/// Of an exchange, seconds before the newest: at most 0.
[[nodiscard]] double seconds_to_end(const hal::trace::Trace& trace, std::size_t step);

/// When, why, which board, the faults, and where everything stood at the end.
[[nodiscard]] std::string summary_text(const hal::trace::Trace& trace);
/// A line for each exchange of the last `seconds`.
[[nodiscard]] std::string exchanges_text(const hal::trace::Trace& trace, double seconds);
[[nodiscard]] std::string verdict_text(const hal::trace::Trace& trace,
                                       const hal::trace::ReplayReport& report);

/// A row for each exchange, a column for each field; the requests that went out are counted.
Result<void> write_trace_csv(const hal::trace::Trace& trace, const std::filesystem::path& path);

}  // namespace cnc::server
