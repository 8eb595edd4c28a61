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

/// Steps of a cubic keep the limits all along, whatever their length; finer ones only gain time.
constexpr double kCubicTurn = 5.0 * std::numbers::pi / 180.0;
constexpr double kMostCubicSteps = 4.0;

/// |gain * w + offset * x| <= limit, solved for w: |w + slope * x| <= width.
struct Row {
  double slope;
  double width;
};

/// |gain * w + offset * x| <= limit: what an axis' limit says about w and x.
struct Demand {
  double gain;
  double offset;
};

/// What an axis demands on the way from `done` to the step's end: three of them at most.
struct Demands {
  Demand demand[3];
  int count;
};

/// At the far end x has become x + 2 h w, so w counts there with q' + 2 h q''. In between lies the
/// middle Bézier coefficient of the acceleration q' w + q'' (x + 2 w s), whose derivative by s is
/// 3 q'' w + q''' x.
Demands demands_of(const Step& step, Axis axis, double done) {
  const double left = step.length - done;
  const double third = (step.bend[1][axis] - step.bend[0][axis]) / step.length;
  // Exact on cubics; on arcs the error is of the size of the reserve.
  const double tangent = step.tangent[0][axis] +
                         done / step.length * (step.tangent[1][axis] - step.tangent[0][axis]) -
                         0.5 * third * done * left;
  const double bend = step.bend[0][axis] + done * third;
  const Demand end{step.tangent[1][axis] + 2.0 * left * step.bend[1][axis], step.bend[1][axis]};
  if (!step.cubic) return {{{tangent, bend}, end}, 2};
  return {{{tangent, bend}, end, {tangent + 1.5 * left * bend, bend + 0.5 * left * third}}, 3};
}

/// The rows of a step: three per moving axis at most. An axis that does not feel w bounds x alone.
struct Rows {
  Row row[3 * kAxisCount];
  int count = 0;
  double largest_x = kInfinity;

  void add(const Demand& demand, double limit) {
    if (std::abs(demand.gain) > kInsensitive) {
      row[count++] = {demand.offset / demand.gain, limit / std::abs(demand.gain)};
    } else if (demand.offset != 0.0) {
      largest_x = std::min(largest_x, limit / std::abs(demand.offset));
    }
  }
};

bool is_still(const Step& step, Axis axis) {
  return step.tangent[0][axis] == 0.0 && step.bend[0][axis] == 0.0 && step.bend[1][axis] == 0.0;
}

Rows rows_of(const Step& step) {
  Rows rows;
  for (const Axis axis : kAllAxes) {
    if (is_still(step, axis)) continue;
    const Demands demands = demands_of(step, axis, 0.0);
    for (int i = 0; i < demands.count; ++i) rows.add(demands.demand[i], step.acceleration[axis]);
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

Range intersect(Range range, const Demand& demand, double limit, double x) {
  if (std::abs(demand.gain) <= kInsensitive) return range;
  const double centre = -demand.offset * x / demand.gain;
  const double width = limit / std::abs(demand.gain);
  return {std::max(range.low, centre - width), std::min(range.high, centre + width)};
}

/// Change of direction over a step, in radians for the small angles of steps.
double turn_between(const Position& a, const Position& b) {
  return norm(b - a) / std::max(norm(a), norm(b));
}

/// Part of the axes' accelerations that a curve must leave free, for two reasons. Except on cubics
/// the limits are checked at both ends of a step only: a = q' w + q'' x with x' = 2w has
/// a'' = 5 q''' w + q'''' x, and h²/8 of that is the height of the bow between the ends. And the
/// cubic in time of a setpoint differs from the curve by the reserve, or by more on tiny arcs, of
/// which even the shortest setpoint covers much.
double free_part(const Step& step, double x, double w) {
  const double h = step.length;
  const double bow = step.cubic ? 0.0 : (5.0 * step.third * w + step.fourth * x) * h * h / 8.0;
  const double setpoint =
      fourth_derivative(step, x, w) * kShortestSetpoint * kShortestSetpoint / 12.0;
  return std::min(0.5, std::max(kCubicReserve, setpoint / step.weakest) + bow / step.weakest);
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

/// The Bézier coefficients of q' bound its length.
double largest_stretch(const Step& step) {
  const Position middle = step.tangent[0] + 0.5 * step.length * step.bend[0];
  return std::max(
      {linear_length(step.tangent[0]), linear_length(middle), linear_length(step.tangent[1])});
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
  step.third = norm(step.bend[1] - step.bend[0]) / step.length;
  // On arcs q'' turns with the curve; on cubics it is linear.
  if (!step.cubic && step.curvature > 0.0) step.fourth = step.third * step.third / step.curvature;
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
  return step.fourth * x * x + 6.0 * step.third * x * w + 3.0 * step.curvature * w * w;
}

Step make_step(const Curve& curve, double start, double length, const AxisLimits& limits) {
  Step step;
  step.start = start;
  step.length = length;
  step.straight = is_straight(curve);
  step.cubic = std::holds_alternative<Cubic>(curve);
  step.tangent[0] = tangent_of(curve, start);
  step.tangent[1] = tangent_of(curve, start + length);
  step.bend[0] = bend_of(curve, start);
  step.bend[1] = bend_of(curve, start + length);
  step.acceleration = limits.max_acceleration;
  step.weakest = weakest_axis(step, limits);
  if (step.cubic) step.stretch = largest_stretch(step);
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
  const double acceleration = largest_along(tangent_of(curve, start), limits.max_acceleration);
  const double by_speed = std::max(0.05 * speed * speed / acceleration, speed * kGridTime);
  if (const auto* cubic = std::get_if<Cubic>(&curve)) {
    const double turn = turn_between(cubic->tangent(start), cubic->tangent(end));
    const double count = std::clamp(std::ceil(turn / kCubicTurn), 1.0, kMostCubicSteps);
    return std::min(length / count, by_speed);
  }
  const auto& arc = std::get<Arc>(curve);
  const double by_turn = kLargestTurn * arc.length() / std::abs(arc.sweep());
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
  Range range{-kInfinity, kInfinity};
  for (const Axis axis : kAllAxes) {
    if (is_still(step, axis)) continue;
    const Demands demands = demands_of(step, axis, done);
    for (int i = 0; i < demands.count; ++i) {
      range = intersect(range, demands.demand[i], step.acceleration[axis], x);
    }
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
