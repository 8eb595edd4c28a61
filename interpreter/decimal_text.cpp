#include "interpreter/decimal_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <string_view>

namespace cnc::interp {
namespace {

constexpr std::uint64_t kMillion = 1'000'000;

/// `magnitude` in millionths; nothing where a multiplication cannot tell. Below 2^40 a product is
/// off by at most 2^-14, so only a fraction that near to one half could be rounded the wrong way.
[[nodiscard]] std::optional<std::uint64_t> millionths(double magnitude) {
  constexpr double kLargest = 1e6;
  constexpr double kDoubtful = 1e-4;                 // more than 2^-14
  if (!(magnitude < kLargest)) return std::nullopt;  // NaN too
  const double product = magnitude * static_cast<double>(kMillion);
  const auto whole = static_cast<std::uint64_t>(product);
  const double fraction = product - static_cast<double>(whole);
  if (std::abs(fraction - 0.5) < kDoubtful) return std::nullopt;
  return fraction < 0.5 ? whole : whole + 1;
}

void append_millionths(std::string& text, std::uint64_t count, bool negative) {
  const fmt::format_int whole(count / kMillion);
  const fmt::format_int decimals(count % kMillion + kMillion);  // a 1 in the place of the point
  std::array<char, 16> digits;
  char* end = digits.data();
  if (negative) *end++ = '-';
  end = std::copy_n(whole.data(), whole.size(), end);
  *end++ = '.';
  end = std::copy_n(decimals.data() + 1, decimals.size() - 1, end);
  text.append(digits.data(), end);
}

void append_by_library(std::string& text, double value) {
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{:.6f}", std::abs(value));
  const bool is_zero = std::string_view(text).substr(begin) == "0.000000";
  if (value < 0.0 && !is_zero) text.insert(begin, 1, '-');
}

}  // namespace

void append_six_decimals(std::string& text, double value) {
  if (const auto count = millionths(std::abs(value))) {
    append_millionths(text, *count, value < 0.0 && *count != 0);
  } else {
    append_by_library(text, value);
  }
}

}  // namespace cnc::interp
