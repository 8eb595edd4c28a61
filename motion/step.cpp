#include "motion/step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace cnc::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Below this share of w an axis does not feel w, only x.
constexpr double kInsensitive = 1e-9;

/// Steps of less time than this gain nothing: speed hardly changes within it.
constexpr double kGridTime = 0.005;

constexpr double kLargestTurn = 2.0 * std::numbers::pi / 180.0;

/// Steps of a cubic keep the limits all along, whatever their length; finer ones only gain time:
/// the more, the more the curve turns in them and the more its bend changes, since one w has to
/// suit all of it. The geometric mean of both, the change as a part of the bend, brings most for
/// the steps that it takes.
constexpr double kCubicTurn = 7.0 * std::numbers::pi / 180.0;

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

bool is_still(const Step& step, Axis axis) {
  return step.tangent[0][axis] == 0.0 && step.bend[0][axis] == 0.0 && step.bend[1][axis] == 0.0;
}

/// The same along the whole step.
Demands demands_of(const Step& step, Axis axis) {
  const double tangent = step.tangent[0][axis];
  const double bend = step.bend[0][axis];
  const double end_bend = step.bend[1][axis];
  const double length = step.length;
  return {{{tangent, bend},
           {step.tangent[1][axis] + 2.0 * length * end_bend, end_bend},
           {tangent + 1.5 * length * bend, 0.5 * (bend + end_bend)}},
          step.cubic ? 3 : 2};
}

std::span<const Row> rows_of(const Step& step) {
  return {step.rows.data(), static_cast<std::size_t>(step.row_count)};
}

/// The values of w that the rows allow at x.
Range range_of(std::span<const Row> rows, double x) {
  Range range{-kInfinity, kInfinity};
  for (const auto& [slope, width] : rows) {
    range.low = std::max(range.low, -width - slope * x);
    range.high = std::min(range.high, width - slope * x);
  }
  return range;
}

/// Largest x up to `x` for which a w exists that satisfies all rows. Where there is none, the row
/// that demands most of w and the one that allows least meet at a smaller x. How far the bounds of
/// w are apart is a convex function of x, so that this is Newton's way to its zero: from above,
/// never past it, and exact after a few rounds.
double largest_common_x(std::span<const Row> rows, double x) {
  for (;;) {
    Range range{-kInfinity, kInfinity};
    const Row* lower = nullptr;
    const Row* upper = nullptr;
    for (const Row& row : rows) {
      const double centre = -row.slope * x;
      const double low = centre - row.width;
      const double high = centre + row.width;
      lower = low > range.low ? &row : lower;
      range.low = low > range.low ? low : range.low;
      upper = high < range.high ? &row : upper;
      range.high = high < range.high ? high : range.high;
    }
    if (range.low <= range.high) return x;
    const double meet = (lower->width + upper->width) / (upper->slope - lower->slope);
    if (!(meet < x)) return x;  // rounding
    x = meet;
  }
}

/// Fills in the rows; an axis that does not feel w bounds x alone. Comes back with the largest x up
/// to `x` for which a w exists.
double set_rows(Step& step, double x) {
  std::size_t count = 0;
  for (const Axis axis : kAllAxes) {
    if (is_still(step, axis)) continue;
    const double limit = step.acceleration[axis];
    const Demands demands = demands_of(step, axis);
    for (int i = 0; i < demands.count; ++i) {
      const auto [gain, offset] = demands.demand[i];
      if (std::abs(gain) > kInsensitive) {
        const double inverse = 1.0 / gain;
        step.rows[count++] = {offset * inverse, limit * std::abs(inverse)};
      } else if (offset != 0.0) {
        x = std::min(x, limit / std::abs(offset));
      }
    }
  }
  step.row_count = static_cast<int>(count);
  return largest_common_x(rows_of(step), x);
}

/// Largest |w| that the rows allow up to x.
double largest_w(const Step& step, double x) {
  double w = kInfinity;
  for (const auto& [slope, width] : rows_of(step)) w = std::min(w, width + std::abs(slope) * x);
  return w;
}

