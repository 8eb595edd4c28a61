// Reads the values of words, settings, conditions and texts: numbers, #parameters, [expressions]
// and functions (manual 3.2.2), and turns them into code for the evaluator.
#pragma once

#include <string_view>

#include "interpreter/line.h"
#include "interpreter/number_scan.h"
#include "interpreter/parameter_names.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

/// Brackets and signs within one another. Real programs need about ten.
inline constexpr int kMaxNesting = 64;
/// Values that wait while another one is computed.
inline constexpr int kMaxStackDepth = 256;

/// A reading position in the text of a line.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text)
      : begin_(text.data()), next_(text.data()), end_(text.data() + text.size()) {}

  [[nodiscard]] bool at_end() const { return next_ == end_; }
  /// The next character; NUL at the end, which no program contains.
  [[nodiscard]] char peek() const { return at_end() ? '\0' : *next_; }
  void advance(std::size_t count = 1) { next_ += count; }
  void move_to(const char* next) { next_ = next; }
  void skip_blanks() {
    while (next_ != end_ && is_blank(*next_)) ++next_;
  }
  /// Skips blanks and, if it comes next, `c`.
  [[nodiscard]] bool take(char c) {
    skip_blanks();
    if (peek() != c) return false;
    advance();
    return true;
  }

  [[nodiscard]] const char* position() const { return next_; }
  [[nodiscard]] const char* end() const { return end_; }
  [[nodiscard]] std::string_view rest() const { return {next_, end_}; }
  /// The letters that come next.
  [[nodiscard]] std::string_view letters() const {
    const char* last = next_;
    while (last != end_ && is_letter(*last)) ++last;
    return {next_, last};
  }

  /// From `from` (a former position) to here.
  [[nodiscard]] Span span_from(const char* from) const {
    return {static_cast<std::uint16_t>(from - begin_ + 1),
            static_cast<std::uint16_t>(next_ > from ? next_ - from : 1)};
  }
  /// The `length` characters that come next.
  [[nodiscard]] Span span_here(std::size_t length = 1) const {
    return {static_cast<std::uint16_t>(next_ - begin_ + 1), static_cast<std::uint16_t>(length)};
  }

 private:
  const char* begin_;
  const char* next_;
  const char* end_;
};

class ExpressionParser {
 public:
  ExpressionParser(TextCursor& cursor, Line& line) : cursor_(cursor), line_(line) {}

  /// Code that leaves one value on the stack; the cursor moves behind it.
  Accepted parse_value();
  /// The same for "[ … ]" only.
  Accepted parse_bracketed();
  /// "#" has been read: what stands behind it, up to the number. A constant is returned and checked
  /// at once, and so is the id of a name; nothing returned means that code leaves the number on the
  /// stack.
  Parsed<std::optional<std::int32_t>> parse_parameter_number();

  void emit(const Op& op);

 private:
  Accepted parse_primary();
  Accepted parse_function();
  Accepted parse_atan(Span span);
  Accepted parse_exists(Span span);
  Parsed<std::int32_t> parse_name();
  Accepted parse_parameter();
  Accepted parse_binary(Precedence lowest, bool beside_comparison);
  Accepted check_depth() const;

  [[nodiscard]] bool bracket_holds_comparison() const;

  TextCursor& cursor_;
  Line& line_;
  int nesting_ = 0;
  int stack_ = 0;
};

/// `value` as a parameter number, 1 to 5799.
[[nodiscard]] Parsed<std::int32_t> parameter_number(double value, Span span);

}  // namespace cnc::interp
