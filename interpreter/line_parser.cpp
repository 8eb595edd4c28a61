#include "interpreter/line_parser.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "interpreter/expression_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

constexpr auto kKeywords = std::to_array<Keyword>({
    {"if", Statement::if_begin},
    {"else", Statement::if_else},
    {"endif", Statement::if_end},
    {"while", Statement::while_begin},
    {"endwhile", Statement::while_end},
    {"sub", Statement::sub_begin},
    {"endsub", Statement::sub_end},
    {"gosub", Statement::gosub},
    {"msg", Statement::message, MessageKind::message},
    {"warnmsg", Statement::message, MessageKind::warning},
    {"errmsg", Statement::message, MessageKind::error},
    {"logmsg", Statement::message, MessageKind::log},
});

// Letters of words, table 3-2 of the manual, and E of M54. N and O are read before the words.
constexpr WordSet kWordLetters = words("ABCDEFGHIJKLMPQRSTXYZ");

[[nodiscard]] bool equals(std::string_view text, std::string_view lower) {
  return std::ranges::equal(text, lower, {}, upper, upper);
}

[[nodiscard]] const Keyword* keyword_named(std::string_view name) {
  const auto row =
      std::ranges::find_if(kKeywords, [&](const Keyword& k) { return equals(name, k.name); });
  return row == kKeywords.end() ? nullptr : &*row;
}

[[nodiscard]] std::string keyword_names() {
  std::string names;
  for (const Keyword& keyword : kKeywords) names.append(keyword.name).append(" ");
  names.pop_back();
  return names;
}

/// Two letters side by side begin a keyword, or a word whose value is a function: XSIN[30].
[[nodiscard]] bool is_word_with_function(std::string_view letters) {
  return find_function(letters.substr(1)) != nullptr;
}

struct LineHead {
  bool optional = false;
  bool has_number = false;
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
  head.has_number = is_digit(cursor.peek());
  while (is_digit(cursor.peek())) cursor.advance();
  if (!head.has_number) cursor.move_to(begin);
  cursor.skip_blanks();
  return head;
}

/// The keyword's letters: "end if" may be written apart.
[[nodiscard]] std::string_view keyword_text(const TextCursor& start, std::array<char, 16>& joined) {
  TextCursor cursor = start;
  const std::string_view first = cursor.letters();
  if (!equals(first, "end")) return first;
  cursor.advance(first.size());
  cursor.skip_blanks();
  const std::string_view second = cursor.letters();
  if (second.empty() || first.size() + second.size() > joined.size()) return first;
  const auto middle = std::ranges::copy(first, joined.begin()).out;
  const auto last = std::ranges::copy(second, middle).out;
  return {joined.begin(), last};
}

/// The keyword at the cursor, which moves behind it.
[[nodiscard]] const Keyword* take_keyword(TextCursor& cursor) {
  std::array<char, 16> joined;
  const std::string_view name = keyword_text(cursor, joined);
  const Keyword* keyword = keyword_named(name);
  if (keyword == nullptr) return nullptr;
  for (std::size_t letters = 0; letters < name.size(); cursor.advance()) {
    if (is_letter(cursor.peek())) ++letters;
  }
  return keyword;
}

