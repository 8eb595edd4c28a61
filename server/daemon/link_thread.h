// The real-time thread: calls Link::cycle() at a fixed pace.
//
// It asks for SCHED_FIFO and for locked memory; where the system does not permit it, it runs as an
// ordinary thread and says so once (docs/realtime.md says what to configure). In the loop it
// allocates nothing, takes no lock and logs nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "server/link/link.h"

namespace cnc::server {

/// Locks what the process has in memory now, so that no page fault delays the link thread: to be
/// called when everything that it touches has been made. What comes later is not locked: a mapped
/// job of gigabytes must not be. Empty when granted, otherwise the reason why not.
[[nodiscard]] std::string lock_memory();

class LinkThread {
 public:
  LinkThread(Link& link, std::chrono::steady_clock::time_point epoch,
             std::chrono::microseconds period);
  ~LinkThread();

  /// Empty when SCHED_FIFO was granted, otherwise the reason why not.
  [[nodiscard]] const std::string& priority_refused() const { return priority_refused_; }

 private:
  void run();

  Link& link_;
  const std::chrono::steady_clock::time_point epoch_;
  const std::chrono::microseconds period_;
  std::atomic<bool> ending_{false};
  std::string priority_refused_;
  std::thread thread_;
};

}  // namespace cnc::server
