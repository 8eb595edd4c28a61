#include "tests/motion/time_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cnc::motion::test {

namespace {

using Vector = std::array<double, 3>;

/// Turning that counts as none, as the sine of the angle: within a setpoint, and within one that
/// begins or ends at rest, where the motion is too slow for it to matter.
constexpr double kStraight = 1e-6;
constexpr double kStraightAtRest = 1e-3;
/// Directions that differ by less than 0.1° are one direction: no standstill is needed between
/// them. At any larger angle only a standstill follows the corner exactly.
constexpr double kSameDirection = 0.9999985;
/// Above every x that a motion can have.
constexpr double kUnlimited = 1e12;

Vector linear_of(const Position& p) { return {p[Axis::X], p[Axis::Y], p[Axis::Z]}; }

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

double norm(const Vector& a) { return std::sqrt(dot(a, a)); }

Vector unit(const Vector& a) {
  const double length = norm(a);
  return length > 0.0 ? Vector{a[0] / length, a[1] / length, a[2] / length} : Vector{};
}

/// Whether `v` has the direction of the unit vector, or is zero.
bool is_along(const Vector& v, const Vector& direction, double tolerance) {
  const double length = norm(v);
  const double along = dot(v, direction);
  if (length == 0.0) return true;
  double across = 0.0;
  for (std::size_t i = 0; i < 3; ++i) across += std::pow(v[i] - along * direction[i], 2);
  return along > 0.0 && std::sqrt(across) <= tolerance * length;
}

}  // namespace

TimeBound::TimeBound(const AxisLimits& limits, const Position& start, double grid, Trace trace)
    : limits_(limits), grid_(grid), trace_(std::move(trace)), position_(start) {}

void TimeBound::take(const Setpoint& setpoint) {
  const Vector v0 = linear_of(velocity_);
  const Vector v1 = linear_of(setpoint.velocity);
  const Vector way = linear_of(setpoint.position - position_);
  const double begin_speed = norm(v0);
  const double end_speed = norm(v1);
  const Vector direction = unit(way);
  const bool at_rest = begin_speed == 0.0 || end_speed == 0.0;
  const double tolerance = at_rest ? kStraightAtRest : kStraight;
  const bool straight =
      norm(way) > 0.0 && is_along(v0, direction, tolerance) && is_along(v1, direction, tolerance);
  scale_ = 1.0;
  if (begin_speed == 0.0) {
    begin_at_rest(direction, straight);
  } else if (straight != straight_) {
    scale_ = straight ? begin_speed * begin_speed : 1.0 / (begin_speed * begin_speed);
  }
  const int parts = static_cast<int>(std::ceil(setpoint.duration / grid_));
  if (straight) {
    add_straight(setpoint, direction, parts);
  } else {
    add_curved(setpoint, parts);
  }
  straight_ = straight;
  direction_ = straight ? direction : unit(end_speed > 0.0 ? v1 : way);
  position_ = setpoint.position;
  velocity_ = setpoint.velocity;
}

void TimeBound::begin_at_rest(const Vector& direction, bool straight) {
  const bool goes_on = !run_.empty() && dot(direction, direction_) > kSameDirection;
  if (goes_on && straight && straight_) return;
  if (goes_on) ++stops_on_curves_;
  solve();
}

double TimeBound::largest_at(const Vector& first, double feed) const {
  const double speed = norm(first);
  double largest = feed > 0.0 && speed > 0.0 ? std::pow(feed / speed, 2) : kUnlimited;
  for (const Axis axis : kLinearAxes) {
    const double q = first[index_of(axis)];
    if (q != 0.0) largest = std::min(largest, std::pow(limits_.max_velocity[axis] / q, 2));
  }
  return std::min(largest, kUnlimited);
}

void TimeBound::add_straight(const Setpoint& setpoint, const Vector& direction, int parts) {
  double from = 0.0;
  for (int i = 1; i <= parts; ++i) {
    double to = 0.0;
    for (const Axis axis : kLinearAxes) {
      const AxisCubic cubic = cubic_of(axis, position_, velocity_, setpoint);
      to += direction[index_of(axis)] * (cubic.position(setpoint.duration * i / parts) - cubic.p0);
    }
    Step step;
    step.length = std::max(to - from, 1e-12);
    step.way = step.length;
    step.first = direction;
    step.largest_begin = step.largest_end = largest_at(direction, setpoint.feed_limit);
    step.scale = std::exchange(scale_, 1.0);
    run_.push_back(step);
    from = to;
  }
}