[[nodiscard]] bool is_name_character(char c) {
  // Bytes of UTF-8 and Latin-1 letters belong to names: macros are written in many languages.
  return is_letter(c) || is_digit(c) || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

class LineParser {
 public:
  LineParser(std::string_view text, Line& line) : cursor_(text), line_(line) {}

  Accepted parse() {
    const LineHead head = skip_head(cursor_);
    line_.optional = head.optional;
    const char first = upper(cursor_.peek());
    if (first == '%') return {};  // begin or end of the tape, nesting data: not for the interpreter
    if (first == 'N') return bad_line_number();
    if (first == 'O') return skip_program_number();
    const std::string_view letters = cursor_.letters();
    if (letters.size() > 1 && !is_word_with_function(letters)) return parse_statement();
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
    if (c == '(') return parse_comment();
    if (c == ';') return parse_rest_as_comment();
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

  // A comment ends at the first ")". Where another "(" stands in it, the writer may have meant more
  // text than that; what follows could then be executed as code, so nothing may follow.
  Accepted parse_comment() {
    const char* const begin = cursor_.position();
    const std::string_view rest = cursor_.rest();
    const std::size_t end = rest.find(')');
    if (end == std::string_view::npos) {
      return refuse(ErrorCode::comment_not_closed, cursor_.span_here(rest.size()),
                    "This comment is not closed.", "\")\" before the end of the line.");
    }
    cursor_.advance(end + 1);
    const Span span = cursor_.span_from(begin);
    const bool nested = rest.substr(1, end).find('(') != std::string_view::npos;
    if (nested && rest.find_first_not_of(" \t\r", end + 1) != std::string_view::npos) {
      return refuse(ErrorCode::comment_nested, span,
                    "A comment within a comment: it is not clear where the outer one ends.",
                    "No \"(\" inside of a comment with code behind it.");
    }
    set_comment(rest.substr(1, end - 1));
    return {};
  }

  Accepted parse_rest_as_comment() {
    set_comment(cursor_.rest().substr(1));
    cursor_.advance(cursor_.rest().size());
    return {};
  }

  void set_comment(std::string_view text) {
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    TextCursor inside(text);
    inside.skip_blanks();
    if (const std::string_view word = inside.letters(); equals(word, "msg")) {
      inside.advance(word.size());
      if (inside.take(',')) {
        inside.skip_blanks();
        line_.block.set_comment({MessageKind::message, inside.rest()});
        return;
      }
    }
    line_.block.set_comment({MessageKind::comment, text});
  }

  Accepted parse_statement() {
    const std::string_view letters = cursor_.letters();
    const Span span = cursor_.span_here(letters.size());
    const Keyword* keyword = take_keyword(cursor_);
    if (keyword == nullptr) {
      return refuse(ErrorCode::unknown_statement, span,
                    fmt::format("\"{}\" is not a statement that this interpreter knows.", letters),
                    keyword_names());
    }
    line_.statement = keyword->statement;
    line_.text_kind = keyword->text_kind;
    if (line_.optional && keyword->statement != Statement::message &&
        keyword->statement != Statement::gosub) {
      return refuse(ErrorCode::block_delete_on_flow, span,
                    fmt::format("{} cannot be skipped by block delete.", letters),
                    "\"/\" before words, gosub and messages only.");
    }
    return parse_argument();
  }

  Accepted parse_argument() {
    switch (line_.statement) {
      case Statement::if_begin:
      case Statement::while_begin:
        return parse_condition();
      case Statement::sub_begin:
      case Statement::gosub:
        return parse_name();
      case Statement::message:
        return parse_text();
      case Statement::block:
      case Statement::if_else:
      case Statement::if_end:
      case Statement::while_end:
      case Statement::sub_end:
        break;
    }
    return {};  // what stands behind else and end… is not read: macros write notes there
  }

  Accepted parse_condition() {
    ExpressionParser parser(cursor_, line_);
    cursor_.skip_blanks();
    if (Accepted condition = parser.parse_bracketed(); !condition) return condition;
    parser.emit({OpCode::store_condition, {}});
    while (cursor_.take(']')) {  // widespread macros have one too many, and Eding CNC takes them
    }
    if (const std::string_view word = cursor_.letters(); equals(word, "then")) {
      cursor_.advance(word.size());
    }
    return parse_trailing_comment();
  }

  Accepted parse_trailing_comment() {
    cursor_.skip_blanks();
    if (cursor_.at_end()) return {};
    const char c = cursor_.peek();
    if (c != '(' && c != ';') return parse_garbage();
    Accepted comment = parse_item();
    line_.block.clear();  // of no interest behind a condition, which may run a million times
    return comment;
  }

  Accepted parse_garbage() {
    return refuse(ErrorCode::unexpected_character, cursor_.span_here(cursor_.rest().size()),
                  "Only a comment can follow here.", "One statement per line.");
  }

  Accepted parse_name() {
    cursor_.skip_blanks();
    line_.name = leading_name(cursor_.rest());
    line_.name_span = cursor_.span_here(std::max<std::size_t>(line_.name.size(), 1));
    if (line_.name.empty()) {
      return refuse(ErrorCode::name_expected, line_.name_span, "The name of the sub is missing.",
                    "Letters, digits and underscores.");
    }
    cursor_.advance(line_.name.size());
    return parse_trailing_comment();
  }

  // Quoted texts and values in any order, with or without commas between them.
  Accepted parse_text() {
    ExpressionParser parser(cursor_, line_);
    for (;;) {
      while (cursor_.take(',')) {
      }
      const char c = cursor_.peek();
      if (cursor_.at_end() || c == ';' || c == '(') return {};
      if (Accepted piece = c == '"' ? parse_quoted(parser) : parse_text_value(parser); !piece) {
        return piece;
      }
    }
  }

  Accepted parse_text_value(ExpressionParser& parser) {
    if (Accepted value = parser.parse_value(); !value) return value;
    parser.emit({OpCode::append_value, {}});
    return {};
  }

  Accepted parse_quoted(ExpressionParser& parser) {
    const std::string_view rest = cursor_.rest();
    const std::size_t end = rest.find('"', 1);
    if (end == std::string_view::npos) {
      return refuse(ErrorCode::text_not_closed, cursor_.span_here(rest.size()),
                    "This text is not closed.", "A second quotation mark.");
    }
    parser.emit({OpCode::append_text, {}, static_cast<std::int32_t>(line_.pieces.size())});
    line_.pieces.push_back(rest.substr(1, end - 1));
    cursor_.advance(end + 1);
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
    if (has_number && (cursor_.at_end() || next == '(' || next == ';')) return parse_items();
    return refuse(ErrorCode::o_word, span, "O-words are not part of this language.",
                  "if, while, sub and gosub without an O number.");
  }

  TextCursor cursor_;
  Line& line_;
};

}  // namespace

KeywordMatch find_keyword(std::string_view text) {
  TextCursor cursor(text);
  skip_head(cursor);
  const Keyword* keyword = take_keyword(cursor);
  return {keyword, cursor.rest()};
}

std::string_view leading_name(std::string_view rest) {
  TextCursor cursor(rest);
  cursor.skip_blanks();
  const char* const begin = cursor.position();
  while (is_name_character(cursor.peek())) cursor.advance();
  return {begin, cursor.position()};
}

Accepted parse_line(std::string_view text, Line& line) {
  line.clear();
  if (text.size() > kMaxLineLength) {
    return refuse(ErrorCode::line_too_long, {kMaxLineLength + 1, 1},
                  fmt::format("This line has {} characters.", text.size()),
                  fmt::format("At most {} characters per line.", kMaxLineLength));
  }
  return LineParser(text, line).parse();
}

}  // namespace cnc::interp
