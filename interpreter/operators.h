// The operators and functions of expressions (manual 3.2.2.3, 3.2.2.4 and 4.2), as tables that the
// parser reads, and what each of them computes.
//
// Precedence. The manual defines three groups, evaluated in this order and from left to right
// within a group: ** ; * / MOD ; + - OR XOR AND. It lists comparisons, bitwise operators and shifts
// without a place. Here bitwise operators and shifts stand in the third group, and comparisons come
// last, so that [#1 + 30 == 60] compares the sum. Beside a comparison OR, XOR and AND come after
// it, so that
// [#1 > 5 AND #2 < 3] means what it says; without one they stand where the manual puts them.
#pragma once

#include <cstdint>
#include <string_view>

#include "interpreter/refusal.h"

namespace cnc::interp {

enum class OpCode : std::uint8_t {
  // values
  push_number,
  load_parameter,  ///< number in `argument`
  load_named,      ///< id in `argument`
  name_exists,     ///< EXISTS[#<name>]: id in `argument`
  load_indirect,   ///< number on the stack
  // unary: one operand
  negate,
  abs,
  acos,
  asin,
  cos,
  exp,
  fix,
  fup,
  int_part,
  ln,
  logical_not,
  round,
  sin,
  sqrt,
  tan,
  // binary: two operands
  power,
  multiply,
  divide,
  modulo,
  add,
  subtract,
  logical_and,
  logical_or,
  logical_xor,
  bit_and,
  bit_or,
  bit_xor,
  shift_left,
  shift_right,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  atan,  ///< ATAN[a]/[b]
  // sinks: where the value goes
  store_word,       ///< letter in `argument`
  store_parameter,  ///< number in `argument`
  store_indirect,   ///< number below the value on the stack
  store_condition,
  append_text,  ///< index of the piece in `argument`
  append_value,
  store_argument,  ///< index in `argument`
};

/// Binding strength; a higher one is evaluated first.
enum class Precedence : std::uint8_t { logical_after_comparison, comparison, sum, product, power };

struct BinaryOperator {
  std::string_view text;  ///< lower case
  OpCode code;
  Precedence precedence;
};
struct Function {
  std::string_view name;  ///< lower case
  OpCode code;
};

/// The operator at the beginning of `text` (without leading blanks), nullptr if there is none.
[[nodiscard]] const BinaryOperator* operator_at(std::string_view text);
[[nodiscard]] const Function* find_function(std::string_view name);
/// "abs acos …" for error texts.
[[nodiscard]] std::string function_names();

[[nodiscard]] constexpr bool is_logical(OpCode code) {
  return code == OpCode::logical_and || code == OpCode::logical_or || code == OpCode::logical_xor;
}

[[nodiscard]] Parsed<double> apply_unary(OpCode code, double operand, Span span);
[[nodiscard]] Parsed<double> apply_binary(OpCode code, double left, double right, Span span);

}  // namespace cnc::interp
