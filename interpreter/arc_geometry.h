// Arcs in their plane: from the words of a program to a centre (manual 3.4.3).
#pragma once

#include <cmath>

#include "interpreter/canonical.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

/// A point in the plane of an arc, along its first and second axis, mm.
struct PlanePoint {
  double first = 0.0;
  double second = 0.0;

  friend constexpr bool operator==(const PlanePoint&, const PlanePoint&) = default;
};
[[nodiscard]] constexpr PlanePoint operator+(PlanePoint a, PlanePoint b) {
  return {a.first + b.first, a.second + b.second};
}
[[nodiscard]] constexpr PlanePoint operator-(PlanePoint a, PlanePoint b) {
  return {a.first - b.first, a.second - b.second};
}
[[nodiscard]] constexpr PlanePoint operator*(double factor, PlanePoint p) {
  return {factor * p.first, factor * p.second};
}

/// Points closer than this, mm, are one: far below any step, far above the rounding of positions.
/// An arc that ends so close to its start is a full circle, for the planner too (motion/curve.h).
inline constexpr double kSamePoint = 1e-6;

// std::hypot takes four times as long, to guard against an overflow that lengths up to 1e9 mm
// cannot cause.
[[nodiscard]] inline double distance(PlanePoint a, PlanePoint b) {
  const PlanePoint way = b - a;
  return std::sqrt(way.first * way.first + way.second * way.second);
}
[[nodiscard]] constexpr PlanePoint in_plane(const Position& position, Plane plane) {
  const PlaneAxes axes = axes_of(plane);
  return {position[axes.first], position[axes.second]};
}
/// `position` with its two coordinates of `plane` replaced.
[[nodiscard]] Position with_plane_point(Position position, Plane plane, PlanePoint point);

/// How far the two radii of an arc may differ. The manual says 0.002 mm or 0.0002 inch. Post
/// processors that round to three decimals miss that on large arcs, so 0.1 % of the radius is
/// allowed too: on 100 mm that is what rounding the centre to 0.1 mm does.
[[nodiscard]] double radius_tolerance(LengthUnit unit, double radius);

/// Refuses a centre from which start and end are not equally far.
[[nodiscard]] Accepted check_centre(PlanePoint start, PlanePoint end, PlanePoint centre,
                                    LengthUnit unit, Span span);

/// What becomes of a radius that does not reach the end point.
enum class ShortRadius : std::uint8_t { refused, half_circle };

/// The centre of an arc given by its radius: positive up to half a turn, negative more.
[[nodiscard]] Parsed<PlanePoint> centre_of_radius(PlanePoint start, PlanePoint end, double radius,
                                                  bool clockwise, LengthUnit unit,
                                                  ShortRadius short_radius, Span span);

}  // namespace cnc::interp
