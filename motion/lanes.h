// Four numbers at once: independent chains of the same arithmetic run side by side in the
// processor, and the compiler finds its vector instructions.
#pragma once

#include <array>
#include <cstddef>

namespace cnc::motion {

struct Lanes {
  std::array<double, 4> lane{};
};

[[nodiscard]] inline Lanes operator+(Lanes a, const Lanes& b) {
  for (std::size_t i = 0; i < 4; ++i) a.lane[i] += b.lane[i];
  return a;
}
[[nodiscard]] inline Lanes operator-(Lanes a, const Lanes& b) {
  for (std::size_t i = 0; i < 4; ++i) a.lane[i] -= b.lane[i];
  return a;
}
[[nodiscard]] inline Lanes operator*(double factor, Lanes a) {
  for (std::size_t i = 0; i < 4; ++i) a.lane[i] *= factor;
  return a;
}
[[nodiscard]] inline double dot(const Lanes& a, const Lanes& b) {
  return (a.lane[0] * b.lane[0] + a.lane[1] * b.lane[1]) +
         (a.lane[2] * b.lane[2] + a.lane[3] * b.lane[3]);
}
[[nodiscard]] inline double square(const Lanes& a) { return dot(a, a); }

}  // namespace cnc::motion
