#include "interpreter/expression_parser.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "config/parameter_store.h"

namespace cnc::interp {
namespace {

/// What an operation adds to the number of values on the stack.
[[nodiscard]] int stack_effect(OpCode code) {
  if (code == OpCode::append_text) return 0;
  if (code == OpCode::store_indirect) return -2;
  if (code >= OpCode::power) return -1;  // binary operators and the other sinks
  if (code >= OpCode::load_indirect) return 0;
  return 1;
}

[[nodiscard]] Precedence above(Precedence precedence) {
  return static_cast<Precedence>(static_cast<int>(precedence) + 1);
}

[[nodiscard]] Precedence precedence_of(const BinaryOperator& op, bool beside_comparison) {
  return beside_comparison && is_logical(op.code) ? Precedence::logical_after_comparison
                                                  : op.precedence;
}

/// Where the name ends whose "#" stands at `begin`; there if it is a number.
[[nodiscard]] std::size_t end_of_name(std::string_view text, std::size_t begin) {
  const std::size_t next = text.find_first_not_of(" \t", begin + 1);
  if (next == std::string_view::npos || text[next] != '<') return begin;
  return std::min(text.find('>', next), text.size());
}

}  // namespace

Parsed<std::int32_t> parameter_number(double value, Span span) {
  const auto number = whole_number(value);
  if (number && config::ParameterStore::is_valid(*number)) return *number;
  return refuse(ErrorCode::parameter_number_invalid, span,
                fmt::format("#{:.10g} is not a parameter.", value),
                fmt::format("Whole numbers from #{} to #{}.", config::parameter::kFirst,
                            config::parameter::kLast));
}

void ExpressionParser::emit(const Op& op) {
  stack_ += stack_effect(op.code);
  line_.code.push_back(op);
}

Accepted ExpressionParser::check_depth() const {
  // One bracket keeps at most one value waiting per precedence, so this stays ahead of the stack.
  constexpr int kSpare = 8;
  if (nesting_ <= kMaxNesting && stack_ <= kMaxStackDepth - kSpare) return {};
  return refuse(ErrorCode::expression_too_deep, cursor_.span_here(),
                "This expression is nested too deeply.",
                fmt::format("At most {} brackets within one another.", kMaxNesting));
}

Accepted ExpressionParser::parse_value() {
  ++nesting_;
  if (Accepted fits = check_depth(); !fits) return fits;
  cursor_.skip_blanks();
  const char* const begin = cursor_.position();
  const char sign = cursor_.peek();
  Accepted parsed;
  if (sign == '-' || sign == '+') {
    cursor_.advance();
    parsed = parse_value();
    if (parsed && sign == '-') emit({OpCode::negate, cursor_.span_from(begin)});
  } else {
    parsed = parse_primary();
  }
  --nesting_;
  return parsed;
}

Accepted ExpressionParser::parse_primary() {
  const char next = cursor_.peek();
  if (starts_number(next)) {
    const char* const begin = cursor_.position();
    const ScannedNumber number = scan_number(begin, cursor_.end());
    if (number.end != begin) {
      cursor_.move_to(number.end);
      if (!std::isfinite(number.value)) {
        return refuse(ErrorCode::result_not_finite, cursor_.span_from(begin),
                      "This number is too large.");
      }
      emit({OpCode::push_number, cursor_.span_from(begin), 0, number.value});
      return {};
    }
  }
  if (next == '#') return parse_parameter();
  if (next == '[') return parse_bracketed();
  if (is_letter(next)) return parse_function();
  return refuse(ErrorCode::value_expected, cursor_.span_here(), "A value is missing here.",
                "A number, #parameter, [expression] or function[...].");
}

Accepted ExpressionParser::parse_bracketed() {
  const char* const begin = cursor_.position();
  if (!cursor_.take('[')) {
    return refuse(ErrorCode::bracket_expected, cursor_.span_here(),
                  "An expression is missing here.", "An expression in brackets: [ ... ].");
  }
  if (Accepted parsed =
          parse_binary(Precedence::logical_after_comparison, bracket_holds_comparison());
      !parsed) {
    return parsed;
  }
  if (cursor_.take(']')) return {};
  if (cursor_.at_end()) {
    return refuse(ErrorCode::bracket_not_closed, cursor_.span_from(begin),
                  "This bracket is not closed.", "\"]\" at the end of the expression.");
  }
  return refuse(ErrorCode::operator_expected, cursor_.span_here(),
                "An operator or \"]\" is missing here.",
                "** * / mod + - and or xor band bor bxor << >> < <= > >= == <> or ]");
}

// Whether a comparison stands at the level of the bracket that has just been opened. A look ahead
// at the characters is enough: outside of inner brackets only comparisons and shifts are written
// with < > and =.
bool ExpressionParser::bracket_holds_comparison() const {
  int level = 0;
  const std::string_view rest = cursor_.rest();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const char c = rest[i];
    if (c == '#') i = end_of_name(rest, i);
    if (c == '[') ++level;
    if (c == ']' && level-- == 0) return false;
    if (level > 0 || (c != '<' && c != '>' && c != '=')) continue;
    const bool is_shift = c != '=' && i + 1 < rest.size() && rest[i + 1] == c;
    if (!is_shift) return true;
    ++i;
  }
  return false;
}

