#include "interpreter/operators.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

// An operator that begins like another stands before it.
constexpr auto kBinaryOperators = std::to_array<BinaryOperator>({
    {"**", OpCode::power, Precedence::power},
    {"*", OpCode::multiply, Precedence::product},
    {"/", OpCode::divide, Precedence::product},
    {"mod", OpCode::modulo, Precedence::product},
    {"+", OpCode::add, Precedence::sum},
    {"-", OpCode::subtract, Precedence::sum},
    {"and", OpCode::logical_and, Precedence::sum},
    {"or", OpCode::logical_or, Precedence::sum},
    {"xor", OpCode::logical_xor, Precedence::sum},
    {"band", OpCode::bit_and, Precedence::sum},
    {"bor", OpCode::bit_or, Precedence::sum},
    {"bxor", OpCode::bit_xor, Precedence::sum},
    {"<<", OpCode::shift_left, Precedence::sum},
    {">>", OpCode::shift_right, Precedence::sum},
    {"<=", OpCode::less_equal, Precedence::comparison},
    {"<>", OpCode::not_equal, Precedence::comparison},
    {"<", OpCode::less, Precedence::comparison},
    {">=", OpCode::greater_equal, Precedence::comparison},
    {">", OpCode::greater, Precedence::comparison},
    {"==", OpCode::equal, Precedence::comparison},
});

constexpr auto kFunctions = std::to_array<Function>({
    {"abs", OpCode::abs},
    {"acos", OpCode::acos},
    {"asin", OpCode::asin},
    {"atan", OpCode::atan},
    {"cos", OpCode::cos},
    {"exists", OpCode::name_exists},
    {"exp", OpCode::exp},
    {"fix", OpCode::fix},
    {"fup", OpCode::fup},
    {"int", OpCode::int_part},
    {"ln", OpCode::ln},
    {"not", OpCode::logical_not},
    {"round", OpCode::round},
    {"sin", OpCode::sin},
    {"sqrt", OpCode::sqrt},
    {"tan", OpCode::tan},
});

constexpr double kDegree = std::numbers::pi / 180.0;

// Values that a program computes in two ways differ by rounding; a loop that ends at [#1 == 1]
// after ten steps of 0.1 has to end. 1e-6 is 1 nm, as in LinuxCNC. All comparisons share it, so
// that of
// <, == and > always exactly one is true.
constexpr double kEqualWithin = 1e-6;

// The bitwise operators see whole numbers that a double holds exactly.
constexpr double kMaxBits = 9007199254740992.0;  // 2^53
constexpr std::int64_t kMaxShift = 52;

[[nodiscard]] constexpr double truth(bool value) { return value ? 1.0 : 0.0; }

[[nodiscard]] bool begins_with(std::string_view text, std::string_view lower) {
  return text.size() >= lower.size() &&
         std::ranges::equal(text.substr(0, lower.size()), lower, {}, upper, upper);
}

// Apart from finite(), so that this is small enough to be inlined.
[[gnu::noinline]] std::unexpected<Refusal> not_finite(Span span) {
  return refuse(ErrorCode::result_not_finite, span,
                "The result is too large or not a number at all.");
}

[[nodiscard]] inline Parsed<double> finite(double value, Span span) {
  if (std::isfinite(value)) return value;
  return not_finite(span);
}

[[nodiscard]] std::unexpected<Refusal> bad_argument(std::string_view name, double value,
                                                    std::string allowed, Span span) {
  return refuse(ErrorCode::argument_out_of_range, span,
                fmt::format("{}[{:.10g}] does not exist.", name, value), std::move(allowed));
}

[[nodiscard]] Parsed<std::int64_t> bits_of(double value, Span span) {
  if (value == std::floor(value) && std::abs(value) <= kMaxBits) {
    return static_cast<std::int64_t>(value);
  }
  return refuse(ErrorCode::whole_number_expected, span,
                fmt::format("{:.10g} is not a whole number.", value),
                "Bitwise operators and shifts work on whole numbers up to 2 to the power of 53.");
}

[[nodiscard]] Parsed<double> apply_bitwise(OpCode code, double left, double right, Span span) {
  const auto a = bits_of(left, span);
  if (!a) return std::unexpected(a.error());
  const auto b = bits_of(right, span);
  if (!b) return std::unexpected(b.error());
  if (code == OpCode::bit_and) return static_cast<double>(*a & *b);
  if (code == OpCode::bit_or) return static_cast<double>(*a | *b);
  if (code == OpCode::bit_xor) return static_cast<double>(*a ^ *b);
  if (*b < 0 || *b > kMaxShift) {
    return refuse(ErrorCode::argument_out_of_range, span,
                  fmt::format("A shift by {} places is not possible.", *b), "0 to 52 places.");
  }
  // Scaling by a power of two is exact and, unlike <<, defined for negative numbers too.
  const auto places = static_cast<int>(*b);
  if (code == OpCode::shift_left) return finite(std::ldexp(left, places), span);
  return std::floor(std::ldexp(left, -places));
}

