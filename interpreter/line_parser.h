// The grammar of a line (manual 3.2 and 4.1): text in, Line out.
#pragma once

#include <string_view>

#include "interpreter/line.h"
#include "interpreter/refusal.h"
#include "interpreter/statement_parser.h"

namespace cnc::interp {

/// The manual allows 256 characters; real programs have longer comments and texts.
inline constexpr std::size_t kMaxLineLength = 4096;

/// Parses `text`, a line without its line end. `line` holds views into `text`. After a refusal its
/// content means nothing.
Accepted parse_line(std::string_view text, Line& line);

/// The keyword that a line begins with, behind "/" and line number, and the text behind it;
/// nullptr if the line begins with anything else.
struct LineKeyword {
  const Keyword* keyword = nullptr;
  std::string_view rest;
};
[[nodiscard]] LineKeyword find_keyword(std::string_view text);

}  // namespace cnc::interp
