#include "server/daemon/link_thread.h"

#include <cerrno>
#include <time.h>

#include "server/daemon/real_time.h"

namespace cnc::server {
namespace {

std::chrono::steady_clock::time_point sleep_until(std::chrono::steady_clock::time_point due) {
  const auto since_boot = due.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_boot);
  const timespec until{seconds.count(), (since_boot - seconds).count()};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
  return std::chrono::steady_clock::now();
}

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

LinkThread::LinkThread(Link& link, std::chrono::steady_clock::time_point epoch,
                       std::chrono::microseconds period)
    : link_(link), epoch_(epoch), period_(period), thread_([this] { run(); }) {
  priority_refused_ = request_fifo(thread_.native_handle(), kLinkPriority);
}

LinkThread::~LinkThread() {
  ending_.store(true, std::memory_order_relaxed);
  thread_.join();
}

void LinkThread::run() {
  LinkStatistics& statistics = link_.statistics();
  auto due = std::chrono::steady_clock::now() + period_;
  while (!ending_.load(std::memory_order_relaxed)) {
    const auto begin = sleep_until(due);
    link_.cycle(seconds(begin - epoch_));
    const auto end = std::chrono::steady_clock::now();
    statistics.lateness.record(seconds(begin - due));
    statistics.work.record(seconds(end - begin));
    statistics.cycles.fetch_add(1, std::memory_order_relaxed);
    // After a long delay the pace starts anew instead of running after lost cycles.
    due = std::max(due + period_, end);
  }
}

}  // namespace cnc::server