[[nodiscard]] Parsed<double> modulo(double left, double right, Span span) {
  if (right == 0.0) {
    return refuse(ErrorCode::division_by_zero, span, "MOD 0 does not exist.",
                  "A divisor other than 0.");
  }
  const double remainder = std::fmod(left, right);
  return remainder < 0.0 ? remainder + std::abs(right) : remainder;  // never negative, as in NIST
}

[[nodiscard]] Parsed<double> divide(double left, double right, Span span) {
  if (right != 0.0) return finite(left / right, span);
  return refuse(ErrorCode::division_by_zero, span, "Division by zero.", "A divisor other than 0.");
}

[[nodiscard]] Parsed<double> power(double base, double exponent, Span span) {
  if (base < 0.0 && exponent != std::floor(exponent)) {
    return refuse(
        ErrorCode::argument_out_of_range, span,
        fmt::format("A negative number ({:.10g}) has no power of {:.10g}.", base, exponent),
        "A whole exponent, or a base that is not negative.");
  }
  return finite(std::pow(base, exponent), span);
}

}  // namespace

const BinaryOperator* operator_at(std::string_view text) {
  const auto row = std::ranges::find_if(
      kBinaryOperators, [&](const BinaryOperator& op) { return begins_with(text, op.text); });
  return row == kBinaryOperators.end() ? nullptr : &*row;
}

const Function* find_function(std::string_view name) {
  const auto row = std::ranges::find_if(kFunctions, [&](const Function& function) {
    return name.size() == function.name.size() && begins_with(name, function.name);
  });
  return row == kFunctions.end() ? nullptr : &*row;
}

std::string function_names() {
  std::string names;
  for (const Function& function : kFunctions) {
    if (!names.empty()) names += ' ';
    names += function.name;
  }
  return names;
}

Parsed<double> apply_unary(OpCode code, double x, Span span) {
  switch (code) {
    case OpCode::negate:
      return -x;
    case OpCode::abs:
      return std::abs(x);
    case OpCode::acos:
      if (std::abs(x) > 1.0) return bad_argument("ACOS", x, "-1 to 1.", span);
      return std::acos(x) / kDegree;
    case OpCode::asin:
      if (std::abs(x) > 1.0) return bad_argument("ASIN", x, "-1 to 1.", span);
      return std::asin(x) / kDegree;
    case OpCode::cos:
      return std::cos(x * kDegree);
    case OpCode::exp:
      return finite(std::exp(x), span);
    case OpCode::fix:
      return std::floor(x);
    case OpCode::fup:
      return std::ceil(x);
    case OpCode::int_part:
      return std::trunc(x);
    case OpCode::ln:
      if (x <= 0.0) return bad_argument("LN", x, "A number above 0.", span);
      return std::log(x);
    case OpCode::logical_not:
      return truth(x == 0.0);
    case OpCode::round:
      return std::round(x);
    case OpCode::sin:
      return std::sin(x * kDegree);
    case OpCode::sqrt:
      if (x < 0.0) return bad_argument("SQRT", x, "A number that is not negative.", span);
      return std::sqrt(x);
    case OpCode::tan:
      return finite(std::tan(x * kDegree), span);
    default:
      break;
  }
  return refuse(ErrorCode::internal_error, span, "Not a unary operation.");
}

Parsed<double> apply_binary(OpCode code, double a, double b, Span span) {
  switch (code) {
    case OpCode::power:
      return power(a, b, span);
    case OpCode::multiply:
      return finite(a * b, span);
    case OpCode::divide:
      return divide(a, b, span);
    case OpCode::modulo:
      return modulo(a, b, span);
    case OpCode::add:
      return finite(a + b, span);
    case OpCode::subtract:
      return finite(a - b, span);
    case OpCode::logical_and:
      return truth(a != 0.0 && b != 0.0);
    case OpCode::logical_or:
      return truth(a != 0.0 || b != 0.0);
    case OpCode::logical_xor:
      return truth((a != 0.0) != (b != 0.0));
    case OpCode::less:
      return truth(a < b - kEqualWithin);
    case OpCode::less_equal:
      return truth(a <= b + kEqualWithin);
    case OpCode::greater:
      return truth(a > b + kEqualWithin);
    case OpCode::greater_equal:
      return truth(a >= b - kEqualWithin);
    case OpCode::equal:
      return truth(std::abs(a - b) <= kEqualWithin);
    case OpCode::not_equal:
      return truth(std::abs(a - b) > kEqualWithin);
    case OpCode::atan:
      return std::atan2(a, b) / kDegree;
    case OpCode::bit_and:
    case OpCode::bit_or:
    case OpCode::bit_xor:
    case OpCode::shift_left:
    case OpCode::shift_right:
      return apply_bitwise(code, a, b, span);
    default:
      break;
  }
  return refuse(ErrorCode::internal_error, span, "Not a binary operation.");
}

}  // namespace cnc::interp