Accepted ExpressionParser::parse_binary(Precedence lowest, bool beside_comparison) {
  if (Accepted left = parse_value(); !left) return left;
  for (;;) {
    cursor_.skip_blanks();
    const BinaryOperator* op = operator_at(cursor_.rest());
    if (op == nullptr) return {};
    const Precedence precedence = precedence_of(*op, beside_comparison);
    if (precedence < lowest) return {};
    const Span span = cursor_.span_here(op->text.size());
    cursor_.advance(op->text.size());
    if (precedence == Precedence::power) {
      if (Accepted right = parse_value(); !right) return right;
    } else if (Accepted right = parse_binary(above(precedence), beside_comparison); !right) {
      return right;
    }
    emit({op->code, span});
  }
}

Accepted ExpressionParser::parse_function() {
  const std::string_view name = cursor_.letters();
  const Span span = cursor_.span_here(name.size());
  const Function* function = find_function(name);
  if (function == nullptr) {
    return refuse(ErrorCode::unknown_function, span, fmt::format("{} is not a function.", name),
                  function_names());
  }
  cursor_.advance(name.size());
  if (function->code == OpCode::name_exists) return parse_exists(span);
  if (Accepted argument = parse_bracketed(); !argument) return argument;
  if (function->code == OpCode::atan) return parse_atan(span);
  emit({function->code, span});
  return {};
}

// ATAN takes two expressions, ATAN[opposite]/[adjacent], so that it knows the quadrant.
Accepted ExpressionParser::parse_atan(Span span) {
  if (!cursor_.take('/')) {
    return refuse(ErrorCode::bracket_expected, span, "ATAN takes two expressions.",
                  "ATAN[opposite]/[adjacent]");
  }
  if (Accepted divisor = parse_bracketed(); !divisor) return divisor;
  emit({OpCode::atan, span});
  return {};
}

// The one function that takes no value: EXISTS[#<name>] asks whether the name has one.
Accepted ExpressionParser::parse_exists(Span span) {
  const bool has_name = cursor_.take('[') && cursor_.take('#');
  cursor_.skip_blanks();
  if (!has_name || cursor_.peek() != '<') {
    return refuse(ErrorCode::name_expected, span, "EXISTS asks for the name of a parameter.",
                  "EXISTS[#<name>]");
  }
  const auto id = parse_name();
  if (!id) return std::unexpected(id.error());
  if (!cursor_.take(']')) {
    return refuse(ErrorCode::bracket_not_closed, span, "This bracket is not closed.",
                  "EXISTS[#<name>]");
  }
  emit({OpCode::name_exists, span, *id});
  return {};
}

Accepted ExpressionParser::parse_parameter() {
  const char* const begin = cursor_.position();
  cursor_.advance();
  const auto number = parse_parameter_number();
  if (!number) return std::unexpected(number.error());
  if (*number) {
    const OpCode load =
        ParameterNames::is_name(**number) ? OpCode::load_named : OpCode::load_parameter;
    emit({load, cursor_.span_from(begin), **number});
  } else {
    emit({OpCode::load_indirect, cursor_.span_from(begin)});
  }
  return {};
}

/// "<name>" as the id of the name.
Parsed<std::int32_t> ExpressionParser::parse_name() {
  const char* const begin = cursor_.position();
  const std::string_view rest = cursor_.rest();
  const std::size_t end = rest.find('>');
  if (line_.names == nullptr || end == std::string_view::npos) {
    return refuse(ErrorCode::named_parameter, cursor_.span_here(),
                  line_.names == nullptr ? "Named parameters are not part of this language."
                                         : "The name of this parameter is not closed.",
                  line_.names == nullptr ? "A number: #1 to #5799." : "#<name>");
  }
  cursor_.advance(end + 1);
  return line_.names->id_of(rest.substr(1, end - 1), cursor_.span_from(begin));
}

Parsed<std::optional<std::int32_t>> ExpressionParser::parse_parameter_number() {
  cursor_.skip_blanks();
  if (cursor_.peek() == '<') return parse_name();
  const char* const begin = cursor_.position();
  const std::size_t first_op = line_.code.size();
  if (Accepted parsed = parse_value(); !parsed) return std::unexpected(parsed.error());
  const Op& last = line_.code.back();
  if (line_.code.size() != first_op + 1 || last.code != OpCode::push_number) return std::nullopt;

  const auto number = parameter_number(last.number, cursor_.span_from(begin));
  if (!number) return std::unexpected(number.error());
  line_.code.pop_back();
  --stack_;
  return *number;
}

}  // namespace cnc::interp
