// What is wrong with a program, where, and what would be right: for the screen, the log and the
// API.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/error.h"

namespace cnc::interp {

enum class Severity : std::uint8_t { error, warning };

/// A gosub that led to the place of the diagnostic.
struct CallSite {
  std::string sub;
  std::string file;        ///< of the gosub
  std::uint32_t line = 0;  ///< of it
};

struct Diagnostic {
  ErrorCode code{};
  Severity severity = Severity::error;
  std::string sentence;
  std::string allowed;  ///< what would be right, or empty
  std::string file;
  std::uint32_t line = 0;    ///< from 1
  std::uint32_t column = 0;  ///< from 1, in bytes; 0 = the line as a whole
  std::uint32_t length = 0;  ///< bytes that are wrong
  std::string line_text;
  std::vector<CallSite> call_stack;  ///< innermost first

  /// Several lines: place and sentence, the line with the wrong part underlined, what is allowed,
  /// and the calls that led there.
  [[nodiscard]] std::string to_string() const;
  /// Sentence and place, for what crosses a module boundary.
  [[nodiscard]] Error to_error() const;
};

}  // namespace cnc::interp
