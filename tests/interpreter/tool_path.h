// The moves of a program as geometry, for tests that measure paths.
#pragma once

#include <string_view>
#include <vector>

#include "interpreter/contour.h"
#include "tests/interpreter/support.h"

namespace cnc::interp::test {

/// One move, from where the one before ended.
struct PathMove {
  enum class Kind : std::uint8_t { rapid, feed, arc } kind;
  Position start;
  Position end;
  ContourPiece piece;  ///< in the plane of the path
};

/// Of a program that must run.
std::vector<PathMove> path_of(const Bench& bench, std::string_view text, Plane plane = Plane::xy);

/// End points in the plane.
std::vector<PlanePoint> ends_of(const std::vector<PathMove>& moves, Plane plane = Plane::xy);

/// `count` + 1 points from the start to the end of a piece.
std::vector<PlanePoint> points_on(const ContourPiece& piece, int count);

/// From `point` to the nearest point of `piece`.
double distance_to(const ContourPiece& piece, PlanePoint point);

}  // namespace cnc::interp::test
