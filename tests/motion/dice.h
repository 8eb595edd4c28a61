// Random paths for property tests; a seed gives the same path everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "motion/curve.h"

namespace cnc::motion::test {

/// Seeded source of paths.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  /// Spread evenly over the orders of magnitude.
  double scale(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

 private:
  std::mt19937 engine_;
};

inline ArcShape random_arc(Dice& dice, const Position& start, double size) {
  ArcShape arc;
  arc.plane = static_cast<Plane>(dice.pick(3));
  const PlaneAxes axes = axes_of(arc.plane);
  const double direction = dice.between(-3.14, 3.14);
  const double radius = dice.scale(size * 0.05, size);
  arc.first_centre = start[axes.first] + radius * std::cos(direction);
  arc.second_centre = start[axes.second] + radius * std::sin(direction);
  const double end = dice.between(-3.14, 3.14);
  // Programs are rounded: the end is off the circle by up to 0.5 µm.
  const double rounded = radius + dice.between(-5e-4, 5e-4) * std::min(1.0, radius);
  arc.end = start;
  arc.end[axes.first] = arc.first_centre + rounded * std::cos(end);
  arc.end[axes.second] = arc.second_centre + rounded * std::sin(end);
  if (dice.chance(0.5)) arc.end[axes.third] += dice.between(-size, size);
  if (dice.chance(0.2)) arc.end[Axis::A] += dice.between(-30.0, 30.0);
  arc.turns = (dice.chance(0.5) ? 1 : -1) * (1 + dice.pick(2));
  return arc;
}

}  // namespace cnc::motion::test
