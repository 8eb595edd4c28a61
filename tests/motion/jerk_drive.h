// What tests do with a JerkPlan: feed it, drive it, and judge every instant of the motion.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "motion/jerk_plan.h"

namespace cnc::motion::test {

/// 100 mm/s and 500 mm/s² (the limits of the reference figures) and `jerk` on every axis.
[[nodiscard]] JerkLimits jerk_limits(double jerk);

/// A path that turns at random, steps from 0.02 to 5 mm, now and then a long one; in space and with
/// a rotary axis if so wished.
[[nodiscard]] std::vector<Position> random_vertices(std::mt19937& random, int count);

/// The largest part of its limit that any axis uses at any instant.
struct JerkUsage {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double feed = 0.0;
  double leap = 0.0;  ///< of acceleration, from one cell to the next, as a part of its limit

  [[nodiscard]] double worst() const;
};

/// A plan that is fed from a list of intervals as it wants them.
class JerkDrive {
 public:
  JerkDrive(const JerkLimits& limits, std::vector<PathInterval> path)
      : plan(limits), limits_(limits), path_(std::move(path)) {}

  JerkPlan plan;

  /// Appends what is wanted and plans what is due.
  void feed();
  /// Drives to the end of the present cell, or `time` if that is less; samples on the way.
  void step(double time = 1e9);
  /// Until everything is driven, or standing and held.
  void run();

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double length() const;
  [[nodiscard]] int stops() const { return stops_; }
  [[nodiscard]] int failed_plans() const { return failed_plans_; }
  [[nodiscard]] const JerkUsage& usage() const { return usage_; }

 private:
  void sample();
  void sample_leap(const PathMotion& before);
  [[nodiscard]] Position acceleration(const PathMotion& motion) const;

  JerkLimits limits_;
  std::vector<PathInterval> path_;
  std::size_t next_ = 0;
  double time_ = 0.0;
  int stops_ = 0;
  int failed_plans_ = 0;
  JerkUsage usage_;
};

}  // namespace cnc::motion::test
