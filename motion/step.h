// The grid of the speed plan: a step is a stretch of a curve on which d²s/dt² is one constant w,
// or, on a straight line, accelerates, cruises and decelerates.
//
// With x = (ds/dt)² the velocity of an axis is q' √x and its acceleration q' w + q'' x, so that its
// limits are straight lines in the plane of x and w: the time-optimal plan along a given path needs
// no search (reachability analysis; Pham & Pham, "A New Approach to Time-Optimal Path
// Parameterization Based on Reachability Analysis", IEEE T-RO 2018). The limits are kept at both
// ends of a step with its one w; keeping them at the near end only is 0.25 % faster on paper but
// exceeds them by up to 40 % at tight corners. On a cubic the acceleration of an axis is a
// quadratic polynomial along the step, and its three Bézier coefficients bound it: kept within the
// limit, they keep all that lies between.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/axis.h"
#include "motion/curve.h"
#include "motion/limits.h"
#include "motion/setpoint.h"

namespace cnc::motion {

/// The shortest setpoint, s, unless a stop has to be met: controllers cannot use shorter ones well.
inline constexpr double kShortestSetpoint = 0.00025;

/// Steps of a cubic at most, however slowly it is driven: a corner blend is cut into steps at once
/// and has to find room.
inline constexpr std::size_t kMostStepsOfCubic = 128;

/// Part of an axis' acceleration that the plan may leave to the difference between the motion on a
/// curve and the cubic that a setpoint makes of it.
inline constexpr double kCubicReserve = 2.5e-4;

/// Largest distance of a setpoint's cubic from the planned motion, mm.
inline constexpr double kCubicTolerance = 1e-6;

/// What a limit says about w and x: |w + slope * x| <= width.
struct Row {
  double slope;
  double width;
};

struct Step {
  std::uint64_t piece = 0;  ///< index in the track
  double start = 0.0;       ///< curve parameter at its begin
  double length = 0.0;
  double distance = 0.0;  ///< along the whole track, at its begin
  bool straight = true;
  bool cubic = false;        ///< q is a cubic polynomial of s
  bool stop_before = false;  ///< the machine stands still at its begin

  Position tangent[2];    ///< q' at both ends
  Position bend[2];       ///< q'' at both ends
  Position acceleration;  ///< what may be used of each axis' limit

  /// The limits of the axes on a curve, three rows for each that moves at most; at the step's
  /// begin.
  std::array<Row, 3 * kAxisCount> rows;
  int row_count = 0;

  double along = 0.0;      ///< largest |w| on a straight line
  double stretch = 1.0;    ///< largest |q'| in X Y Z: the feed is |q'| ds/dt
  double curvature = 0.0;  ///< largest |q''|
  double third = 0.0;      ///< |q'''|
  double fourth = 0.0;     ///< |q''''|
  double weakest = 0.0;    ///< smallest acceleration limit of the axes that move

  double machine_x = 0.0;  ///< largest x that the axes allow
  double wanted_x = 0.0;   ///< also within feed and override

  /// Largest x at its begin from which everything that follows can be kept: the limits of the
  /// machine, and those of the feed too. Negative: not computed yet.
  double machine_entry = -1.0;
  double wanted_entry = -1.0;

  [[nodiscard]] double end() const { return start + length; }
};

/// Makes `step` the stretch [start, start + length] of `curve`; everything that does not depend on
/// feed or neighbours is filled in, whatever the step was before.
void set_step(Step& step, const Curve& curve, double start, double length,
              const AxisLimits& limits);

/// Bound of the fourth derivative of position by time on a curved step, at x and |w|.
[[nodiscard]] double fourth_derivative(const Step& step, double x, double w);

/// Step length on a curve that is driven at up to `speed` and can accelerate along its begin with
/// `acceleration`: at most 2° of turning on arcs; on cubics as turning and bend change; at most a
/// part of the distance in which the speed is reached, and no finer than 5 ms. At most
/// kMostStepsOfCubic on a cubic.
[[nodiscard]] double grid_length(const Curve& curve, double start, double end, double speed,
                                 double acceleration);

/// Largest x at the begin of `step` from which x at its end can be at most `exit_x`.
[[nodiscard]] double largest_entry(const Step& step, double exit_x);

struct Range {
  double low;
  double high;
};

/// The values of w that keep the axes within their limits from `done` mm inside a curved step to
/// its end, at the present x.
[[nodiscard]] Range allowed_w(const Step& step, double done, double x);

/// Largest |w| at x = 0.
[[nodiscard]] double largest_w_at_rest(const Step& step);

/// Least w that keeps the limits when it is held until standstill or until the step ends. Above 0
/// where an axis needs all of its acceleration for the curve, and the speed for that.
[[nodiscard]] double hardest_braking(const Step& step, double done, double x);

}  // namespace cnc::motion
