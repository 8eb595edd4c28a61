#include "tests/interpreter/tool_path.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace cnc::interp::test {
namespace {

/// Angle of `point` seen from the centre, counted from the start in the arc's sense, 0 … 2 pi.
double angle_from_start(const ContourPiece& arc, PlanePoint point) {
  const auto angle = [&](PlanePoint p) {
    return std::atan2(p.second - arc.centre.second, p.first - arc.centre.first);
  };
  const double sense = arc.turns > 0 ? 1.0 : -1.0;
  const double turn = std::fmod(sense * (angle(point) - angle(arc.start)), 2 * std::numbers::pi);
  return turn < 0.0 ? turn + 2 * std::numbers::pi : turn;
}

double sweep_of(const ContourPiece& arc) {
  return distance(arc.start, arc.end) < kSamePoint ? 2 * std::numbers::pi
                                                   : angle_from_start(arc, arc.end);
}

}  // namespace

std::vector<PathMove> path_of(const Bench& bench, std::string_view text, Plane plane) {
  std::vector<PathMove> moves;
  Position at = bench.start;
  const auto add = [&](PathMove::Kind kind, const Position& end, PlanePoint centre, int turns) {
    moves.push_back({kind, at, end, {in_plane(at, plane), in_plane(end, plane), centre, turns}});
    at = end;
  };
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) {
      add(PathMove::Kind::rapid, rapid->end, {}, 0);
    } else if (const auto* feed = std::get_if<FeedMove>(&command.body)) {
      add(PathMove::Kind::feed, feed->end, {}, 0);
    } else if (const auto* arc = std::get_if<ArcMove>(&command.body)) {
      add(PathMove::Kind::arc, arc->end, {arc->first_centre, arc->second_centre}, arc->turns);
    }
  };
  const auto program = Program::from_text(std::string(text), "test.ngc").value();
  const CheckReport report =
      check(program, bench.settings, bench.parameters, bench.tools, bench.start, options);
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  REQUIRE(report.errors.empty());
  return moves;
}

std::vector<PlanePoint> ends_of(const std::vector<PathMove>& moves, Plane plane) {
  std::vector<PlanePoint> ends;
  for (const PathMove& move : moves) ends.push_back(in_plane(move.end, plane));
  return ends;
}

std::vector<PlanePoint> points_on(const ContourPiece& piece, int count) {
  std::vector<PlanePoint> points;
  for (int i = 0; i <= count; ++i) {
    const double share = static_cast<double>(i) / count;
    if (!piece.is_arc()) {
      points.push_back(piece.start + share * (piece.end - piece.start));
      continue;
    }
    const double sense = piece.turns > 0 ? 1.0 : -1.0;
    points.push_back(piece.centre +
                     turned(piece.start - piece.centre, sense * share * sweep_of(piece)));
  }
  return points;
}

double distance_to(const ContourPiece& piece, PlanePoint point) {
  const double to_ends = std::min(distance(piece.start, point), distance(piece.end, point));
  if (piece.is_arc()) {
    if (angle_from_start(piece, point) > sweep_of(piece)) return to_ends;
    return std::min(to_ends,
                    std::abs(distance(piece.centre, point) - distance(piece.centre, piece.start)));
  }
  const PlanePoint along = direction_at_start(piece);
  const double foot = dot(point - piece.start, along);
  if (foot < 0.0 || foot > length_of(piece)) return to_ends;
  return std::abs(cross(along, point - piece.start));
}

}  // namespace cnc::interp::test