/// Braking: the least w of a row, −width − slope x, has to reach the exit. And w may not have to be
/// above the row's largest, width − slope x, only to keep x from becoming negative: where the slope
/// is steep, x has a largest value whatever the exit.
double largest_steep_x(const Step& step) {
  const double h2 = 2.0 * step.length;
  double x = kInfinity;
  for (const auto& [slope, width] : rows_of(step)) {
    if (h2 * slope > 1.0) x = std::min(x, h2 * width / (h2 * slope - 1.0));
  }
  return x;
}

Range intersect(Range range, const Demand& demand, double limit, double x) {
  if (std::abs(demand.gain) <= kInsensitive) return range;
  const double centre = -demand.offset * x / demand.gain;
  const double width = limit / std::abs(demand.gain);
  return {std::max(range.low, centre - width), std::min(range.high, centre + width)};
}

/// Change of a vector as a part of itself, squared. Of a direction it is the angle in radians, for
/// the small angles of steps.
double square_of_change(const Position& a, const Position& b) {
  const Position change = b - a;
  const double largest = std::max(dot(a, a), dot(b, b));
  return largest > 0.0 ? dot(change, change) / largest : 0.0;
}

/// Steps that a cubic wants between two places, for what it turns and bends.
double steps_between(const Cubic& cubic, double start, double end) {
  const double product = square_of_change(cubic.tangent(start), cubic.tangent(end)) *
                         square_of_change(cubic.bend(start), cubic.bend(end));
  constexpr double kOneStep = kCubicTurn * kCubicTurn * kCubicTurn * kCubicTurn;
  return product <= kOneStep ? 1.0 : std::ceil(std::sqrt(std::sqrt(product)) / kCubicTurn);
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

/// The Bézier coefficients of q' bound its length.
double largest_stretch(const Step& step) {
  const Position middle = step.tangent[0] + 0.5 * step.length * step.bend[0];
  const auto square = [](const Position& p) {
    return p[Axis::X] * p[Axis::X] + p[Axis::Y] * p[Axis::Y] + p[Axis::Z] * p[Axis::Z];
  };
  return std::sqrt(std::max({square(step.tangent[0]), square(middle), square(step.tangent[1])}));
}

/// Largest ds/dt that keeps the axes' velocities: |q'| of an axis over the step is bounded by its
/// Bézier coefficients on cubics; elsewhere by both ends and the middle, since a quadratic between
/// three equidistant points exceeds the largest of them by at most an eighth of their second
/// difference.
double speed_limit(const Step& step, const Curve& curve, const AxisLimits& limits) {
  const double reserve = velocity_reserve(step.weakest);
  Position middle;
  if (!step.cubic) middle = tangent_of(curve, step.start + 0.5 * step.length);
  double slowness = 0.0;
  for (const Axis axis : kAllAxes) {
    if (is_still(step, axis)) continue;
    const double a = step.tangent[0][axis];
    const double c = step.tangent[1][axis];
    const double b = step.cubic ? a + 0.5 * step.length * step.bend[0][axis] : middle[axis];
    const double bow = step.cubic ? 0.0 : std::abs(a - 2.0 * b + c) / 8.0;
    const double largest = std::max({std::abs(a), std::abs(b), std::abs(c)}) + bow;
    const double limit = limits.max_velocity[axis];
    slowness = std::max(slowness, largest / (limit - std::min(0.5 * limit, reserve)));
  }
  return 1.0 / slowness;
}

void complete_curved(Step& step, const Curve& curve, const AxisLimits& limits) {
  step.curvature =
      std::sqrt(std::max(dot(step.bend[0], step.bend[0]), dot(step.bend[1], step.bend[1])));
  step.third = norm(step.bend[1] - step.bend[0]) / step.length;
  // On arcs q'' turns with the curve; on cubics it is linear.
  if (!step.cubic && step.curvature > 0.0) step.fourth = step.third * step.third / step.curvature;
  const double speed = speed_limit(step, curve, limits);
  // At least half of it is left below, so that what the curve bears beyond that does not matter.
  const double bearable = set_rows(step, 2.0 * speed * speed);
  const double x = std::min(speed * speed, bearable);
  const double share = 1.0 - free_part(step, x, largest_w(step, x));
  // All rows are proportional to the accelerations, and so is what follows from them.
  step.acceleration *= share;
  for (int i = 0; i < step.row_count; ++i) step.rows[static_cast<std::size_t>(i)].width *= share;
  step.machine_x = std::min({speed * speed, share * bearable, largest_steep_x(step)});
}

void set_derivatives(Step& step, const Curve& curve) {
  const double ends[2] = {step.start, step.end()};
  for (int i = 0; i < 2; ++i) {
    if (const auto* cubic = std::get_if<Cubic>(&curve)) {
      step.tangent[i] = cubic->tangent(ends[i]);
      step.bend[i] = cubic->bend(ends[i]);
    } else {
      step.tangent[i] = tangent_of(curve, ends[i]);
      step.bend[i] = bend_of(curve, ends[i]);
    }
  }
}

}  // namespace

