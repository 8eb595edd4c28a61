// What the harnesses share: the input read as numbers, and what has to hold.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

namespace cnc::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

/// Reads numbers from the input; zeros after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }

  template <std::integral T>
  requires(!std::same_as<T, bool>) T next() {
    T value{};
    const std::size_t size = std::min(left_.size(), sizeof value);
    if (size > 0) std::memcpy(&value, left_.data(), size);
    left_ = left_.subspan(size);
    return value;
  }
  std::uint8_t byte() { return next<std::uint8_t>(); }
  bool flag() { return byte() % 2 != 0; }
  /// 0 … count - 1.
  template <std::integral T = std::uint8_t>
  T below(T count) {
    return static_cast<T>(byte() % count);
  }
  /// Any double, also one that is no number.
  double real() {
    const auto bits = next<std::uint64_t>();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace cnc::fuzz
