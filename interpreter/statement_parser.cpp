#include "interpreter/statement_parser.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "interpreter/comment_parser.h"
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

/// Of Eding CNC 4.02 and 4.03, which macro files of those versions contain.
constexpr auto kLaterStatements =
    std::to_array<std::string_view>({"exec", "gettoolinfo", "modbus", "zhccheck", "zhcinitex"});

[[nodiscard]] bool equals(std::string_view text, std::string_view lower) {
  return std::ranges::equal(text, lower, {}, upper, upper);
}

[[nodiscard]] bool is_later(std::string_view name) {
  return std::ranges::any_of(kLaterStatements,
                             [&](std::string_view later) { return equals(name, later); });
}

[[nodiscard]] KeywordMatch keyword_named(std::string_view name) {
  if (name.size() < 2) return {};
  const auto has_name = [&](const auto& row) { return equals(name, row.name); };
  if (const auto row = std::ranges::find_if(kKeywords, has_name); row != kKeywords.end()) {
    return {.keyword = &*row};
  }
  const auto specials = special_statements();
  const auto row = std::ranges::find_if(specials, has_name);
  if (row == specials.end()) return {};
  return {.special = &*row};
}

[[nodiscard]] std::string statement_names() {
  std::string names;
  for (const Keyword& keyword : kKeywords) names.append(keyword.name).append(" ");
  for (const SpecialStatement& special : special_statements()) {
    names.append(special.name).append(" ");
  }
  names.pop_back();
  return names;
}

