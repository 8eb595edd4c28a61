// A cell of the third-order speed plan: a stretch of the path on which x = (du/dt)² is a quadratic
// of u, and what the limits of the axes mean for it.
//
// With w = x'/2 = d²u/dt² the motion of an axis is (' = d/du)
//
//   velocity      q' √x
//   acceleration  q' w + q'' x
//   jerk          √x (q' w' + 3 q'' w + q''' x)
//
// (Debrouwere et al., "Time-optimal path following for robots with convex-concave constraints using
// sequential convex programming", IEEE T-RO 29, 2013.) q' and x are quadratics here, so that the
// acceleration is a cubic of u and the jerk divided by √x a quadratic. Their Bernstein coefficients
// are linear in those of x, and a polynomial lies between its smallest and its largest coefficient:
// keeping the coefficients within the limits keeps every instant within them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "motion/path_interval.h"

namespace cnc::motion {

/// Bernstein coefficients of x over a cell: begin, middle, end.
using CellX = std::array<double, 3>;

/// value = row · x.
using CellRow = std::array<double, 3>;

/// One axis, divided by its limits. The first acceleration coefficient of a cell is the last one of
/// the cell before.
struct AxisRows {
  std::array<CellRow, 3> acceleration;
  std::array<CellRow, 3> jerk;  ///< of jerk / √x
};

/// The worst axis of a stretch, limit by derivative; infinite where the derivative is zero.
struct Reach {
  double a_first = std::numeric_limits<double>::infinity();   ///< A / |q'|
  double a_second = std::numeric_limits<double>::infinity();  ///< A / |q''|
  double j_first = std::numeric_limits<double>::infinity();
  double j_second = std::numeric_limits<double>::infinity();
  double j_third = std::numeric_limits<double>::infinity();

  /// The worst of both.
  void include(const Reach& other);

  /// Largest x at the end of a constant-jerk start from rest over `length`: u = j t³/6, so that
  /// x = c u^(4/3), w = (2/3) x/u, w' = (2/9) x/u², acceleration c u^(1/3) ((2/3) q' + q'' u) and
  /// jerk c^(3/2) ((2/9) q' + 2 q'' u + q''' u²). A stop is the mirror image.
  [[nodiscard]] double standstill_x(double length) const;
  /// Largest constant x with `part` of the limits.
  [[nodiscard]] double cruise_x(double part) const;
  /// An acceleration d²u/dt² that the limits allow beside cruise_x(½).
  [[nodiscard]] double moderate_w(double x) const;
};

struct SpeedCell {
  double length = 0.0;
  std::uint64_t interval = 0;
  double start = 0.0;  ///< in the interval

  std::size_t axes = 0;  ///< that move
  std::array<AxisRows, kAxisCount> rows;
  Reach reach;
  double machine_x = std::numeric_limits<double>::infinity();  ///< largest x for the axes' velocity
  double feed_x = 0.0;                                         ///< largest x for the feed at 100 %
  Override override = Override::feed;
};

/// Share of the limits that the plan does not count on: half of it may be used up by what a
/// finished plan leaves (kUsageOfPlan), the rest is for the setpoints made of it.
inline constexpr double kThirdOrderReserve = 2e-3;
inline constexpr double kUsageOfPlan = 1.0 + 0.5 * kThirdOrderReserve;

[[nodiscard]] SpeedCell make_cell(const PathInterval& interval, double start, double length,
                                  const JerkLimits& limits);

/// The larger one; not a number if one of them is none.
[[nodiscard]] inline double larger(double a, double b) { return a > b || std::isnan(a) ? a : b; }

/// Largest part of the acceleration and jerk limits (less the reserve) that is used; infinite or
/// not a number where x is not positive and finite.
[[nodiscard]] double usage_of(const SpeedCell& cell, const CellX& x);

/// Gradient and curvature of a function of a cell's x.
struct CellModel {
  std::array<double, 3> gradient{};
  std::array<double, 6> curvature{};  ///< 00 01 02 11 12 22

  /// A function of row · x with this slope and curvature.
  void add(const CellRow& row, double slope, double bend) {
    const auto& [a, b, c] = row;
    gradient[0] += slope * a;
    gradient[1] += slope * b;
    gradient[2] += slope * c;
    curvature[0] += bend * a * a;
    curvature[1] += bend * a * b;
    curvature[2] += bend * a * c;
    curvature[3] += bend * b * b;
    curvature[4] += bend * b * c;
    curvature[5] += bend * c * c;
  }
};

/// How hard a limit is defended in a round.
struct Defence {
  double weight;     ///< of the barrier
  double least;      ///< slack below which it is relaxed
  double reference;  ///< √x that makes the slack of jerk / √x a part of the limit
};

/// The barrier of acceleration and jerk, and its gradient and curvature added to `model`. The
/// curvature leaves out that of 1/√x, whose sign would only help.
[[nodiscard]] double barrier(const SpeedCell& cell, const CellX& x, const Defence& defence);
void add_barrier(const SpeedCell& cell, const CellX& x, const Defence& defence, CellModel& model);

}  // namespace cnc::motion
