// Q: short lines become long ones, within the tolerance.
#include "motion/simplifier.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "tests/motion/dice.h"
#include "tests/motion/path_judge.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

Piece line(const Position& start, const Position& end, double simplify) {
  Piece piece;
  piece.curve = Line(start, end);
  piece.end = length_of(piece.curve);
  piece.feed = 10.0;
  piece.simplify = simplify;
  return piece;
}

/// What comes out for lines through these points, as the points of the joined lines.
std::vector<Position> simplified(const std::vector<Position>& points, double simplify) {
  std::vector<Position> result{points.front()};
  Simplifier simplifier;
  const auto pass = [&](const std::optional<Piece>& piece) {
    if (piece) result.push_back(point_of(piece->curve, piece->end));
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Piece piece = line(points[i - 1], points[i], simplify);
    if (simplifier.add(piece)) continue;
    pass(simplifier.take());
    if (!simplifier.add(piece)) pass(piece);
  }
  pass(simplifier.take());
  return result;
}

}  // namespace

TEST_CASE("Lines within Q of their chord become one, others stay", "[GCO-6]") {
  // A bow of 0.01 mm over 10 mm, then a corner.
  const std::vector<Position> points{xyz(0, 0), xyz(5, 0.01), xyz(10, 0), xyz(10, 5), xyz(10, 9)};
  CHECK(simplified(points, 0.02).size() == 3);
  CHECK(simplified(points, 0.005).size() == 4);
  CHECK(simplified(points, 0.0).size() == 5);
}

TEST_CASE("A line that goes back on itself is not joined", "[GCO-6]") {
  CHECK(simplified({xyz(0, 0), xyz(10, 0), xyz(5, 0), xyz(20, 0)}, 0.1).size() == 4);
}

TEST_CASE("Moves that want different things are not joined", "[GCO-6]") {
  Simplifier simplifier;
  const Piece first = line(xyz(0, 0), xyz(1, 0), 0.1);
  Piece second = line(xyz(1, 0), xyz(2, 0), 0.1);
  const auto joined = [&](auto change) {
    Piece changed = second;
    change(changed);
    simplifier.clear();
    REQUIRE(simplifier.add(first));
    return simplifier.add(changed);
  };
  CHECK(joined([](Piece&) {}));
  CHECK_FALSE(joined([](Piece& p) { p.feed = 11.0; }));
  CHECK_FALSE(joined([](Piece& p) { p.tolerance = 0.5; }));
  CHECK_FALSE(joined([](Piece& p) { p.kind = MoveKind::rapid; }));
  CHECK_FALSE(joined([](Piece& p) { p.override = Override::feed_per_turn; }));
  CHECK_FALSE(joined([](Piece& p) { p.tag.begins_at_index = true; }));
  simplifier.clear();
  Piece stops = first;
  stops.stop_at_end = true;
  REQUIRE(simplifier.add(stops));
  CHECK_FALSE(simplifier.add(second));
}

TEST_CASE("No vertex is farther than Q from the joined lines", "[GCO-6][property]") {
  const auto seed = static_cast<std::uint32_t>(GENERATE(range(1, 41)));
  CAPTURE(seed);
  Dice dice(seed);
  const double q = dice.scale(1e-4, 0.5);
  std::vector<Position> points{xyz(0, 0)};
  double heading = 0.0;
  for (int i = 0; i < 300; ++i) {
    heading += dice.between(-0.3, 0.3);
    const double length = dice.scale(0.01, 1.0);
    const Position& last = points.back();
    points.push_back(xyz(last[Axis::X] + length * std::cos(heading),
                         last[Axis::Y] + length * std::sin(heading),
                         last[Axis::Z] + dice.between(-0.01, 0.01)));
  }
  Polyline before(2.0);
  Polyline after(2.0);
  for (const Position& point : points) before.add(point_of(point));
  const std::vector<Position> fewer = simplified(points, q);
  for (const Position& point : fewer) after.add(point_of(point));
  CHECK(fewer.size() <= points.size());
  CHECK(largest_distance(before, after) <= q * (1.0 + 1e-9));
  CHECK(largest_distance(after, before) <= q * (1.0 + 1e-9));
  CHECK(fewer.back() == points.back());
}

}  // namespace cnc::motion::test
