// What the server adds to a trace of its link: of which machine it is, and what the machine did.
#pragma once

#include <chrono>
#include <string>

#include "config/machine_config.h"
#include "hal/trace/ring.h"
#include "hal/trace/trace_file.h"
#include "server/machine/machine.h"

namespace cnc::server {

/// Without reason and time.
[[nodiscard]] hal::trace::About about_machine(const config::MachineConfig& config,
                                              std::string board);

/// "2026-05-01T12:30:05.123Z"
[[nodiscard]] std::string utc_text(std::chrono::system_clock::time_point time);

/// Executor: behind each cycle of the machine.
inline void note_state(hal::trace::Ring& ring, const Machine& machine) {
  ring.note(static_cast<std::uint32_t>(machine.state()), machine.snapshots().newest()->job.line);
}

}  // namespace cnc::server
