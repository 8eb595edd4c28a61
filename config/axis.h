// The six axes of the machine and a fixed array with one value for each.
//
// Linear axes X Y Z are in millimetres, rotary axes A B C in degrees; velocities are per second.
// An AxisArray is indexed by Axis, never by a bare int, so a loop variable cannot stray into it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace cnc {

enum class Axis : std::uint8_t { X, Y, Z, A, B, C };

inline constexpr std::size_t kAxisCount = 6;
inline constexpr std::array<Axis, kAxisCount> kAllAxes{Axis::X, Axis::Y, Axis::Z,
                                                       Axis::A, Axis::B, Axis::C};
inline constexpr std::array<Axis, 3> kLinearAxes{Axis::X, Axis::Y, Axis::Z};
inline constexpr std::array<Axis, 3> kRotaryAxes{Axis::A, Axis::B, Axis::C};

[[nodiscard]] constexpr std::size_t index_of(Axis axis) { return static_cast<std::size_t>(axis); }
[[nodiscard]] constexpr bool is_rotary(Axis axis) { return axis >= Axis::A; }

/// "X" … "C".
[[nodiscard]] constexpr std::string_view axis_name(Axis axis) {
  return std::string_view("XYZABC").substr(index_of(axis), 1);
}

/// The axis of a letter in either case; nothing for any other character.
[[nodiscard]] constexpr std::optional<Axis> axis_of_letter(char letter) {
  for (const Axis axis : kAllAxes) {
    const char upper = axis_name(axis)[0];
    if (letter == upper || letter == upper - 'A' + 'a') return axis;
  }
  return std::nullopt;
}

/// One value per axis.
template <typename T>
struct AxisArray {
  std::array<T, kAxisCount> values{};

  [[nodiscard]] constexpr T& operator[](Axis axis) { return values[index_of(axis)]; }
  [[nodiscard]] constexpr const T& operator[](Axis axis) const { return values[index_of(axis)]; }

  [[nodiscard]] static constexpr AxisArray filled(const T& value) {
    AxisArray result;
    result.values.fill(value);
    return result;
  }

  friend constexpr bool operator==(const AxisArray&, const AxisArray&) = default;
};

/// A point, displacement, velocity or acceleration: mm and degrees (per second, per second
/// squared).
using Position = AxisArray<double>;

constexpr Position& operator+=(Position& a, const Position& b) {
  for (const Axis axis : kAllAxes) a[axis] += b[axis];
  return a;
}
constexpr Position& operator-=(Position& a, const Position& b) {
  for (const Axis axis : kAllAxes) a[axis] -= b[axis];
  return a;
}
constexpr Position& operator*=(Position& a, double factor) {
  for (const Axis axis : kAllAxes) a[axis] *= factor;
  return a;
}
[[nodiscard]] constexpr Position operator+(Position a, const Position& b) { return a += b; }
[[nodiscard]] constexpr Position operator-(Position a, const Position& b) { return a -= b; }
[[nodiscard]] constexpr Position operator*(Position a, double factor) { return a *= factor; }
[[nodiscard]] constexpr Position operator*(double factor, Position a) { return a *= factor; }

[[nodiscard]] constexpr double dot(const Position& a, const Position& b) {
  double sum = 0.0;
  for (const Axis axis : kAllAxes) sum += a[axis] * b[axis];
  return sum;
}

/// Euclidean length of the X Y Z part, in mm. Coordinates are far from where squares overflow.
[[nodiscard]] inline double linear_length(const Position& p) {
  return std::sqrt(p[Axis::X] * p[Axis::X] + p[Axis::Y] * p[Axis::Y] + p[Axis::Z] * p[Axis::Z]);
}
/// Euclidean length of the A B C part, in degrees.
[[nodiscard]] inline double rotary_length(const Position& p) {
  return std::sqrt(p[Axis::A] * p[Axis::A] + p[Axis::B] * p[Axis::B] + p[Axis::C] * p[Axis::C]);
}

}  // namespace cnc