/// The keyword's letters: "end if" may be written apart.
[[nodiscard]] std::string_view keyword_text(TextCursor cursor, std::array<char, 16>& joined) {
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

[[nodiscard]] bool is_name_character(char c) {
  // Bytes of UTF-8 and Latin-1 letters belong to names: macros are written in many languages.
  return is_letter(c) || is_digit(c) || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

[[nodiscard]] bool ends_bare_word(char c) {
  return is_blank(c) || c == '\0' || c == ',' || c == '"' || c == ';' || c == '(';
}

class StatementParser {
 public:
  StatementParser(TextCursor& cursor, Line& line) : cursor_(cursor), line_(line) {}

  Accepted parse() {
    const std::string_view letters = cursor_.letters();
    const Span span = cursor_.span_here(letters.size());
    const KeywordMatch match = take_keyword(cursor_);
    if (!match) {
      return refuse(
          ErrorCode::unknown_statement, span,
          fmt::format("\"{}\" is {}.", letters,
                      is_later(letters)
                          ? "a statement of versions behind 4.01, which are not this language"
                          : "not a statement that this interpreter knows"),
          statement_names());
    }
    line_.special = match.special;
    line_.statement = match.keyword ? match.keyword->statement : Statement::special;
    if (match.keyword) line_.text_kind = match.keyword->text_kind;
    if (line_.optional && steers(line_.statement)) {
      return refuse(ErrorCode::block_delete_on_flow, span,
                    fmt::format("{} cannot be skipped by block delete.", letters),
                    "\"/\" before words, gosub and statements without a counterpart only.");
    }
    return parse_arguments(span);
  }

 private:
  Accepted parse_arguments(Span statement) {
    switch (line_.statement) {
      case Statement::if_begin:
      case Statement::while_begin:
        return parse_condition();
      case Statement::sub_begin:
      case Statement::gosub:
        return parse_name();
      case Statement::message:
        return parse_message();
      case Statement::special:
        return parse_special(statement);
      case Statement::block:
      case Statement::if_else:
      case Statement::if_end:
      case Statement::while_end:
      case Statement::sub_end:
        break;
    }
    note_text_behind();
    return {};
  }

  /// Macros write notes behind else and end….
  void note_text_behind() {
    cursor_.skip_blanks();
    if (cursor_.at_end() || starts_comment(cursor_.peek())) return;
    line_.block.note(Habit::text_behind_statement, cursor_.span_here(cursor_.rest().size()));
  }

  Accepted parse_condition() {
    ExpressionParser parser(cursor_, line_);
    cursor_.skip_blanks();
    if (Accepted condition = parser.parse_bracketed(); !condition) return condition;
    parser.emit({OpCode::store_condition, {}});
    cursor_.skip_blanks();
    const Span bracket = cursor_.span_here();
    while (cursor_.take(']')) line_.block.note(Habit::extra_bracket, bracket);
    if (const std::string_view word = cursor_.letters(); equals(word, "then")) {
      cursor_.advance(word.size());
    }
    return parse_trailing_comment();
  }

  Accepted parse_trailing_comment() {
    cursor_.skip_blanks();
    if (cursor_.at_end()) return {};
    if (!starts_comment(cursor_.peek())) {
      return refuse(ErrorCode::unexpected_character, cursor_.span_here(cursor_.rest().size()),
                    "Only a comment can follow here.", "One statement per line.");
    }
    Accepted comment = parse_comment(cursor_, line_);
    line_.block.drop_step(Step::comment);  // of no interest where it may run a million times
    return comment;
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
  Accepted parse_message() {
    ExpressionParser parser(cursor_, line_);
    while (skip_to_argument()) {
      if (cursor_.peek() == '%') {  // a printf directive that Eding CNC takes and does not use
        line_.block.note(Habit::format_directive, cursor_.span_here(cursor_.rest().size()));
        return {};
      }
      if (Accepted piece = parse_piece(parser); !piece) return piece;
    }
    return {};
  }

  Accepted parse_piece(ExpressionParser& parser) {
    if (cursor_.peek() == '"') {
      const auto text = take_quoted();
      if (!text) return std::unexpected(text.error());
      parser.emit({OpCode::append_text, {}, static_cast<std::int32_t>(line_.pieces.size())});
      line_.pieces.push_back(*text);
      return {};
    }
    if (Accepted value = parser.parse_value(); !value) return value;
    parser.emit({OpCode::append_value, {}});
    return {};
  }

  Accepted parse_special(Span statement) {
    ExpressionParser parser(cursor_, line_);
    while (skip_to_argument()) {
      if (Accepted argument = parse_argument(parser); !argument) return argument;
    }
    if (fits(*line_.special, line_.arguments)) return {};
    return refuse(ErrorCode::statement_argument, statement,
                  fmt::format("{} is written with something else behind it.", line_.special->name),
                  std::string(line_.special->usage));
  }

  Accepted parse_argument(ExpressionParser& parser) {
    const char* const begin = cursor_.position();
    Argument argument;
    if (cursor_.peek() == '"') {
      const auto text = take_quoted();
      if (!text) return std::unexpected(text.error());
      argument = {.is_text = true, .text = *text};
    } else if (starts_bare_word()) {
      while (!ends_bare_word(cursor_.peek())) cursor_.advance();
      argument = {.is_text = true, .text = {begin, cursor_.position()}};
    } else {
      if (Accepted value = parse_argument_value(parser); !value) return value;
      const auto index = static_cast<std::int32_t>(line_.arguments.size());
      parser.emit({OpCode::store_argument, {}, index});
    }
    argument.span = cursor_.span_from(begin);
    line_.arguments.push_back(argument);
    return {};
  }

  // In words blanks may stand within a number; here they part one argument from the next.
  Accepted parse_argument_value(ExpressionParser& parser) {
    const char* const begin = cursor_.position();
    const char* end = begin;
    while (end != cursor_.end() && !ends_bare_word(*end)) ++end;
    const bool negative = *begin == '-';
    const char* const digits = negative ? begin + 1 : begin;
    const ScannedNumber number = scan_number(digits, end);
    if (number.end != end || end == digits) return parser.parse_value();
    cursor_.move_to(end);
    parser.emit({OpCode::push_number, {}, 0, negative ? -number.value : number.value});
    return {};
  }

  [[nodiscard]] bool starts_bare_word() const {
    const char c = cursor_.peek();
    if (c == '/' || c == '\\' || c == '_' || static_cast<unsigned char>(c) >= 0x80) return true;
    if (c == '.') return cursor_.rest().size() > 1 && !is_digit(cursor_.rest()[1]);
    if (!is_letter(c)) return false;
    TextCursor ahead = cursor_;
    const std::string_view letters = ahead.letters();
    ahead.advance(letters.size());
    ahead.skip_blanks();
    return find_function(letters) == nullptr || ahead.peek() != '[';
  }

  /// Behind blanks and commas; false at the end or a comment.
  [[nodiscard]] bool skip_to_argument() {
    while (cursor_.take(',')) {
    }
    return !cursor_.at_end() && !starts_comment(cursor_.peek());
  }

  Parsed<std::string_view> take_quoted() {
    const std::string_view rest = cursor_.rest();
    const std::size_t end = rest.find('"', 1);
    if (end == std::string_view::npos) {
      return refuse(ErrorCode::text_not_closed, cursor_.span_here(rest.size()),
                    "This text is not closed.", "A second quotation mark.");
    }
    cursor_.advance(end + 1);
    return rest.substr(1, end - 1);
  }

  TextCursor& cursor_;
  Line& line_;
};

}  // namespace

KeywordMatch take_keyword(TextCursor& cursor) {
  std::array<char, 16> joined;
  const std::string_view name = keyword_text(cursor, joined);
  const KeywordMatch match = keyword_named(name);
  if (!match) return {};
  for (std::size_t letters = 0; letters < name.size(); cursor.advance()) {
    if (is_letter(cursor.peek())) ++letters;
  }
  return match;
}

std::string_view leading_name(std::string_view rest) {
  TextCursor cursor(rest);
  cursor.skip_blanks();
  const char* const begin = cursor.position();
  while (is_name_character(cursor.peek())) cursor.advance();
  return {begin, cursor.position()};
}

Accepted parse_statement(TextCursor& cursor, Line& line) {
  return StatementParser(cursor, line).parse();
}

}  // namespace cnc::interp
