// Judges the motion that a planner made of a path: limits, and the largest distance between what
// was programmed and what was driven, globally and both ways.
#pragma once

#include <algorithm>
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

/// Distance of a point from the line between two others.
[[nodiscard]] double distance_to_segment(const Point& p, const Point& a, const Point& b);

/// A polyline whose nearest point is found through a grid of cells.
class Polyline {
 public:
  explicit Polyline(double cell) : cell_(cell) {}

  /// Goes on from the last point. Distances from this stretch are divided by `allowed`.
  void add(const Point& point, double allowed = 1.0);
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Least distance of `point` from the polyline, over what is allowed there; infinite when it is
  /// farther than the cell size.
  [[nodiscard]] double distance(const Point& point) const;
  /// The same, or something no larger than `enough` that some stretch is near: quick for points in
  /// the order of the path, when only the largest of their distances is wanted.
  [[nodiscard]] double distance(const Point& point, double enough);

 private:
  using Key = std::int64_t;
  /// visit(stretch) for all that may be near, until it answers no.
  template <typename Visit>
  void for_each_near(const Point& point, Visit visit) const;
  [[nodiscard]] double to_stretch(const Point& point, std::size_t i) const;
  [[nodiscard]] Key key_of(const std::array<std::int64_t, 3>& cell) const;

  double cell_;
  std::vector<Point> points_;
  std::vector<double> allowed_;  // of the stretch that begins at a point
  std::unordered_map<Key, std::vector<std::uint32_t>> segments_;  // by cell
  std::size_t near_ = 0;                                          // a stretch that was near
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
  double jerk_ratio = 0.0;  ///< where jerk is limited
  double leap_ratio = 0.0;  ///< of acceleration from one setpoint to the next, of its limit
  double feed_ratio = 0.0;  ///< of the linear axes, at the ends of setpoints
  double shortest = 1.0;    ///< setpoint, s
  Position acceleration{};  ///< at the end of the last setpoint
  double feed_override = 1.0;
  /// The highest since the machine last stood: how soon a path can follow a lower one is not
  /// judged.
  double highest_override = 1.0;

  void take(const Setpoint& setpoint);
  void set_feed_override(double factor) {
    feed_override = factor;
    highest_override = std::max(highest_override, factor);
  }
};

}  // namespace cnc::motion::test
