// The real-time thread: calls Link::cycle() at a fixed pace.
//
// It asks for SCHED_FIFO. In the loop it allocates nothing, takes no lock and logs nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "server/link/link.h"

namespace cnc::server {

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
