#include "motion/step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cnc::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Below this share of w an axis does not feel w, only x.
constexpr double kInsensitive = 1e-9;

/// Steps of less time than this gain nothing: speed hardly changes within it.
constexpr double kGridTime = 0.005;

constexpr double kLargestTurn = 2.0 * std::numbers::pi / 180.0;

/// |gain * w + offset * x| <= limit, solved for w: |w + slope * x| <= width.
struct Row {
  double slope;
  double width;
};

/// The rows of a step: two per moving axis at most. An axis that does not feel w bounds x alone.
struct Rows {
  Row row[2 * kAxisCount];
  int count = 0;
  double largest_x = kInfinity;

  void add(double gain, double offset, double limit) {
    if (std::abs(gain) > kInsensitive) {
      row[count++] = {offset / gain, limit / std::abs(gain)};
    } else if (offset != 0.0) {
      largest_x = std::min(largest_x, limit / std::abs(offset));
    }
  }
};

/// At the far end x has become x + 2 h w, so w counts there with q' + 2 h q''.
Rows rows_of(const Step& step) {
  Rows rows;
  for (const Axis axis : kAllAxes) {
    const double limit = step.acceleration[axis];
    rows.add(step.tangent[0][axis], step.bend[0][axis], limit);
    rows.add(step.tangent[1][axis] + 2.0 * step.length * step.bend[1][axis], step.bend[1][axis],
             limit);
  }
  return rows;
}

/// Largest x for which a w exists that satisfies all rows: any two of them must meet.
double largest_x(const Rows& rows) {
  double x = rows.largest_x;
  for (int m = 0; m < rows.count; ++m) {
    for (int n = 0; n < m; ++n) {
      const double apart = std::abs(rows.row[m].slope - rows.row[n].slope);
      const double widths = rows.row[m].width + rows.row[n].width;
      if (apart * x > widths) x = widths / apart;
    }
  }
  return x;
}

/// Largest |w| that the rows allow up to x.
double largest_w(const Rows& rows, double x) {
  double w = kInfinity;
  for (int m = 0; m < rows.count; ++m) {
    w = std::min(w, rows.row[m].width + std::abs(rows.row[m].slope) * x);
  }
  return w;
}

Range intersect(Range range, double gain, double offset, double limit, double x) {
  if (std::abs(gain) <= kInsensitive) return range;
  const double centre = -offset * x / gain;
  const double width = limit / std::abs(gain);
  return {std::max(range.low, centre - width), std::min(range.high, centre + width)};
}

/// Change of direction over a step, in radians for the small angles of steps.
double turn_between(const Position& a, const Position& b) {
  return norm(b - a) / std::max(norm(a), norm(b));
}

/// How fast q'' itself changes, relative to its size: the curvature on arcs, nothing on parabolas.
double rotation_of(const Step& step) {
  const double change = norm(step.bend[1] - step.bend[0]) / step.length;
  return step.curvature > 0.0 ? change / step.curvature : 0.0;
}

/// Part of the axes' accelerations that a curve must leave free, for two reasons. The limits are
/// checked at both ends of a step only: a = q' w + q'' x with x' = 2w has a'' = 5 q''' w + q'''' x,
/// and h²/8 of that is the height of the bow between the ends. And the cubic of a setpoint differs
/// from the curve by the reserve, or by more on tiny arcs, of which even the shortest setpoint
/// covers much.
double free_part(const Step& step, double x, double w) {
  const double h = step.length;
  const double r = step.rotation;
  const double bow = step.curvature * r * (5.0 * w + r * x) * h * h / 8.0;
  const double cubic = fourth_derivative(step, x, w) * kShortestSetpoint * kShortestSetpoint / 12.0;
  return std::min(0.5, std::max(kCubicReserve, cubic / step.weakest) + bow / step.weakest);
}

/// Part of a velocity limit, mm/s, that the same cubics need: they differ in velocity by p h³
/// √3/216 at most, and the sampler bounds p h⁴ and p h².
double velocity_reserve(double weakest) {
  return std::sqrt(3.0) / 216.0 *
         std::sqrt(384.0 * kCubicTolerance * 12.0 * kCubicReserve * weakest);
}

double weakest_axis(const Step& step, const AxisLimits& limits) {
  double weakest = kInfinity;
  for (const Axis axis : kAllAxes) {
    const bool moves = step.tangent[0][axis] != 0.0 || step.bend[0][axis] != 0.0;
    if (moves) weakest = std::min(weakest, limits.max_acceleration[axis]);
  }
  return weakest;
}

void complete_straight(Step& step, const AxisLimits& limits) {
  step.along = largest_along(step.tangent[0], limits.max_acceleration);
  const double speed = largest_along(step.tangent[0], limits.max_velocity);
  step.machine_x = speed * speed;
}

/// Largest |q'| of each axis over the step, from both ends and the middle. A quadratic between
/// three equidistant points exceeds the largest of them by at most an eighth of their second
/// difference.
Position largest_tangent(const Step& step, const Position& middle) {
  Position largest;
  for (const Axis axis : kAllAxes) {
    const double a = step.tangent[0][axis];
    const double b = middle[axis];
    const double c = step.tangent[1][axis];
    largest[axis] =
        std::max({std::abs(a), std::abs(b), std::abs(c)}) + std::abs(a - 2.0 * b + c) / 8.0;
  }
  return largest;
}

