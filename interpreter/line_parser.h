// The grammar of a line (manual 3.2 and 4.1): text in, Line out.
#pragma once

#include <string_view>

#include "interpreter/line.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

/// The manual allows 256 characters; real programs have longer comments and texts.
inline constexpr std::size_t kMaxLineLength = 4096;

/// Parses `text`, a line without its line end. `line` holds views into `text`. After a refusal its
/// content means nothing.
Accepted parse_line(std::string_view text, Line& line);

/// A statement of the language's own (manual chapter 4): the first word of a line.
struct Keyword {
  std::string_view name;  ///< lower case
  Statement statement;
  MessageKind text_kind = MessageKind::message;  ///< of a text statement
};

/// The keyword that a line begins with, and the text behind it.
struct KeywordMatch {
  const Keyword* keyword = nullptr;
  std::string_view rest;
};
/// Looks behind "/" and line number too. keyword is nullptr if the line begins with anything else.
[[nodiscard]] KeywordMatch find_keyword(std::string_view text);
/// The name that begins `rest`: of a sub, in sub and gosub.
[[nodiscard]] std::string_view leading_name(std::string_view rest);

}  // namespace cnc::interp
