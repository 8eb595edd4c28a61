// Comments of a line (manual 3.2.4): "( … )" and "; …", and the operator's message in them.
#pragma once

#include "interpreter/expression_parser.h"
#include "interpreter/line.h"

namespace cnc::interp {

[[nodiscard]] constexpr bool starts_comment(char c) { return c == '(' || c == ';'; }
/// At "(" or ";": reads to the end of the comment.
Accepted parse_comment(TextCursor& cursor, Line& line);

}  // namespace cnc::interp
