#include "motion/speed_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/barrier.h"

namespace cnc::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Bernstein coefficients of q' (quadratic) and q'' (linear) over a cell, and q'''; one axis.
struct AxisPath {
  double p0, p1, p2;
  double e0, e1;
  double d;

  [[nodiscard]] bool moves() const { return p0 != 0.0 || p1 != 0.0 || p2 != 0.0; }
  [[nodiscard]] double steepest() const {
    return std::max({std::abs(p0), std::abs(p1), std::abs(p2)});
  }
  [[nodiscard]] double most_bent() const { return std::max(std::abs(e0), std::abs(e1)); }
};

AxisPath path_of(const PathInterval& interval, double start, double h, Axis axis) {
  const double d = interval.third[axis];
  const double e0 = interval.second[axis] + start * d;
  const double p0 = interval.first[axis] + start * (interval.second[axis] + 0.5 * start * d);
  const double e1 = e0 + h * d;
  return {p0, p0 + 0.5 * h * e0, p0 + 0.5 * h * (e0 + e1), e0, e1, d};
}

/// With w = (x1 − x0)/h at the begin, (x2 − x1)/h at the end, and w' = (x2 − 2 x1 + x0)/h²: the
/// coefficients of the products q' w, q'' x and so on, which are means of products of coefficients.
AxisRows rows_of(const AxisPath& path, double h, double acceleration, double jerk) {
  const auto& [p0, p1, p2, e0, e1, d] = path;
  const double a = 1.0 / (3.0 * h * acceleration);
  const double b = 1.0 / (3.0 * acceleration);
  const double j = 1.0 / (h * h * jerk);
  const double k = 1.0 / (h * jerk);
  AxisRows rows;
  rows.acceleration[0] = {-2.0 * p1 * a + e1 * b, (2.0 * p1 - p0) * a + 2.0 * e0 * b, p0 * a};
  rows.acceleration[1] = {-p2 * a, (p2 - 2.0 * p1) * a + 2.0 * e1 * b, 2.0 * p1 * a + e0 * b};
  rows.acceleration[2] = {0.0, -3.0 * p2 * a, 3.0 * (p2 * a + e1 * b)};
  rows.jerk[0] = {p0 * j - 3.0 * e0 * k + d / jerk, -2.0 * p0 * j + 3.0 * e0 * k, p0 * j};
  rows.jerk[1] = {p1 * j - 1.5 * e1 * k, -2.0 * p1 * j + 1.5 * (e1 - e0) * k + d / jerk,
                  p1 * j + 1.5 * e0 * k};
  rows.jerk[2] = {p2 * j, -2.0 * p2 * j - 3.0 * e1 * k, p2 * j + 3.0 * e1 * k + d / jerk};
  return rows;
}

Reach reach_of(const AxisPath& path, double acceleration, double jerk) {
  Reach reach;
  const double first = path.steepest();
  const double second = path.most_bent();
  if (first > 0.0) reach.a_first = acceleration / first;
  if (first > 0.0) reach.j_first = jerk / first;
  if (second > 0.0) reach.a_second = acceleration / second;
  if (second > 0.0) reach.j_second = jerk / second;
  if (path.d != 0.0) reach.j_third = jerk / std::abs(path.d);
  return reach;
}

double feed_x(const PathInterval& interval, double start, double h) {
  const Position at_start = interval.first_at(start);
  const Position middle = at_start + 0.5 * h * interval.second_at(start);
  const Position at_end = interval.first_at(start + h);
  const double speed =
      interval.feed /
      std::max({interval.speed_of(at_start), interval.speed_of(middle), interval.speed_of(at_end)});
  return speed * speed;
}

double dot(const CellRow& row, const CellX& x) {
  return row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
}

/// 1/√x is convex, so that its tangent at x1, the middle coefficient, is below it everywhere. The
/// tangent's coefficients are what |jerk / √x| has to stay below.
struct JerkBound {
  explicit JerkBound(const CellX& x) : root(1.0 / std::sqrt(x[1])), inverse(1.0 / x[1]) {}

  [[nodiscard]] double at(const CellX& x, std::size_t i) const {
    return root * (1.5 - 0.5 * x[i] * inverse);
  }
  [[nodiscard]] CellRow gradient(const CellX& x, std::size_t i) const {
    CellRow row{};
    row[i] = -0.5 * root * inverse;
    row[1] += 0.75 * root * inverse * (x[i] * inverse - 1.0);
    return row;
  }

  double root;
  double inverse;
};

double square(double value) { return value * value; }

}  // namespace

void Reach::include(const Reach& other) {
  a_first = std::min(a_first, other.a_first);
  a_second = std::min(a_second, other.a_second);
  j_first = std::min(j_first, other.j_first);
  j_second = std::min(j_second, other.j_second);
  j_third = std::min(j_third, other.j_third);
}

