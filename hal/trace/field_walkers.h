// What becomes of the fields of a record (fields.h): bytes, and the way back; lines of text.
#pragma once

#include <bit>
#include <bitset>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "hal/trace/fields.h"

namespace cnc::hal::trace {

static_assert(std::endian::native == std::endian::little,
              "a trace is written as it lies in memory");

template <typename T>
inline constexpr bool kIsBits = false;
template <std::size_t N>
inline constexpr bool kIsBits<std::bitset<N>> = N <= 64;

template <typename T>
concept Leaf = std::is_arithmetic_v<T> || std::is_enum_v<T> || kIsBits<T>;

/// Goes down to the leaves: Derived has leaf(name, value), and enter(name) and leave() around what
/// has fields of its own.
template <typename Derived>
class FieldWalker {
 public:
  template <typename T>
  void operator()(std::string_view name, T& value) {
    Derived& self = static_cast<Derived&>(*this);
    if constexpr (Leaf<std::remove_const_t<T>>) {
      self.leaf(name, value);
    } else {
      self.enter(name);
      visit_fields(self, value);
      self.leave();
    }
  }
  void enter(std::string_view) {}
  void leave() {}
};

/// Real-time. What does not fit is not written, and overflow() tells.
class Encoder : public FieldWalker<Encoder> {
 public:
  explicit Encoder(std::span<std::byte> memory) : memory_(memory) {}

  template <typename T>
  void leaf(std::string_view, const T& value) {
    if constexpr (kIsBits<T>) {
      put(std::uint64_t{value.to_ullong()});
    } else {
      put(value);
    }
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool overflow() const { return overflow_; }

 private:
  template <typename T>
  void put(T value) {
    overflow_ = overflow_ || memory_.size() - size_ < sizeof value;
    if (overflow_) return;
    std::memcpy(memory_.data() + size_, &value, sizeof value);
    size_ += sizeof value;
  }

  std::span<std::byte> memory_;
  std::size_t size_ = 0;
  bool overflow_ = false;
};

/// Beyond the end, or where a value is none of its type, bad() tells.
class Decoder : public FieldWalker<Decoder> {
 public:
  explicit Decoder(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  void leaf(std::string_view, T& value) {
    if constexpr (kIsBits<T>) {
      value = T(get<std::uint64_t>());
    } else if constexpr (std::is_same_v<T, bool>) {
      const auto byte = get<std::uint8_t>();
      bad_ = bad_ || byte > 1;
      value = byte == 1;
    } else if constexpr (std::is_enum_v<T>) {
      const auto number = get<std::underlying_type_t<T>>();
      bad_ = bad_ || number > static_cast<std::underlying_type_t<T>>(last_of(T{}));
      if (!bad_) value = static_cast<T>(number);
    } else {
      value = get<T>();
    }
  }
  [[nodiscard]] bool bad() const { return bad_; }
  [[nodiscard]] bool at_end() const { return place_ == bytes_.size(); }

 private:
  static constexpr Axis last_of(Axis) { return Axis::C; }
  static constexpr PathStop last_of(PathStop) { return PathStop::stopped; }
  static constexpr LatchEdge last_of(LatchEdge) { return LatchEdge::release; }

  template <typename T>
  [[nodiscard]] T get() {
    T value{};
    bad_ = bad_ || bytes_.size() - place_ < sizeof value;
    if (bad_) return value;
    std::memcpy(&value, bytes_.data() + place_, sizeof value);
    place_ += sizeof value;
    return value;
  }

  std::span<const std::byte> bytes_;
  std::size_t place_ = 0;
  bool bad_ = false;
};

/// Collects `text(name, value)` for each leaf, by its full name "status.position.X".
template <typename Text>
class FieldText : public FieldWalker<FieldText<Text>> {
 public:
  explicit FieldText(Text text) : text_(text) {}

  void enter(std::string_view name) {
    starts_.push_back(path_.size());
    path_ += name;
    path_ += '.';
  }
  void leave() {
    path_.resize(starts_.back());
    starts_.pop_back();
  }
  template <typename T>
  void leaf(std::string_view name, const T& value) {
    text_(path_ + std::string(name), value);
  }

 private:
  Text text_;
  std::string path_;
  std::vector<std::size_t> starts_;
};

}  // namespace cnc::hal::trace
