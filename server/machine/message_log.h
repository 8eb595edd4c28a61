// What the machine has to say: the last 1000 messages, numbered from 1.
//
// Any thread adds and reads, under a short lock that the real-time thread never takes.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "config/error.h"

namespace cnc::server {

enum class Severity : std::uint8_t { info, warning, error };

struct LogMessage {
  std::uint64_t sequence = 0;
  std::chrono::system_clock::time_point time;
  Severity severity = Severity::info;
  std::string text;
  std::optional<Error> error;
};

class MessageLog {
 public:
  static constexpr std::size_t kCapacity = 1000;

  void add(Severity severity, std::string text);
  void add(const Error& error);

  /// Messages with a sequence above `after`, oldest first, at most the newest `limit` (0 = all).
  [[nodiscard]] std::vector<LogMessage> after(std::uint64_t after, std::size_t limit = 0) const;
  [[nodiscard]] std::uint64_t newest() const;

 private:
  void append(LogMessage message);

  mutable std::mutex mutex_;  // protects messages_
  std::deque<LogMessage> messages_;
  std::uint64_t next_sequence_ = 1;
};

}  // namespace cnc::server
