// Why a line is refused: the interpreter's inner error, before the name of the file, the line
// number and the call stack make a Diagnostic of it (diagnostic.h).
#pragma once

#include <cstdint>
#include <expected>
#include <string>

#include "config/error.h"

namespace cnc::interp {

/// A stretch of the line, counted in bytes; column from 1, 0 = the line as a whole.
struct Span {
  std::uint16_t column = 0;
  std::uint16_t length = 1;
};

struct Refusal {
  ErrorCode code{};
  Span span;
  std::string sentence;
  std::string allowed;  ///< what would be right, or empty
};

template <typename T>
using Parsed = std::expected<T, Refusal>;
using Accepted = Parsed<void>;

[[nodiscard]] inline std::unexpected<Refusal> refuse(ErrorCode code, Span span,
                                                     std::string sentence,
                                                     std::string allowed = {}) {
  return std::unexpected(Refusal{code, span, std::move(sentence), std::move(allowed)});
}

}  // namespace cnc::interp
