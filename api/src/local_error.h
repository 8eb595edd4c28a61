// Errors that arise on this side of the wire. Their numbers, names and advice are rows of the
// project's error table; a test compares them, because this room may not include the table itself.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "api/error.h"

namespace cnc::api {

struct LocalError {
  ErrorKind kind;
  std::uint32_t code;
  std::string_view name;
  std::string_view check;
};

[[nodiscard]] std::span<const LocalError> local_errors();

/// An error of this kind with the number, name and advice of its row, if it has one.
[[nodiscard]] Error make_local_error(ErrorKind kind, std::string message);

}  // namespace cnc::api