double Reach::standstill_x(double length) const {
  const double h = length;
  const double by_jerk =
      std::cbrt(square(h * h / (2.0 / 9.0 / j_first + 2.0 * h / j_second + h * h / j_third)));
  return std::min(by_jerk, h / (2.0 / 3.0 / a_first + h / a_second));
}

double Reach::cruise_x(double part) const {
  return std::min(part * a_second, std::cbrt(square(part * j_third)));
}

double Reach::moderate_w(double x) const {
  // Constant jerk from rest has w² = 2 (j/q') √x.
  const double root = std::sqrt(x);
  return std::min({0.5 * a_first, 0.6 * std::sqrt(2.0 * j_first * root), j_second / (9.0 * root)});
}

SpeedCell make_cell(const PathInterval& interval, double start, double length,
                    const JerkLimits& limits) {
  SpeedCell cell;
  cell.length = length;
  cell.start = start;
  cell.override = interval.override;
  constexpr double kShare = 1.0 - kThirdOrderReserve;
  for (const Axis axis : kAllAxes) {
    const AxisPath path = path_of(interval, start, length, axis);
    if (!path.moves()) continue;
    const double acceleration = kShare * limits.acceleration[axis];
    const double jerk = kShare * limits.jerk[axis];
    cell.machine_x =
        std::min(cell.machine_x, square(kShare * limits.velocity[axis] / path.steepest()));
    cell.reach.include(reach_of(path, acceleration, jerk));
    cell.rows[cell.axes++] = rows_of(path, length, acceleration, jerk);
  }
  cell.feed_x = std::isinf(interval.feed) ? cell.machine_x : feed_x(interval, start, length);
  return cell;
}

double usage_of(const SpeedCell& cell, const CellX& x) {
  if (!(x[0] > 0.0 && x[1] > 0.0 && x[2] > 0.0)) return kInfinity;
  const JerkBound bound(x);
  double most = 0.0;
  for (std::size_t axis = 0; axis < cell.axes; ++axis) {
    const AxisRows& rows = cell.rows[axis];
    for (std::size_t i = 0; i < 3; ++i) {
      most = larger(most, std::abs(dot(rows.acceleration[i], x)));
      const double slack = bound.at(x, i) - std::abs(dot(rows.jerk[i], x));
      most = larger(most, 1.0 - slack / bound.root);
    }
  }
  return most;
}

double barrier(const SpeedCell& cell, const CellX& x, const Defence& defence) {
  const JerkBound bound(x);
  const HardBarrier hard{defence.least};
  double sum = 0.0;
  double product = 1.0;  // of the slacks that need no relaxing: one logarithm for all
  const auto take = [&](double slack) {
    if (slack > hard.least) {
      product *= slack;
    } else {
      sum += hard.value(slack);
    }
  };
  for (std::size_t axis = 0; axis < cell.axes; ++axis) {
    const AxisRows& rows = cell.rows[axis];
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = dot(rows.acceleration[i], x);
      const double j = defence.reference * dot(rows.jerk[i], x);
      const double most = defence.reference * bound.at(x, i);
      take(1.0 - a);
      take(1.0 + a);
      take(most - j);
      take(most + j);
    }
  }
  return defence.weight * (sum - std::log(product));
}

void add_barrier(const SpeedCell& cell, const CellX& x, const Defence& defence, CellModel& model) {
  const JerkBound bound(x);
  const HardBarrier hard{defence.least};
  const double weight = defence.weight;
  const double reference = defence.reference;
  for (std::size_t axis = 0; axis < cell.axes; ++axis) {
    const AxisRows& rows = cell.rows[axis];
    for (std::size_t i = 0; i < 3; ++i) {
      const CellRow& row = rows.acceleration[i];
      const double a = dot(row, x);
      const Barrier upper = hard.at(1.0 - a);
      const Barrier lower = hard.at(1.0 + a);
      model.add(row, weight * (lower.slope - upper.slope), weight * (lower.bend + upper.bend));
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const CellRow& row = rows.jerk[i];
      const double j = dot(row, x);
      const double most = bound.at(x, i);
      const CellRow slope = bound.gradient(x, i);
      const Barrier upper = hard.at(reference * (most - j));
      const Barrier lower = hard.at(reference * (most + j));
      const CellRow to_upper{slope[0] - row[0], slope[1] - row[1], slope[2] - row[2]};
      const CellRow to_lower{slope[0] + row[0], slope[1] + row[1], slope[2] + row[2]};
      model.add(to_upper, weight * reference * upper.slope,
                weight * reference * reference * upper.bend);
      model.add(to_lower, weight * reference * lower.slope,
                weight * reference * reference * lower.bend);
    }
  }
}

}  // namespace cnc::motion
