// The six axes and arrays with one value for each: x y z in mm, a b c in degrees, velocities per
// second. An array is indexed by Axis, never by a bare int.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace cnc::api {

enum class Axis : std::uint8_t { X, Y, Z, A, B, C };

inline constexpr std::array<Axis, 6> kAllAxes{Axis::X, Axis::Y, Axis::Z, Axis::A, Axis::B, Axis::C};

[[nodiscard]] constexpr bool is_rotary(Axis axis) { return axis >= Axis::A; }

/// "X" … "C".
[[nodiscard]] constexpr std::string_view name_of(Axis axis) {
  return std::string_view("XYZABC").substr(static_cast<std::size_t>(axis), 1);
}

/// The axis of a letter in either case; nothing for any other character.
[[nodiscard]] constexpr std::optional<Axis> axis_of_letter(char letter) {
  for (const Axis axis : kAllAxes) {
    const char upper = name_of(axis)[0];
    if (letter == upper || letter == upper - 'A' + 'a') return axis;
  }
  return std::nullopt;
}

template <typename T>
struct AxisArray {
  std::array<T, kAllAxes.size()> values{};

  [[nodiscard]] constexpr T& operator[](Axis axis) {
    return values[static_cast<std::size_t>(axis)];
  }
  [[nodiscard]] constexpr const T& operator[](Axis axis) const {
    return values[static_cast<std::size_t>(axis)];
  }

  friend constexpr bool operator==(const AxisArray&, const AxisArray&) = default;
};

using AxisValues = AxisArray<double>;
using AxisFlags = AxisArray<bool>;

}  // namespace cnc::api
