// What whoever started a long check sees and can do: progress on a terminal, and Ctrl-C, which ends
// the check with the report of what has been read so far.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>

#include "interpreter/check.h"

namespace cnc::server {

/// While it lives the first Ctrl-C sets asked(), and the second one ends the process.
class Interrupt {
 public:
  Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  [[nodiscard]] static const std::atomic<bool>& asked();

 private:
  struct sigaction before_ {};
};

/// One line on stderr that is written over and over, and is gone in the end.
class ProgressLine {
 public:
  /// `lines` of the file.
  explicit ProgressLine(std::uint32_t lines) : lines_(lines) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine();

  [[nodiscard]] static bool is_terminal();
  void show(const interp::CheckProgress& progress);

 private:
  std::uint32_t lines_;
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
  bool shown_ = false;
};

}  // namespace cnc::server
