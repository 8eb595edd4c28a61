#include "server/machine/message_log.h"

#include <algorithm>
#include <array>
#include <spdlog/spdlog.h>
#include <utility>

namespace cnc::server {

void MessageLog::add(Severity severity, std::string text) {
  append({0, {}, severity, std::move(text), std::nullopt});
}

void MessageLog::add(const Error& error) {
  append({0, {}, Severity::error, error.to_string(), error});
}

void MessageLog::append(LogMessage message) {
  constexpr std::array kLevels{spdlog::level::info, spdlog::level::warn, spdlog::level::err};
  spdlog::log(kLevels[static_cast<std::size_t>(message.severity)], "{}", message.text);

  const std::scoped_lock lock(mutex_);
  message.sequence = next_sequence_++;
  message.time = std::chrono::system_clock::now();
  messages_.push_back(std::move(message));
  if (messages_.size() > kCapacity) messages_.pop_front();
}

std::vector<LogMessage> MessageLog::after(std::uint64_t after, std::size_t limit) const {
  const std::scoped_lock lock(mutex_);
  auto first = std::ranges::upper_bound(messages_, after, {}, &LogMessage::sequence);
  const auto count = static_cast<std::size_t>(messages_.end() - first);
  if (limit != 0 && count > limit) first += static_cast<std::ptrdiff_t>(count - limit);
  return {first, messages_.end()};
}

std::uint64_t MessageLog::newest() const {
  const std::scoped_lock lock(mutex_);
  return next_sequence_ - 1;
}

}  // namespace cnc::server
