// What tests do with setpoints: draw them, judge the cubics that a controller would execute, and
// measure how far they are from the programmed path.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/planner.h"

namespace cnc::motion::test {

[[nodiscard]] Position xyz(double x, double y, double z = 0.0);

/// 100 mm/s and 500 mm/s² on X Y Z (the limits of the reference figures), 360 deg/s and 1800 deg/s²
/// on A B C.
[[nodiscard]] AxisLimits reference_limits();
[[nodiscard]] PlannerSettings reference_settings();
[[nodiscard]] MoveOptions feed_of(double feed);
[[nodiscard]] MoveOptions rapid();

/// A recorded motion.
struct Trajectory {
  Position start;
  std::vector<Setpoint> setpoints;

  [[nodiscard]] double duration() const;
  [[nodiscard]] const Position& end() const;
};

/// All setpoints until next() has nothing more.
[[nodiscard]] Trajectory draw_all(Planner& planner);

/// The largest part of its limit that any axis uses, over every cubic: 1 is exactly at the limit.
struct Usage {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;  ///< of axes that have a limit
};
[[nodiscard]] Usage usage_of(const Trajectory& trajectory, const AxisLimits& limits);

/// The programmed path as exact curves, for measuring distances to it.
class Path {
 public:
  explicit Path(const Position& start) : end_(start) {}
  void add_line(const Position& end);
  void add_arc(const ArcShape& shape);

  [[nodiscard]] const Position& end() const { return end_; }

  /// Largest distance (all six axes, mm and degrees alike) of the cubics, sampled every `step`
  /// seconds, from the path. Follows the path forward, so that crossing it elsewhere does not
  /// count.
  [[nodiscard]] double deviation_of(const Trajectory& trajectory, double step) const;
  /// The same in X Y Z and anywhere on the path, and back from the path to the trajectory: for
  /// motion that does not follow the path exactly.
  [[nodiscard]] double distance_both_ways(const Trajectory& trajectory) const;

 private:
  Position end_;
  std::vector<Curve> curves_;
};

/// Adds to planner and path alike; the move must be accepted.
void add_line(Planner& planner, Path& path, const Position& end, const MoveOptions& options);
void add_arc(Planner& planner, Path& path, const ArcShape& shape, const MoveOptions& options);

}  // namespace cnc::motion::test
