#include "server/cncsim/watched_check.h"

#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace cnc::server {
namespace {

std::atomic<bool> interrupt_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler may not wait

}  // namespace

Interrupt::Interrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupt_asked.store(true, std::memory_order_relaxed); };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, nullptr, &before_);
  // Whoever has put it into the background does not want Ctrl-C to end it.
  if (before_.sa_handler != SIG_IGN) sigaction(SIGINT, &action, nullptr);
}

Interrupt::~Interrupt() { sigaction(SIGINT, &before_, nullptr); }

const std::atomic<bool>& Interrupt::asked() { return interrupt_asked; }

bool ProgressLine::is_terminal() { return isatty(STDERR_FILENO) == 1; }

void ProgressLine::show(const interp::CheckProgress& progress) {
  constexpr auto kEvery = std::chrono::milliseconds(200);
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kEvery;
  shown_ = true;
  fmt::print(stderr, "\r\x1b[Kline {} of {}", progress.line, lines_);
  if (progress.lines_since_new != 0)
    fmt::print(stderr, ", {} lines in loops and subs", progress.lines_since_new);
  std::fflush(stderr);
}

ProgressLine::~ProgressLine() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

}  // namespace cnc::server
