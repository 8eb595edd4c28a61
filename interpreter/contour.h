// Pieces of a contour in its plane, straight or round, and the path of a tool's centre beside them:
// the geometry of cutter compensation, free of words, modes and commands
// (docs/cutter-compensation.md).
//
// Sides are signed: an offset is how far to the left of the direction of travel the centre runs,
// negative to the right. A positive turn is counter-clockwise.
#pragma once

#include <optional>

#include "interpreter/arc_geometry.h"

namespace cnc::interp {

struct ContourPiece {
  PlanePoint start;
  PlanePoint end;
  PlanePoint centre;       ///< of an arc
  std::int32_t turns = 0;  ///< 1 counter-clockwise, -1 clockwise, at most once around; 0 = straight

  [[nodiscard]] bool is_arc() const { return turns != 0; }

  friend bool operator==(const ContourPiece&, const ContourPiece&) = default;
};

[[nodiscard]] constexpr double dot(PlanePoint a, PlanePoint b) {
  return a.first * b.first + a.second * b.second;
}
/// The z of the vector product: positive when b points to the left of a.
[[nodiscard]] constexpr double cross(PlanePoint a, PlanePoint b) {
  return a.first * b.second - a.second * b.first;
}
/// `direction` turned a quarter counter-clockwise.
[[nodiscard]] PlanePoint left_of(PlanePoint direction);
[[nodiscard]] PlanePoint turned(PlanePoint direction, double angle);

/// Unit vectors along the piece.
[[nodiscard]] PlanePoint direction_at_start(const ContourPiece& piece);
[[nodiscard]] PlanePoint direction_at_end(const ContourPiece& piece);
/// Positive counter-clockwise; 0 of a line.
[[nodiscard]] double curvature_of(const ContourPiece& piece);
[[nodiscard]] double length_of(const ContourPiece& piece);

/// The path beside `piece`. Nothing for the inside of an arc whose radius is not larger than the
/// offset.
[[nodiscard]] std::optional<ContourPiece> offset_piece(const ContourPiece& piece, double offset);

/// Where two paths cross, nearest to the end of the first one.
struct Crossing {
  PlanePoint point;
  double back = 0.0;     ///< along the first, from its end
  double forward = 0.0;  ///< along the second, from its start
};
/// Both are taken as lines and circles without ends: `back` and `forward` tell whether the crossing
/// lies on the pieces. Nothing when they do not cross behind the end of `before`.
[[nodiscard]] std::optional<Crossing> crossing_of(const ContourPiece& before,
                                                  const ContourPiece& after);

/// The angle from the end of `before` to the start of `after`, -pi … pi.
[[nodiscard]] double corner_angle(const ContourPiece& before, const ContourPiece& after);

/// The line to `target` that a tool at `tool` begins a contour with (manual A.2, figure A-6): its
/// path is tangent to the tool where it stands. Nothing when the tool covers `target`.
[[nodiscard]] std::optional<ContourPiece> entry_line(PlanePoint tool, PlanePoint target,
                                                     double offset);

}  // namespace cnc::interp
