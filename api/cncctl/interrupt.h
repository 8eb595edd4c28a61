// Ctrl-C as a stop token.
#pragma once

#include <chrono>
#include <stop_token>
#include <thread>

namespace cnc::ctl {

/// Make one at the beginning of main(), before any other thread: it blocks SIGINT and SIGTERM for
/// all threads and receives them in its own. The first one requests the stop; a second one ends the
/// process at once, for a call that does not come back.
class Interrupt {
 public:
  Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::thread receiver_;
};

/// Waits until Ctrl-C.
void wait_for(const std::stop_token& interrupted);
/// At most so long; true if it was Ctrl-C.
[[nodiscard]] bool wait_for(const std::stop_token& interrupted, std::chrono::milliseconds time);

}  // namespace cnc::ctl