void TimeBound::add_curved(const Setpoint& setpoint, int parts) {
  std::array<AxisCubic, 3> cubics{};
  for (const Axis axis : kLinearAxes) {
    cubics[index_of(axis)] = cubic_of(axis, position_, velocity_, setpoint);
  }
  const auto velocity_at = [&](double t) {
    return Vector{cubics[0].velocity(t), cubics[1].velocity(t), cubics[2].velocity(t)};
  };
  const double h = setpoint.duration / parts;
  double begin = largest_at(linear_of(velocity_), setpoint.feed_limit);
  for (int i = 0; i < parts; ++i) {
    Step step;
    step.length = h;
    step.first = velocity_at((i + 0.5) * h);
    step.way = h * norm(step.first);
    for (std::size_t k = 0; k < 3; ++k) step.second[k] = cubics[k].acceleration((i + 0.5) * h);
    const Vector end_velocity = velocity_at((i + 1.0) * h);
    step.speed = norm(end_velocity);
    step.largest_begin = begin;
    step.largest_end = begin = largest_at(end_velocity, setpoint.feed_limit);
    step.scale = std::exchange(scale_, 1.0);
    run_.push_back(step);
  }
}

/// Half-way along a step x has become x + length * w.
std::array<TimeBound::Row, 3> TimeBound::rows_of(const Step& step) const {
  std::array<Row, 3> rows{};
  for (const Axis axis : kLinearAxes) {
    const std::size_t i = index_of(axis);
    const double factor = step.first[i] + step.length * step.second[i];
    const double safe = std::abs(factor) < 1e-30 ? 1e-30 : factor;
    rows[i] = {step.second[i] / safe, limits_.max_acceleration[axis] / std::abs(safe)};
  }
  return rows;
}

/// Newton's method from above: the width of the range of w is a concave function of x, piecewise
/// linear and not negative at 0, so that every line through two of its bounds leads closer.
double TimeBound::largest_entry(const Step& step, double exit) const {
  const std::array<Row, 3> rows = rows_of(step);
  const double k = 0.5 / step.length;  // the last x is x + 2 length w
  double x = step.largest_begin;
  for (int round = 0; round < 30; ++round) {
    Row low{k, 0.0};
    Row high{k, exit * k};
    double lowest = -k * x;
    double highest = (exit - x) * k;
    for (const Row& row : rows) {
      if (-row.width - row.slope * x > lowest) {
        low = row;
        lowest = -row.width - row.slope * x;
      }
      if (row.width - row.slope * x < highest) {
        high = row;
        highest = row.width - row.slope * x;
      }
    }
    if (lowest <= highest || high.slope <= low.slope) break;
    const double next = (low.width + high.width) / (high.slope - low.slope);
    if (next >= x) break;
    x = next;
  }
  return x;
}

double TimeBound::highest_w(const Step& step, double x, double exit) const {
  double highest = (exit - x) * 0.5 / step.length;
  for (const Row& row : rows_of(step)) highest = std::min(highest, row.width - row.slope * x);
  return highest;
}

/// The path demands a standstill at both ends of the run. On a straight stretch that means x = 0;
/// on a curved one q' is zero there already.
void TimeBound::solve() {
  if (run_.empty()) return;
  const auto is_straight = [](const Step& step) { return step.second == Vector{}; };
  if (is_straight(run_.front())) run_.front().largest_begin = 0.0;
  double exit = is_straight(run_.back()) ? 0.0 : run_.back().largest_end;
  const double last_exit = exit;
  for (std::size_t i = run_.size(); i-- > 0;) {
    Step& step = run_[i];
    step.entry = largest_entry(step, std::min(exit, step.largest_end));
    exit = step.entry / step.scale;
  }
  double x = run_.front().entry;
  for (std::size_t i = 0; i < run_.size(); ++i) {
    const Step& step = run_[i];
    const double next = i + 1 < run_.size() ? run_[i + 1].entry / run_[i + 1].scale : last_exit;
    const double most = std::min(next, step.largest_end);
    const double reached = x + 2.0 * step.length * highest_w(step, x, most);
    const double end = std::clamp(reached, 0.0, most);
    seconds_ += 2.0 * step.length / (std::sqrt(x) + std::sqrt(end));
    way_ += step.way;
    if (trace_) trace_(seconds_, way_, step.speed * std::sqrt(end));
    x = i + 1 < run_.size() ? end * run_[i + 1].scale : end;
  }
  run_.clear();
}

double TimeBound::seconds() {
  solve();
  return seconds_;
}

}  // namespace cnc::motion::test
