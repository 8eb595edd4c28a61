#include "interpreter/comment_parser.h"

#include <algorithm>

#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

void set_comment(std::string_view text, Line& line) {
  constexpr std::string_view kMessage = "MSG";
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  TextCursor inside(text);
  inside.skip_blanks();
  if (std::ranges::equal(inside.letters(), kMessage, {}, upper)) {
    inside.advance(kMessage.size());
    if (inside.take(',')) {
      inside.skip_blanks();
      line.block.set_comment({MessageKind::message, inside.rest()});
      return;
    }
  }
  line.block.set_comment({MessageKind::comment, text});
}

// A comment ends at the first ")". Where another "(" stands in it, the writer may have meant more
// text than that; what follows could then be executed as code, so nothing may follow.
Accepted parse_parenthesised(TextCursor& cursor, Line& line) {
  const char* const begin = cursor.position();
  const std::string_view rest = cursor.rest();
  const std::size_t end = rest.find(')');
  if (end == std::string_view::npos) {
    return refuse(ErrorCode::comment_not_closed, cursor.span_here(rest.size()),
                  "This comment is not closed.", "\")\" before the end of the line.");
  }
  cursor.advance(end + 1);
  const bool nested = rest.substr(1, end).find('(') != std::string_view::npos;
  if (nested && rest.find_first_not_of(" \t\r", end + 1) != std::string_view::npos) {
    return refuse(ErrorCode::comment_nested, cursor.span_from(begin),
                  "A comment within a comment: it is not clear where the outer one ends.",
                  "No \"(\" inside of a comment with code behind it.");
  }
  if (nested) line.block.note(Habit::nested_comment, cursor.span_from(begin));
  set_comment(rest.substr(1, end - 1), line);
  return {};
}

}  // namespace

Accepted parse_comment(TextCursor& cursor, Line& line) {
  if (cursor.peek() == '(') return parse_parenthesised(cursor, line);
  set_comment(cursor.rest().substr(1), line);
  cursor.advance(cursor.rest().size());
  return {};
}

}  // namespace cnc::interp
