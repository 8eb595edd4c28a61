#include "interpreter/line_parser.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "interpreter/comment_parser.h"
#include "interpreter/expression_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

constexpr std::size_t kLineNumberDigits = 5;    // manual 3.2.1
constexpr std::size_t kManualLineLength = 256;  // manual 3.2

// Letters of words, table 3-2 of the manual, and E of M54. N and O are read before the words.
constexpr WordSet kWordLetters = words("ABCDEFGHIJKLMPQRSTXYZ");

/// Two letters side by side begin a keyword, or a word whose value is a function: XSIN[30].
[[nodiscard]] bool is_word_with_function(std::string_view letters) {
  return find_function(letters.substr(1)) != nullptr;
}

struct LineHead {
  bool optional = false;
  std::size_t digits = 0;  ///< of the line number; 0 = none
};

/// Skips blanks, "/" and the line number.
LineHead skip_head(TextCursor& cursor) {
  LineHead head;
  head.optional = cursor.take('/');
  cursor.skip_blanks();
  if (upper(cursor.peek()) != 'N') return head;
  const char* const begin = cursor.position();
  cursor.advance();
  cursor.skip_blanks();
  for (; is_digit(cursor.peek()); cursor.advance()) ++head.digits;
  if (head.digits == 0) cursor.move_to(begin);
  cursor.skip_blanks();
  return head;
}

class LineParser {
 public:
  LineParser(std::string_view text, Line& line) : cursor_(text), line_(line) {}

  Accepted parse() {
    const LineHead head = skip_head(cursor_);
    line_.optional = head.optional;
    if (head.digits > kLineNumberDigits) line_.block.note(Habit::long_line_number, {1, 1});
    const char first = upper(cursor_.peek());
    if (first == '%') return {};  // begin or end of the tape, nesting data: not for the interpreter
    if (first == 'N') return bad_line_number();
    if (first == 'O') return skip_program_number();
    const std::string_view letters = cursor_.letters();
    if (letters.size() > 1 && !is_word_with_function(letters)) {
      return parse_statement(cursor_, line_);
    }
    return parse_items();
  }

 private:
  Accepted parse_items() {
    for (;;) {
      cursor_.skip_blanks();
      if (cursor_.at_end()) return {};
      if (Accepted item = parse_item(); !item) return item;
    }
  }

  Accepted parse_item() {
    const char c = cursor_.peek();
    if (is_letter(c)) return parse_word();
    if (c == '#') return parse_setting();
    if (starts_comment(c)) return parse_comment(cursor_, line_);
    return refuse(ErrorCode::unexpected_character, cursor_.span_here(),
                  fmt::format("\"{}\" cannot stand here.", c),
                  "A word (letter and value), #n=value, (comment) or ;comment.");
  }

  Accepted parse_word() {
    const char* const begin = cursor_.position();
    const char letter = upper(cursor_.peek());
    if ((kWordLetters & word_bit(letter)) == 0) return bad_letter(letter);
    cursor_.advance();
    cursor_.skip_blanks();
    const bool negative = cursor_.peek() == '-';
    if (negative || cursor_.peek() == '+') cursor_.advance();
    cursor_.skip_blanks();
    const ScannedNumber number = scan_number(cursor_.position(), cursor_.end());
    if (number.end != cursor_.position()) {
      cursor_.move_to(number.end);
      return line_.block.add_word(letter, negative ? -number.value : number.value,
                                  cursor_.span_from(begin));
    }
    cursor_.move_to(begin + 1);
    return parse_computed_word(letter, begin);
  }

  Accepted parse_computed_word(char letter, const char* begin) {
    ExpressionParser parser(cursor_, line_);
    if (Accepted value = parser.parse_value(); !value) {
      if (value.error().code == ErrorCode::value_expected) {
        value.error().sentence = fmt::format("The word {} has no value.", letter);
      }
      return value;
    }
    parser.emit({OpCode::store_word, cursor_.span_from(begin), letter});
    return {};
  }

  Accepted parse_setting() {
    const char* const begin = cursor_.position();
    cursor_.advance();
    ExpressionParser parser(cursor_, line_);
    const auto number = parser.parse_parameter_number();
    if (!number) return std::unexpected(number.error());
    if (!cursor_.take('=')) {
      return refuse(ErrorCode::equal_sign_expected, cursor_.span_here(),
                    "\"=\" is missing behind the parameter.", "#number = value");
    }
    if (Accepted value = parser.parse_value(); !value) return value;
    const Span span = cursor_.span_from(begin);
    if (*number) {
      parser.emit({OpCode::store_parameter, span, **number});
    } else {
      parser.emit({OpCode::store_indirect, span});
    }
    return {};
  }

  Accepted bad_letter(char letter) {
    if (letter == 'N') return bad_line_number();
    return refuse(ErrorCode::unexpected_character, cursor_.span_here(),
                  fmt::format("{} is not the letter of a word.", letter),
                  "A B C D E F G H I J K L M P Q R S T X Y Z");
  }

  Accepted bad_line_number() {
    return refuse(ErrorCode::bad_line_number, cursor_.span_here(),
                  "A line number stands at the beginning of the line and has digits only.",
                  "N and digits, before everything else.");
  }

  // O1234 is the program number of Fanuc-like controls and means nothing here; "O100 while" is
  // LinuxCNC's way to write loops and subs.
  Accepted skip_program_number() {
    const char* const begin = cursor_.position();
    cursor_.advance();
    cursor_.skip_blanks();
    const bool has_number = is_digit(cursor_.peek());
    while (is_digit(cursor_.peek())) cursor_.advance();
    const Span span = cursor_.span_from(begin);
    cursor_.skip_blanks();
    const char next = cursor_.peek();
    if (has_number && (cursor_.at_end() || starts_comment(next))) {
      line_.block.note(Habit::program_number, span);
      return parse_items();
    }
    return refuse(ErrorCode::o_word, span, "O-words are not part of this language.",
                  "if, while, sub and gosub without an O number.");
  }

  TextCursor cursor_;
  Line& line_;
};

}  // namespace

LineKeyword find_keyword(std::string_view text) {
  TextCursor cursor(text);
  skip_head(cursor);
  const KeywordMatch match = take_keyword(cursor);
  return {match.keyword, cursor.rest()};
}

Accepted parse_line(std::string_view text, Line& line) {
  line.clear();
  if (text.size() > kMaxLineLength) {
    return refuse(ErrorCode::line_too_long, {kMaxLineLength + 1, 1},
                  fmt::format("This line has {} characters.", text.size()),
                  fmt::format("At most {} characters per line.", kMaxLineLength));
  }
  if (text.size() > kManualLineLength) line.block.note(Habit::long_line, {});
  return LineParser(text, line).parse();
}

}  // namespace cnc::interp
