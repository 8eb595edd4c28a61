// Random contours: the tool's edge stays on them, whatever the side, the radius and the corners.
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <random>

#include "tests/interpreter/tool_path.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

constexpr double kRoom = 10.0;  ///< length of each piece, in radii, so that the tool fits

/// Lines and arcs whose direction stays within 60 degrees of +X: the contour cannot meet itself.
class RandomContour {
 public:
  RandomContour(std::mt19937& random, double radius) : random_(random), radius_(radius) {
    direction_ = random_direction();
  }

  void grow(int pieces) {
    for (int i = 0; i < pieces; ++i) {
      if (chance(0.5)) direction_ = random_direction();  // a corner
      if (chance(0.5)) {
        add_arc();
      } else {
        add_line();
      }
    }
  }

  [[nodiscard]] const std::vector<ContourPiece>& pieces() const { return pieces_; }

  /// The contour, entered along its first direction.
  [[nodiscard]] std::string program(bool left) const {
    const PlanePoint along = direction_at_start(pieces_.front());
    const PlanePoint before = (left ? radius_ : -radius_) * left_of(along) - 3.0 * radius_ * along;
    std::string text = fmt::format("G90.1 F1000\nG0 X{:.9f} Y{:.9f}\nG{}.1 D{:.9f}\nG1 X0 Y0\n",
                                   before.first, before.second, left ? 41 : 42, 2 * radius_);
    for (const ContourPiece& piece : pieces_) {
      if (piece.is_arc()) {
        text +=
            fmt::format("G{} X{:.9f} Y{:.9f} I{:.9f} J{:.9f}\n", piece.turns > 0 ? 3 : 2,
                        piece.end.first, piece.end.second, piece.centre.first, piece.centre.second);
      } else {
        text += fmt::format("G1 X{:.9f} Y{:.9f}\n", piece.end.first, piece.end.second);
      }
    }
    return text + "G40\n";
  }

 private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool chance(double probability) { return between(0, 1) < probability; }
  double random_direction() { return between(-M_PI / 3, M_PI / 3); }

  void add(const ContourPiece& piece) {
    pieces_.push_back(piece);
    at_ = piece.end;
  }

  void add_line() {
    const double length = between(kRoom, 2 * kRoom) * radius_;
    add({at_, at_ + length * turned({1, 0}, direction_), {}, 0});
  }

  void add_arc() {
    const double next = random_direction();
    const double sweep = next - direction_;
    if (std::abs(sweep) < 0.1) return add_line();
    const double size = between(kRoom, 2 * kRoom) * radius_ / std::abs(sweep);
    const double sense = sweep > 0 ? 1.0 : -1.0;
    const PlanePoint to_centre = sense * size * left_of(turned({1, 0}, direction_));
    const PlanePoint centre = at_ + to_centre;
    add({at_, centre - turned(to_centre, sweep), centre, sweep > 0 ? 1 : -1});
    direction_ = next;
  }

  std::mt19937& random_;
  double radius_;
  double direction_ = 0.0;
  PlanePoint at_;
  std::vector<ContourPiece> pieces_;
};

double distance_to_contour(const std::vector<ContourPiece>& contour, PlanePoint point) {
  double nearest = 1e9;
  for (const ContourPiece& piece : contour) nearest = std::min(nearest, distance_to(piece, point));
  return nearest;
}

}  // namespace

TEST_CASE("The tool keeps its radius from random contours", "[GCO-4]") {
  constexpr int kSamples = 40;
  constexpr double kWithin = 1e-6;  // a thousandth of what is asked for
  std::mt19937 random(4);
  for (int run = 0; run < 300; ++run) {
    const double radius = std::uniform_real_distribution<double>(0.05, 20)(random);
    RandomContour contour(random, radius);
    contour.grow(8);
    const std::string program = contour.program(run % 2 == 0);
    INFO(program);
    const auto moves = path_of({}, program);
    REQUIRE(moves.size() >= 10);
    double furthest = 0.0;
    for (std::size_t i = 2; i < moves.size(); ++i) {  // behind rapid and entry
      REQUIRE(distance(moves[i - 1].piece.end, moves[i].piece.start) == 0.0);
      for (const PlanePoint point : points_on(moves[i].piece, kSamples)) {
        const double off = std::abs(distance_to_contour(contour.pieces(), point) - radius);
        furthest = std::max(furthest, off);
      }
    }
    REQUIRE(furthest < kWithin);
    // It arrives beside the end of the contour.
    const PlanePoint last = moves.back().piece.end;
    REQUIRE(distance(last, contour.pieces().back().end) == Approx(radius).margin(kWithin));
  }
}

TEST_CASE("Compensated arcs keep their centre, tangent contours get no extra moves", "[GCO-4]") {
  std::mt19937 random(7);
  for (int run = 0; run < 100; ++run) {
    RandomContour contour(random, 1.0);
    contour.grow(1);
    const auto moves = path_of({}, contour.program(true));
    REQUIRE(moves.size() == 3);
    const ContourPiece& piece = contour.pieces().front();
    if (!piece.is_arc()) continue;
    REQUIRE(moves[2].piece.turns == piece.turns);
    REQUIRE(distance(moves[2].piece.centre, piece.centre) < 1e-8);
  }
}
