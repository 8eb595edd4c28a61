// Numbers to bytes and back, least significant byte first, never beyond the end of the memory.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace cnc::hal::cpu5::wire {

/// What does not fit is not written, nor is anything after it: overflow() tells.
class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> memory) : memory_(memory) {}

  template <std::integral T>
  void put(T value) {
    using Bits = std::make_unsigned_t<T>;
    if (overflow_ || memory_.size() - size_ < sizeof(T)) {
      overflow_ = true;
      return;
    }
    auto bits = static_cast<Bits>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      memory_[size_++] = static_cast<std::uint8_t>(bits & 0xFFU);
      if constexpr (sizeof(T) > 1) bits = static_cast<Bits>(bits >> 8);
    }
  }
  void put(bool value) { put(static_cast<std::uint8_t>(value)); }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t free() const { return memory_.size() - size_; }
  [[nodiscard]] bool overflow() const { return overflow_; }
  [[nodiscard]] std::span<const std::uint8_t> written() const { return memory_.first(size_); }

 private:
  std::span<std::uint8_t> memory_;
  std::size_t size_ = 0;
  bool overflow_ = false;
};

/// Beyond the end everything reads as 0, and bad() tells.
class ByteReader {
 public:
  ByteReader() = default;
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::integral T>
  [[nodiscard]] T get() {
    using Bits = std::make_unsigned_t<T>;
    if (bad_ || bytes_.size() - place_ < sizeof(T)) {
      bad_ = true;
      return T{};
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= std::uint64_t{bytes_[place_++]} << (8 * i);
    }
    return static_cast<T>(static_cast<Bits>(bits));
  }
  /// Nothing but 0 and 1 is a truth.
  [[nodiscard]] bool get_bool() {
    const auto value = get<std::uint8_t>();
    bad_ = bad_ || value > 1;
    return value == 1;
  }

  [[nodiscard]] bool at_end() const { return place_ == bytes_.size(); }
  [[nodiscard]] bool bad() const { return bad_; }
  void refuse() { bad_ = true; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t place_ = 0;
  bool bad_ = false;
};

}  // namespace cnc::hal::cpu5::wire
