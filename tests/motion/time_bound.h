// The least time in which a driven path can be driven: the measure of every speed plan.
//
// What is judged are the cubics that a controller executes, whatever plan made them. Along their
// path, with a parameter u, x = (du/dτ)² and w = d²u/dτ², an axis has the velocity q' √x and the
// acceleration q' w + q'' x: linear limits, for which going backward and then forward over a fine
// grid finds the fastest motion (Pham & Pham, "A New Approach to Time-Optimal Path Parameterization
// Based on Reachability Analysis", IEEE T-RO 2018).
//
// On straight stretches u is the distance. On curved ones u is the time of the driven motion: q'
// and q'' are then its velocity and acceleration to the last digit, where curvature computed from
// them would be noise close to a standstill.
//
// X Y Z only. Units: mm, s.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "motion/limits.h"
#include "motion/setpoint.h"

namespace cnc::motion::test {

class TimeBound {
 public:
  /// Told of the fastest motion, step by step: seconds and mm from the begin, and speed in X Y Z.
  using Trace = std::function<void(double time, double way, double speed)>;

  /// `grid`: longest step, in seconds of the driven motion.
  TimeBound(const AxisLimits& limits, const Position& start, double grid = 0.0005,
            Trace trace = {});

  /// In the order of motion, which begins at rest.
  void take(const Setpoint& setpoint);
  /// Once the last setpoint, which ends at rest, has been taken.
  [[nodiscard]] double seconds();
  /// Standstills on a curve that goes on smoothly; the bound stops there too.
  [[nodiscard]] std::size_t stops_on_curves() const { return stops_on_curves_; }

 private:
  using Vector = std::array<double, 3>;

  struct Step {
    double length = 0.0;
    Vector first{};  // q' and q'' half-way
    Vector second{};
    double largest_begin = 0.0;  // x for velocity limits and feed
    double largest_end = 0.0;
    double scale = 1.0;  // x at its begin over x at the end of the step before
    double entry = 0.0;  // largest x at its begin
    double way = 0.0;    // in X Y Z
    double speed = 1.0;  // in X Y Z at its end, over √x
  };
  /// One axis: |w + slope x| <= width.
  struct Row {
    double slope;
    double width;
  };
  void add_straight(const Setpoint& setpoint, const Vector& direction, int parts);
  void add_curved(const Setpoint& setpoint, int parts);
  void begin_at_rest(const Vector& direction, bool straight);
  [[nodiscard]] double largest_at(const Vector& first, double feed) const;
  [[nodiscard]] std::array<Row, 3> rows_of(const Step& step) const;
  [[nodiscard]] double largest_entry(const Step& step, double exit) const;
  [[nodiscard]] double highest_w(const Step& step, double x, double exit) const;
  void solve();

  AxisLimits limits_;
  double grid_;
  Trace trace_;
  Position position_;
  Position velocity_;
  Vector direction_{};     // in which the last setpoint ended
  bool straight_ = false;  // the last setpoint was
  double scale_ = 1.0;     // of the next step
  std::vector<Step> run_;  // since the last stop that the path demands
  double seconds_ = 0.0;
  double way_ = 0.0;
  std::size_t stops_on_curves_ = 0;
};

}  // namespace cnc::motion::test
