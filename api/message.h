// What the machine has to say: messages from programs, warnings, errors.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "api/error.h"

namespace cnc::api {

enum class Severity : std::uint8_t { info, warning, error };
[[nodiscard]] std::string_view name_of(Severity severity);

struct Message {
  std::uint64_t sequence = 0;                             ///< ascending from 1 while a server runs
  std::chrono::sys_time<std::chrono::milliseconds> time;  ///< the server's wall clock
  Severity severity = Severity::info;
  std::string text;
  std::optional<Error> error;  ///< set for errors
};

}  // namespace cnc::api
