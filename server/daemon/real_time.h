// What the server asks of the system so that other programs cannot delay it (docs/realtime.md).
// Where that is not permitted it runs as an ordinary program and says so.
#pragma once

#include <string>
#include <thread>

namespace cnc::server {

/// Above the interrupt threads of discs and networks (50), below watchdogs.
inline constexpr int kLinkPriority = 60;
/// Plans a quarter of a second ahead and obeys the operator: below the interrupt threads that bring
/// his wishes, above whatever else the computer does.
inline constexpr int kExecutorPriority = 40;

/// SCHED_FIFO for a thread; threads that it starts are ordinary ones. Empty when granted, otherwise
/// the reason why not.
[[nodiscard]] std::string request_fifo(std::thread::native_handle_type thread, int priority);

/// Locks what the process has in memory now, so that no page fault delays the link thread: to be
/// called when everything that it touches has been made. What comes later is not locked: a mapped
/// job of gigabytes must not be. Empty when granted, otherwise the reason why not.
[[nodiscard]] std::string lock_memory();

}  // namespace cnc::server
