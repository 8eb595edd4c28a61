// Whether the computer itself stands still: a thread on each core, above every other, that does
// nothing but wake up. What it misses no program on that core could have done; virtual machines,
// and the firmware of some computers, take a core away for a while.
#pragma once

#include <atomic>
#include <chrono>
#include <pthread.h>
#include <sched.h>
#include <thread>
#include <vector>

namespace cnc::bench {

class StallWatch {
 public:
  StallWatch() {
    for (unsigned core = 0; core < std::thread::hardware_concurrency(); ++core)
      threads_.emplace_back([this, core](const std::stop_token& end) { watch(core, end); });
  }

  /// The longest time that a core was away, s, since this was called last.
  double longest() { return longest_.exchange(0.0); }

 private:
  void watch(unsigned core, const std::stop_token& end) {
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(core, &only);
    static_cast<void>(pthread_setaffinity_np(pthread_self(), sizeof only, &only));
    const sched_param highest{.sched_priority = sched_get_priority_max(SCHED_FIFO)};
    static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &highest));
    using Clock = std::chrono::steady_clock;
    constexpr auto kPeriod = std::chrono::milliseconds(1);
    for (auto due = Clock::now() + kPeriod; !end.stop_requested(); due += kPeriod) {
      std::this_thread::sleep_until(due);
      const auto now = Clock::now();
      const double late = std::chrono::duration<double>(now - due).count();
      for (double known = longest_; late > known && !longest_.compare_exchange_weak(known, late);) {
      }
      due = now;
    }
  }

  std::atomic<double> longest_{0.0};
  std::vector<std::jthread> threads_;
};

}  // namespace cnc::bench