double speed_limit(const Step& step, const Position& middle_tangent, const AxisLimits& limits) {
  Position velocity = limits.max_velocity;
  for (const Axis axis : kAllAxes) {
    velocity[axis] -= std::min(0.5 * velocity[axis], velocity_reserve(step.weakest));
  }
  return largest_along(largest_tangent(step, middle_tangent), velocity);
}

void complete_curved(Step& step, const Position& middle_tangent, const AxisLimits& limits) {
  step.curvature = std::max(norm(step.bend[0]), norm(step.bend[1]));
  step.rotation = rotation_of(step);
  const double speed = speed_limit(step, middle_tangent, limits);
  const Rows rows = rows_of(step);
  const double x = std::min(speed * speed, largest_x(rows));
  const double share = 1.0 - free_part(step, x, largest_w(rows, x));
  // All rows are proportional to the accelerations, and so is what follows from them.
  step.acceleration *= share;
  step.machine_x = std::min(speed * speed, share * largest_x(rows));
  step.along = std::min(largest_along(step.tangent[0], step.acceleration),
                        largest_along(step.tangent[1], step.acceleration));
}

}  // namespace

double fourth_derivative(const Step& step, double x, double w) {
  const double r = step.rotation;
  return step.curvature * (r * r * x * x + 6.0 * r * x * w + 3.0 * w * w);
}

Step make_step(const Curve& curve, double start, double length, const AxisLimits& limits) {
  Step step;
  step.start = start;
  step.length = length;
  step.straight = is_straight(curve);
  step.tangent[0] = tangent_of(curve, start);
  step.tangent[1] = tangent_of(curve, start + length);
  step.bend[0] = bend_of(curve, start);
  step.bend[1] = bend_of(curve, start + length);
  step.acceleration = limits.max_acceleration;
  step.weakest = weakest_axis(step, limits);
  if (step.straight) {
    complete_straight(step, limits);
  } else {
    complete_curved(step, tangent_of(curve, start + 0.5 * length), limits);
  }
  return step;
}

double grid_length(const Curve& curve, double start, double end, double speed,
                   const AxisLimits& limits) {
  const double length = end - start;
  if (is_straight(curve)) return length;
  if (const auto* blend = std::get_if<CornerBlend>(&curve)) {
    const double turn = turn_between(blend->tangent(start), blend->tangent(end));
    return length / std::max(1.0, std::ceil(turn / kLargestTurn));
  }
  const auto& arc = std::get<Arc>(curve);
  const double by_turn = kLargestTurn * arc.length() / std::abs(arc.sweep());
  const double acceleration = largest_along(arc.tangent(start), limits.max_acceleration);
  const double by_speed = std::max(0.05 * speed * speed / acceleration, speed * kGridTime);
  // Eight at least: within one constant w there is no acceleration and deceleration.
  return std::min({by_turn, by_speed, length / 8.0});
}

double largest_entry(const Step& step, double exit_x) {
  const double h2 = 2.0 * step.length;
  if (step.straight) return std::min(step.machine_x, exit_x + h2 * step.along);
  const Rows rows = rows_of(step);
  double x = step.machine_x;
  for (int m = 0; m < rows.count; ++m) {
    const auto [slope, width] = rows.row[m];
    const double steep = 1.0 - h2 * slope;
    // Braking: the least w of this row, −width − slope x, has to reach exit_x. And w may not have
    // to be above the row's largest, width − slope x, only to keep x from becoming negative.
    if (steep > 0.0) {
      x = std::min(x, (exit_x + h2 * width) / steep);
    } else if (steep < 0.0) {
      x = std::min(x, h2 * width / -steep);
    }
  }
  return x;
}

Range allowed_w(const Step& step, double done, double x) {
  const double left = step.length - done;
  const double part = done / step.length;
  Range range{-kInfinity, kInfinity};
  for (const Axis axis : kAllAxes) {
    const double limit = step.acceleration[axis];
    // Straight interpolation of q' and q'' between the ends is exact on parabolas; on arcs its
    // error is of the size of the reserve.
    const double tangent =
        step.tangent[0][axis] + part * (step.tangent[1][axis] - step.tangent[0][axis]);
    const double bend = step.bend[0][axis] + part * (step.bend[1][axis] - step.bend[0][axis]);
    range = intersect(range, tangent, bend, limit, x);
    range = intersect(range, step.tangent[1][axis] + 2.0 * left * step.bend[1][axis],
                      step.bend[1][axis], limit, x);
  }
  return range;
}

double hardest_braking(const Step& step, double done, double x) {
  if (step.straight) return -step.along;
  const double to_stop_at_end = -x / (2.0 * (step.length - done));
  const double low = allowed_w(step, done, x).low;
  if (low > to_stop_at_end) return std::min(low, 0.0);
  // Stops inside the step: at the end of the braking x is 0 and only q' w counts.
  return std::max(-step.along, std::min(low, to_stop_at_end));
}

}  // namespace cnc::motion
