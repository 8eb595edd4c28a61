// Judges the motion that a planner made of a path: limits, and the largest distance between what
// was programmed and what was driven, globally and both ways.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "config/axis.h"
#include "motion/limits.h"
#include "motion/setpoint.h"

namespace cnc::motion::test {

using Point = std::array<double, 3>;  ///< X Y Z, mm

[[nodiscard]] Point point_of(const Position& position);

/// A polyline whose nearest point is found through a grid of cells.
class Polyline {
 public:
  explicit Polyline(double cell) : cell_(cell) {}

  /// Goes on from the last point.
  void add(const Point& point);
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Distance of `point` from the polyline; infinite when it is farther than the cell size.
  [[nodiscard]] double distance(const Point& point) const;

 private:
  using Key = std::int64_t;
  [[nodiscard]] Key key_of(const std::array<std::int64_t, 3>& cell) const;

  double cell_;
  std::vector<Point> points_;
  std::unordered_map<Key, std::vector<std::uint32_t>> segments_;  // by cell
};

/// Largest distance of the points of `from`, and of points between them, from `to`.
[[nodiscard]] double largest_distance(const Polyline& from, const Polyline& to);

/// Largest velocity and acceleration of any axis over its limit, of the feed over the programmed
/// one, and the time, setpoint by setpoint. Continuity too: a jump shows as an infinite ratio.
struct LimitJudge {
  AxisLimits limits;
  Position position;
  Position velocity;
  double time = 0.0;
  std::size_t setpoints = 0;
  double velocity_ratio = 0.0;
  double acceleration_ratio = 0.0;
  double feed_ratio = 0.0;

  void take(const Setpoint& setpoint);
};

}  // namespace cnc::motion::test
