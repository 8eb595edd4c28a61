// A thread that runs what others post to it, one task after the other, and tasks at a steady pace.
//
// The executor that owns the machine, the fanout of the status streams and the reader of job files
// are one each.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace cnc::server {

class TaskThread {
 public:
  TaskThread();
  /// Stops the thread after the task under way; tasks that have not begun are dropped.
  ~TaskThread();

  /// Any thread. Tasks run in the order in which they were posted.
  void post(std::function<void()> task);
  /// Any thread. Calls `task` every `period` for as long as it returns true. A late call is not
  /// made up for: the next is due one period later, or at once.
  void every(std::chrono::microseconds period, std::function<bool()> task);

  /// SCHED_FIFO (real_time.h). Empty when granted, otherwise the reason why not.
  [[nodiscard]] std::string request_priority(int priority);

  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

using Epoch = std::chrono::steady_clock::time_point;

/// Seconds since `epoch`: the clock of machine and link.
[[nodiscard]] inline double seconds_since(Epoch epoch) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - epoch).count();
}

}  // namespace cnc::server