double fourth_derivative(const Step& step, double x, double w) {
  return step.fourth * x * x + 6.0 * step.third * x * w + 3.0 * step.curvature * w * w;
}

void set_step(Step& step, const Curve& curve, double start, double length,
              const AxisLimits& limits) {
  step.start = start;
  step.length = length;
  step.straight = is_straight(curve);
  step.cubic = std::holds_alternative<Cubic>(curve);
  step.stretch = 1.0;
  step.curvature = step.third = step.fourth = 0.0;
  step.machine_entry = step.wanted_entry = -1.0;
  step.acceleration = limits.max_acceleration;
  set_derivatives(step, curve);
  step.weakest = weakest_axis(step, limits);
  if (step.cubic) step.stretch = largest_stretch(step);
  if (step.straight) {
    complete_straight(step, limits);
  } else {
    complete_curved(step, curve, limits);
  }
}

double grid_length(const Curve& curve, double start, double end, double speed,
                   double acceleration) {
  const double length = end - start;
  if (is_straight(curve)) return length;
  const double by_speed = std::max(0.05 * speed * speed / acceleration, speed * kGridTime);
  if (const auto* cubic = std::get_if<Cubic>(&curve)) {
    const double count = steps_between(*cubic, start, end);
    return std::max(std::min(length / count, by_speed), length / kMostStepsOfCubic);
  }
  const auto& arc = std::get<Arc>(curve);
  const double by_turn = kLargestTurn * arc.length() / std::abs(arc.sweep());
  // Eight at least: within one constant w there is no acceleration and deceleration.
  return std::min({by_turn, by_speed, length / 8.0});
}

double largest_entry(const Step& step, double exit_x) {
  const double h2 = 2.0 * step.length;
  if (step.straight) return std::min(step.machine_x, exit_x + h2 * step.along);
  double x = step.machine_x;
  for (const auto& [slope, width] : rows_of(step)) {
    const double steep = 1.0 - h2 * slope;
    const double reach = exit_x + h2 * width;
    if (steep > 0.0 && x * steep > reach) x = reach / steep;
  }
  return x;
}

Range allowed_w(const Step& step, double done, double x) {
  if (done == 0.0) return range_of(rows_of(step), x);
  // No more than anywhere at the step's begin, for which the reserve is made: what is left of a
  // step whose q' grows small would allow any w.
  const double most = largest_w(step, step.machine_x);
  Range range{-most, most};
  for (const Axis axis : kAllAxes) {
    if (is_still(step, axis)) continue;
    const Demands demands = demands_of(step, axis, done);
    for (int i = 0; i < demands.count; ++i) {
      range = intersect(range, demands.demand[i], step.acceleration[axis], x);
    }
  }
  return range;
}

double largest_w_at_rest(const Step& step) {
  if (step.straight) return step.along;
  return std::min(largest_along(step.tangent[0], step.acceleration),
                  largest_along(step.tangent[1], step.acceleration));
}

double hardest_braking(const Step& step, double done, double x) {
  if (step.straight) return -step.along;
  const double to_stop_at_end = -x / (2.0 * (step.length - done));
  const double low = allowed_w(step, done, x).low;
  if (low > to_stop_at_end) return low;
  // Stops inside the step: at the end of the braking x is 0 and only q' w counts.
  return std::max(-largest_w_at_rest(step), std::min(low, to_stop_at_end));
}

}  // namespace cnc::motion
