#include "tests/motion/path_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cnc::motion::test {

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  double along = 0.0;
  double length = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    along += (p[i] - a[i]) * (b[i] - a[i]);
    length += (b[i] - a[i]) * (b[i] - a[i]);
  }
  const double part = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double off = a[i] + part * (b[i] - a[i]) - p[i];
    sum += off * off;
  }
  return std::sqrt(sum);
}

namespace {

double distance_between(const Point& a, const Point& b) { return distance_to_segment(a, b, b); }

}  // namespace

Point point_of(const Position& p) { return {p[Axis::X], p[Axis::Y], p[Axis::Z]}; }

Polyline::Key Polyline::key_of(const std::array<std::int64_t, 3>& cell) const {
  return (cell[0] * 73856093) ^ (cell[1] * 19349663) ^ (cell[2] * 83492791);
}

void Polyline::add(const Point& point, double allowed) {
  points_.push_back(point);
  if (points_.size() < 2) return;
  allowed_.push_back(allowed);
  const Point& from = points_[points_.size() - 2];
  const auto index = static_cast<std::uint32_t>(points_.size() - 2);
  // Every cell that the segment passes is at most half a cell from one of these points, so with its
  // neighbours distance() finds it.
  const double length = distance_between(from, point);
  const int count = 1 + static_cast<int>(2.0 * length / cell_);
  Key last = 0;
  for (int i = 0; i <= count; ++i) {
    std::array<std::int64_t, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = from[k] + (point[k] - from[k]) * i / count;
      cell[k] = static_cast<std::int64_t>(std::floor(value / cell_));
    }
    const Key key = key_of(cell);
    if (i > 0 && key == last) continue;
    segments_[key].push_back(index);
    last = key;
  }
}

template <typename Visit>
void Polyline::for_each_near(const Point& point, Visit visit) const {
  std::array<std::int64_t, 3> home{};
  for (std::size_t k = 0; k < 3; ++k) {
    home[k] = static_cast<std::int64_t>(std::floor(point[k] / cell_));
  }
  for (std::int64_t x = -1; x <= 1; ++x) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t z = -1; z <= 1; ++z) {
        const auto found = segments_.find(key_of({home[0] + x, home[1] + y, home[2] + z}));
        if (found == segments_.end()) continue;
        for (const std::uint32_t i : found->second) {
          if (!visit(i)) return;
        }
      }
    }
  }
}

double Polyline::to_stretch(const Point& point, std::size_t i) const {
  return distance_to_segment(point, points_[i], points_[i + 1]) / allowed_[i];
}

double Polyline::distance(const Point& point) const {
  double least = std::numeric_limits<double>::infinity();
  for_each_near(point, [&](std::size_t i) {
    least = std::min(least, to_stretch(point, i));
    return true;
  });
  return least;
}

double Polyline::distance(const Point& point, double enough) {
  // Where the path goes, points go too: some of the next stretches, or the one before.
  constexpr std::size_t kNext = 8;
  const std::size_t first = near_ > 0 ? near_ - 1 : 0;
  for (std::size_t i = first; i < std::min(near_ + kNext, allowed_.size()); ++i) {
    const double distance = to_stretch(point, i);
    if (distance > enough) continue;
    near_ = i;
    return distance;
  }
  double least = std::numeric_limits<double>::infinity();
  for_each_near(point, [&](std::size_t i) {
    const double distance = to_stretch(point, i);
    if (distance < least) near_ = i;
    least = std::min(least, distance);
    return least > enough;
  });
  return least;
}

double largest_distance(const Polyline& from, const Polyline& to) {
  double largest = 0.0;
  const std::vector<Point>& points = from.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    largest = std::max(largest, to.distance(points[i]));
    if (i == 0) continue;
    const Point& a = points[i - 1];
    const Point& b = points[i];
    const int parts = 1 + std::min(8, static_cast<int>(distance_between(a, b) / 0.02));
    for (int k = 1; k < parts; ++k) {
      Point middle{};
      for (std::size_t j = 0; j < 3; ++j) middle[j] = a[j] + (b[j] - a[j]) * k / parts;
      largest = std::max(largest, to.distance(middle));
    }
  }
  return largest;
}

void LimitJudge::take(const Setpoint& setpoint) {
  // The last digits of a position, seen over the square of a very short duration.
  const double rounding = 6.0 * 4e-15 / (setpoint.duration * setpoint.duration);
  double square = 0.0;
  for (const Axis axis : kAllAxes) {
    const auto cubic = cubic_of(axis, position, velocity, setpoint);
    const double a =
        std::max(std::abs(cubic.start_acceleration()), std::abs(cubic.end_acceleration())) -
        rounding * (1.0 + std::abs(cubic.p1));
    acceleration_ratio = std::max(acceleration_ratio, a / limits.max_acceleration[axis]);
    velocity_ratio = std::max(velocity_ratio, cubic.fastest() / limits.max_velocity[axis]);
    if (limits.max_jerk[axis] > 0.0) {
      const double jerk =
          std::abs(cubic.jerk()) - 2.0 * rounding * (1.0 + std::abs(cubic.p1)) / setpoint.duration;
      jerk_ratio = std::max(jerk_ratio, jerk / limits.max_jerk[axis]);
    }
    const double leap = std::abs(cubic.start_acceleration() - acceleration[axis]);
    leap_ratio = std::max(leap_ratio, leap / limits.max_acceleration[axis]);
    acceleration[axis] = cubic.end_acceleration();
    if (!is_rotary(axis)) square += setpoint.velocity[axis] * setpoint.velocity[axis];
  }
  if (square == 0.0) highest_override = feed_override;
  if (setpoint.feed_limit > 0.0 && square > 0.0) {
    feed_ratio = std::max(feed_ratio, std::sqrt(square) / (setpoint.feed_limit * highest_override));
  }
  time += setpoint.duration;
  shortest = std::min(shortest, setpoint.duration);
  ++setpoints;
  position = setpoint.position;
  velocity = setpoint.velocity;
}

}  // namespace cnc::motion::test
