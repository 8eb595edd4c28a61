#include "interpreter/decimal_text.h"

#include <array>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <string_view>

namespace cnc::interp {
namespace {

constexpr std::uint32_t kMillion = 1'000'000;

/// "00" to "99": two digits at a time.
constexpr auto kPairs = [] {
  std::array<std::array<char, 2>, 100> pairs{};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i] = {static_cast<char>('0' + i / 10), static_cast<char>('0' + i % 10)};
  }
  return pairs;
}();

/// `magnitude` in millionths; nothing where a multiplication cannot tell. Below 2^40 a product is
/// off by at most 2^-14, so only a fraction that near to one half could be rounded the wrong way.
[[nodiscard]] std::optional<std::uint64_t> millionths(double magnitude) {
  constexpr double kLargest = 1e6;
  constexpr double kDoubtful = 1e-4;                 // more than 2^-14
  if (!(magnitude < kLargest)) return std::nullopt;  // NaN too
  const double product = magnitude * kMillion;
  const auto whole = static_cast<std::uint64_t>(product);
  const double fraction = product - static_cast<double>(whole);
  if (std::abs(fraction - 0.5) < kDoubtful) return std::nullopt;
  return fraction < 0.5 ? whole : whole + 1;
}

/// Characters on their way into a text, so that this grows once for several numbers.
class Buffer {
 public:
  explicit Buffer(std::string& text) : text_(text) {}

  void put_separator() {
    *end_++ = ',';
    *end_++ = ' ';
  }
  void put_millionths(std::uint64_t count, bool is_negative) {
    const auto decimals = static_cast<std::uint32_t>(count % kMillion);
    if (is_negative) *end_++ = '-';
    put_whole(static_cast<std::uint32_t>(count / kMillion));
    *end_++ = '.';
    put_pair(decimals / 10'000);
    put_pair(decimals / 100 % 100);
    put_pair(decimals % 100);
    if (characters_.data() + characters_.size() - end_ < kLongest) flush();
  }
  void flush() {
    text_.append(characters_.data(), end_);
    end_ = characters_.data();
  }

 private:
  static constexpr std::ptrdiff_t kLongest = 17;  // ", -1000000.000000"

  void put_pair(std::uint32_t below_100) {
    std::memcpy(end_, kPairs[below_100].data(), 2);
    end_ += 2;
  }
  void put_whole(std::uint32_t number) {
    if (number >= 100) put_whole(number / 100);
    if (number >= 10) {
      put_pair(number % 100);
    } else {
      *end_++ = static_cast<char>('0' + number);
    }
  }

  std::string& text_;
  std::array<char, 128> characters_;
  char* end_ = characters_.data();
};

void append_by_library(std::string& text, double value) {
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{:.6f}", std::abs(value));
  const bool is_zero = std::string_view(text).substr(begin) == "0.000000";
  if (value < 0.0 && !is_zero) text.insert(begin, 1, '-');
}

}  // namespace

void append_six_decimals(std::string& text, std::span<const double> numbers) {
  Buffer buffer(text);
  for (const double& number : numbers) {
    if (&number != numbers.data()) buffer.put_separator();
    if (const auto count = millionths(std::abs(number))) {
      buffer.put_millionths(*count, number < 0.0 && *count != 0);
    } else {
      buffer.flush();
      append_by_library(text, number);
    }
  }
  buffer.flush();
}

}  // namespace cnc::interp
