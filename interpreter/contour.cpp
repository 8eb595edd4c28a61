#include "interpreter/contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace cnc::interp {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

[[nodiscard]] PlanePoint unit(PlanePoint p) { return 1.0 / std::hypot(p.first, p.second) * p; }

/// +1 counter-clockwise, -1 clockwise.
[[nodiscard]] double sense(const ContourPiece& arc) { return arc.turns > 0 ? 1.0 : -1.0; }

[[nodiscard]] PlanePoint direction_at(const ContourPiece& arc, PlanePoint point) {
  return sense(arc) * left_of(unit(point - arc.centre));
}

/// From `from` to `to` around the centre in the arc's sense, 0 … 2 pi.
[[nodiscard]] double sweep(const ContourPiece& arc, PlanePoint from, PlanePoint to) {
  const PlanePoint a = from - arc.centre;
  const PlanePoint b = to - arc.centre;
  const double angle = sense(arc) * std::atan2(cross(a, b), dot(a, b));
  return angle < 0.0 ? angle + kTurn : angle;
}

/// Radii at both ends may differ a little (radius_tolerance()); each end keeps its own.
[[nodiscard]] double radius_at(const ContourPiece& arc, PlanePoint point) {
  return distance(arc.centre, point);
}

/// At most two points.
class Points {
 public:
  void add(PlanePoint point) { points_[count_++] = point; }
  [[nodiscard]] std::span<const PlanePoint> all() const& { return {points_.data(), count_}; }
  void all() && = delete;

 private:
  std::array<PlanePoint, 2> points_{};
  std::size_t count_ = 0;
};

Points line_with_line(PlanePoint a, PlanePoint along_a, PlanePoint b, PlanePoint along_b) {
  Points points;
  const double sine = cross(along_a, along_b);
  if (sine != 0.0) points.add(a + cross(b - a, along_b) / sine * along_a);
  return points;
}

Points line_with_circle(PlanePoint a, PlanePoint along_a, PlanePoint centre, double radius) {
  Points points;
  const double foot = dot(centre - a, along_a);
  const double height = cross(along_a, centre - a);
  const double square = (radius - height) * (radius + height);
  if (square < 0.0) return points;
  const double half_chord = std::sqrt(square);
  points.add(a + (foot - half_chord) * along_a);
  points.add(a + (foot + half_chord) * along_a);
  return points;
}

Points circle_with_circle(PlanePoint a, double radius_a, PlanePoint b, double radius_b) {
  Points points;
  const double apart = distance(a, b);
  if (apart == 0.0) return points;
  const PlanePoint along = 1.0 / apart * (b - a);
  const double foot = (apart + (radius_a - radius_b) * (radius_a + radius_b) / apart) / 2.0;
  const double square = (radius_a - foot) * (radius_a + foot);
  if (square < 0.0) return points;
  const double half_chord = std::sqrt(square);
  points.add(a + foot * along + half_chord * left_of(along));
  points.add(a + foot * along - half_chord * left_of(along));
  return points;
}

Points crossings(const ContourPiece& before, const ContourPiece& after) {
  const double radius_before = radius_at(before, before.end);
  const double radius_after = radius_at(after, after.start);
  if (before.is_arc() && after.is_arc()) {
    return circle_with_circle(before.centre, radius_before, after.centre, radius_after);
  }
  if (before.is_arc()) {
    return line_with_circle(after.start, direction_at_start(after), before.centre, radius_before);
  }
  if (after.is_arc()) {
    return line_with_circle(before.end, direction_at_end(before), after.centre, radius_after);
  }
  return line_with_line(before.end, direction_at_end(before), after.start,
                        direction_at_start(after));
}

[[nodiscard]] double way_back(const ContourPiece& piece, PlanePoint point) {
  if (!piece.is_arc()) return dot(piece.end - point, direction_at_end(piece));
  return sweep(piece, point, piece.end) * radius_at(piece, piece.end);
}

[[nodiscard]] double way_forward(const ContourPiece& piece, PlanePoint point) {
  if (!piece.is_arc()) return dot(point - piece.start, direction_at_start(piece));
  return sweep(piece, piece.start, point) * radius_at(piece, piece.start);
}

}  // namespace

PlanePoint left_of(PlanePoint direction) { return {-direction.second, direction.first}; }
PlanePoint turned(PlanePoint direction, double angle) {
  return std::cos(angle) * direction + std::sin(angle) * left_of(direction);
}

PlanePoint direction_at_start(const ContourPiece& piece) {
  return piece.is_arc() ? direction_at(piece, piece.start) : unit(piece.end - piece.start);
}

PlanePoint direction_at_end(const ContourPiece& piece) {
  return piece.is_arc() ? direction_at(piece, piece.end) : unit(piece.end - piece.start);
}

double curvature_of(const ContourPiece& piece) {
  return piece.is_arc() ? sense(piece) / radius_at(piece, piece.end) : 0.0;
}

double length_of(const ContourPiece& piece) {
  if (!piece.is_arc()) return distance(piece.start, piece.end);
  const bool closed = distance(piece.start, piece.end) < kSamePoint;
  const double angle = closed ? kTurn : sweep(piece, piece.start, piece.end);
  return angle * (radius_at(piece, piece.start) + radius_at(piece, piece.end)) / 2.0;
}

// Left of a counter-clockwise arc is its inside: the radius shrinks by the offset.
std::optional<ContourPiece> offset_piece(const ContourPiece& piece, double offset) {
  if (piece.is_arc()) {
    const double shrink = offset * sense(piece);
    const double smaller = std::min(radius_at(piece, piece.start), radius_at(piece, piece.end));
    if (smaller - shrink <= kSamePoint) return std::nullopt;
  }
  ContourPiece path = piece;
  path.start = piece.start + offset * left_of(direction_at_start(piece));
  path.end = piece.end + offset * left_of(direction_at_end(piece));
  return path;
}

std::optional<Crossing> crossing_of(const ContourPiece& before, const ContourPiece& after) {
  std::optional<Crossing> nearest;
  const Points points = crossings(before, after);
  for (const PlanePoint point : points.all()) {
    const double back = way_back(before, point);
    if (back < 0.0 || (nearest && nearest->back <= back)) continue;
    nearest = Crossing{point, back, way_forward(after, point)};
  }
  return nearest;
}

double corner_angle(const ContourPiece& before, const ContourPiece& after) {
  const PlanePoint in = direction_at_end(before);
  const PlanePoint out = direction_at_start(after);
  return std::atan2(cross(in, out), dot(in, out));
}

// The tool runs from T to E, E beside the target Q: a right triangle with the hypotenuse TQ and one
// side as long as the offset. With the path's direction u, Q - T = way u - offset left_of(u), which
// is solved for u like a division of complex numbers.
std::optional<ContourPiece> entry_line(PlanePoint tool, PlanePoint target, double offset) {
  const PlanePoint apart = target - tool;
  const double hypotenuse = std::hypot(apart.first, apart.second);
  const double square = (hypotenuse - offset) * (hypotenuse + offset);
  if (square <= kSamePoint * kSamePoint) return std::nullopt;
  const double way = std::sqrt(square);
  const PlanePoint direction =
      1.0 / (hypotenuse * hypotenuse) * (way * apart + offset * left_of(apart));
  return ContourPiece{.start = target - way * direction, .end = target, .centre = {}, .turns = 0};
}

}  // namespace cnc::interp
