// Decimal numbers straight from the program text: the innermost loop of reading G-code.
//
// RS274/NGC numbers (manual 3.2.2.1) have digits, at most one point and no exponent ("E" is a word
// letter), and blanks may stand anywhere, even inside: "0. 12 34" is 0.1234.
#pragma once

#include <array>
#include <cstdint>

namespace cnc::interp {

[[nodiscard]] constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
[[nodiscard]] constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
[[nodiscard]] constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
[[nodiscard]] constexpr char upper(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}
[[nodiscard]] constexpr bool starts_number(char c) { return is_digit(c) || c == '.'; }

struct ScannedNumber {
  double value = 0.0;
  const char* end =
      nullptr;  ///< behind the last character used; where it began if no digit stood there
};

/// The general case: blanks inside, or more digits than a double holds. Correctly rounded.
[[nodiscard]] ScannedNumber scan_long_number(const char* begin, const char* end);

/// Unsigned number at `begin`. The usual case needs no library: a mantissa below 2^53 divided by a
/// power of ten up to 10^22 is two exact doubles and one correctly rounded division (Clinger 1990).
[[nodiscard]] inline ScannedNumber scan_number(const char* begin, const char* end) {
  constexpr std::array kPowersOfTen{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr std::int64_t kMaxDigits = 15;  // any 15 digits are below 2^53

  std::uint64_t mantissa = 0;
  const char* p = begin;
  while (p != end && is_digit(*p))
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p++ - '0');
  std::int64_t digits = p - begin;
  std::size_t decimals = 0;
  if (p != end && *p == '.') {
    const char* const point = p++;
    while (p != end && is_digit(*p)) {
      mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p++ - '0');
    }
    decimals = static_cast<std::size_t>(p - point - 1);
    digits += static_cast<std::int64_t>(decimals);
  }
  const char* next = p;
  while (next != end && is_blank(*next)) ++next;
  const bool goes_on = next != p && next != end && starts_number(*next);
  if (digits == 0 || digits > kMaxDigits || goes_on) return scan_long_number(begin, end);
  const double whole = static_cast<double>(mantissa);
  return {decimals == 0 ? whole : whole / kPowersOfTen[decimals], p};
}

}  // namespace cnc::interp
