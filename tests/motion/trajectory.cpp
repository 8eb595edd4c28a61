#include "tests/motion/trajectory.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/motion/path_judge.h"

namespace cnc::motion::test {

Position xyz(double x, double y, double z) {
  Position p;
  p[Axis::X] = x;
  p[Axis::Y] = y;
  p[Axis::Z] = z;
  return p;
}

AxisLimits reference_limits() {
  AxisLimits limits{Position::filled(360.0), Position::filled(1800.0)};
  for (const Axis axis : kLinearAxes) {
    limits.max_velocity[axis] = 100.0;
    limits.max_acceleration[axis] = 500.0;
  }
  return limits;
}

PlannerSettings reference_settings() { return {reference_limits(), 0.005, 1.0}; }

MoveOptions feed_of(double feed) {
  MoveOptions options;
  options.feed = feed;
  return options;
}

MoveOptions rapid() {
  MoveOptions options;
  options.kind = MoveKind::rapid;
  return options;
}

double Trajectory::duration() const {
  double sum = 0.0;
  for (const Setpoint& setpoint : setpoints) sum += setpoint.duration;
  return sum;
}

const Position& Trajectory::end() const {
  return setpoints.empty() ? start : setpoints.back().position;
}

Trajectory draw_all(Planner& planner) {
  Trajectory trajectory{planner.position(), {}};
  while (const auto setpoint = planner.next()) trajectory.setpoints.push_back(*setpoint);
  return trajectory;
}

namespace {

/// Calls visit(axis, cubic) for every axis of every setpoint.
template <typename Visit>
void for_each_cubic(const Trajectory& trajectory, Visit visit) {
  Position position = trajectory.start;
  Position velocity;
  for (const Setpoint& setpoint : trajectory.setpoints) {
    for (const Axis axis : kAllAxes) visit(axis, cubic_of(axis, position, velocity, setpoint));
    position = setpoint.position;
    velocity = setpoint.velocity;
  }
}

/// Position on `curve` nearest to `p`, by Newton's method from `s`.
double nearest(const Curve& curve, const Position& p, double s) {
  for (int i = 0; i < 8; ++i) {
    const Position tangent = tangent_of(curve, s);
    const double step = dot(p - point_of(curve, s), tangent) / dot(tangent, tangent);
    s = std::clamp(s + step, 0.0, length_of(curve));
    if (std::abs(step) < 1e-12) break;
  }
  return s;
}

}  // namespace

Usage usage_of(const Trajectory& trajectory, const AxisLimits& limits) {
  Usage usage;
  for_each_cubic(trajectory, [&](Axis axis, const AxisCubic& cubic) {
    const double acceleration =
        std::max(std::abs(cubic.start_acceleration()), std::abs(cubic.end_acceleration()));
    if (limits.max_jerk[axis] > 0.0) {
      usage.jerk = std::max(usage.jerk, std::abs(cubic.jerk()) / limits.max_jerk[axis]);
    }
    usage.velocity = std::max(usage.velocity, cubic.fastest() / limits.max_velocity[axis]);
    usage.acceleration = std::max(usage.acceleration, acceleration / limits.max_acceleration[axis]);
  });
  return usage;
}

void Path::add_line(const Position& end) {
  const Line line(end_, end);
  if (line.length() < kShortest) return;
  curves_.emplace_back(line);
  end_ = end;
}

void Path::add_arc(const ArcShape& shape) {
  const auto arc = make_arc(end_, shape);
  REQUIRE(arc.has_value());
  curves_.emplace_back(*arc);
  end_ = shape.end;
}

double Path::deviation_of(const Trajectory& trajectory, double step) const {
  double worst = 0.0;
  std::size_t curve = 0;
  double s = 0.0;
  const auto visit = [&](const Position& p) {
    double best = norm(p - point_of(curves_[curve], s = nearest(curves_[curve], p, s)));
    // Past the end of one curve the next is nearer; tiny ones may be skipped within one sample.
    for (std::size_t next = curve + 1; best > 1e-8 && next < std::min(curve + 200, curves_.size());
         ++next) {
      const double there = nearest(curves_[next], p, 0.0);
      const double distance = norm(p - point_of(curves_[next], there));
      if (distance < best) {
        best = distance;
        curve = next;
        s = there;
      }
      if (distance > 1.0) break;
    }
    worst = std::max(worst, best);
  };
  Position position = trajectory.start;
  Position velocity;
  for (const Setpoint& setpoint : trajectory.setpoints) {
    const int samples = static_cast<int>(std::ceil(setpoint.duration / step));
    for (int i = 1; i <= samples; ++i) {
      Position p;
      for (const Axis axis : kAllAxes) {
        p[axis] =
            cubic_of(axis, position, velocity, setpoint).position(setpoint.duration * i / samples);
      }
      visit(p);
    }
    position = setpoint.position;
    velocity = setpoint.velocity;
  }
  return worst;
}

double Path::distance_both_ways(const Trajectory& trajectory) const {
  constexpr double kCell = 0.5;
  Polyline programmed(kCell);
  programmed.add(point_of(trajectory.start));
  for (const Curve& curve : curves_) {
    // Chords that leave the curve by 0.05 µm: R φ²/8.
    const auto* arc = std::get_if<Arc>(&curve);
    const double radius = arc ? std::max(arc->radius(0.0), arc->radius(arc->length())) : 0.0;
    const int chords =
        arc ? 1 + static_cast<int>(std::abs(arc->sweep()) * std::sqrt(radius / 4e-4)) : 1;
    for (int i = 1; i <= chords; ++i) {
      programmed.add(point_of(motion::point_of(curve, length_of(curve) * i / chords)));
    }
  }
  Polyline driven(kCell);
  driven.add(point_of(trajectory.start));
  Position position = trajectory.start;
  Position velocity;
  for (const Setpoint& setpoint : trajectory.setpoints) {
    constexpr int kSamples = 4;
    for (int i = 1; i <= kSamples; ++i) {
      Position p;
      for (const Axis axis : kLinearAxes) {
        p[axis] =
            cubic_of(axis, position, velocity, setpoint).position(setpoint.duration * i / kSamples);
      }
      driven.add(point_of(p));
    }
    position = setpoint.position;
    velocity = setpoint.velocity;
  }
  return std::max(largest_distance(driven, programmed), largest_distance(programmed, driven));
}

void add_line(Planner& planner, Path& path, const Position& end, const MoveOptions& options) {
  path.add_line(end);
  REQUIRE(planner.add_line(end, options).has_value());
}

void add_arc(Planner& planner, Path& path, const ArcShape& shape, const MoveOptions& options) {
  path.add_arc(shape);
  REQUIRE(planner.add_arc(shape, options).has_value());
}

}  // namespace cnc::motion::test
