// Statements: lines that begin with a word of the language's own (manual chapter 4).
#pragma once

#include <string_view>

#include "interpreter/expression_parser.h"
#include "interpreter/line.h"
#include "interpreter/statements.h"

namespace cnc::interp {

struct Keyword {
  std::string_view name;  ///< lower case
  Statement statement{};
  MessageKind text_kind = MessageKind::message;  ///< of a text statement
};

/// What a statement begins with: one of the two is set, or none if this is no statement.
struct KeywordMatch {
  const Keyword* keyword = nullptr;
  const SpecialStatement* special = nullptr;

  [[nodiscard]] explicit operator bool() const { return keyword != nullptr || special != nullptr; }
};

/// The keyword at the cursor, which moves behind it; "end if" may be written apart.
[[nodiscard]] KeywordMatch take_keyword(TextCursor& cursor);
/// The name that begins `rest`: of a sub, in sub and gosub.
[[nodiscard]] std::string_view leading_name(std::string_view rest);

/// Behind line number and "/", at a letter that begins no word.
Accepted parse_statement(TextCursor& cursor, Line& line);

}  // namespace cnc::interp
