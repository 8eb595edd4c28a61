#include "motion/curve.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

constexpr double kPi = std::numbers::pi;

Arc arc_of(const Position& start, const ArcShape& shape) {
  const auto arc = make_arc(start, shape);
  REQUIRE(arc.has_value());
  return *arc;
}

/// q' and q'' against differences of q and q'.
void require_derivatives(const Curve& curve) {
  const double length = length_of(curve);
  const double h = 1e-5 * length;
  for (int i = 1; i < 20; ++i) {
    const double s = length * i / 20.0;
    const Position first = (point_of(curve, s + h) - point_of(curve, s - h)) * (0.5 / h);
    const Position second = (tangent_of(curve, s + h) - tangent_of(curve, s - h)) * (0.5 / h);
    CHECK(norm(first - tangent_of(curve, s)) < 1e-6 * norm(first));
    CHECK(norm(second - bend_of(curve, s)) < 1e-5 * (norm(second) + 1e-9));
  }
}

}  // namespace

TEST_CASE("An arc turns in the sense and as often as turns says", "[MOT-4]") {
  // From (10, 0) around the origin to (0, 10): a quarter counter-clockwise, three clockwise.
  const Position start = xyz(10, 0);
  const auto sweep = [&](std::int32_t turns) {
    return arc_of(start, {xyz(0, 10), Plane::xy, 0.0, 0.0, turns}).sweep();
  };
  CHECK(sweep(1) == Approx(0.5 * kPi));
  CHECK(sweep(-1) == Approx(-1.5 * kPi));
  CHECK(sweep(2) == Approx(2.5 * kPi));
  CHECK(sweep(-3) == Approx(-5.5 * kPi));
}

TEST_CASE("An arc that ends where it starts is a full turn, in spite of rounding", "[MOT-4]") {
  const Position start = xyz(10, 0);
  CHECK(arc_of(start, {start, Plane::xy, 0.0, 0.0, 1}).sweep() == Approx(2.0 * kPi));
  CHECK(arc_of(start, {start, Plane::xy, 0.0, 0.0, -1}).sweep() == Approx(-2.0 * kPi));
  const Position before = xyz(10, -1e-10);
  const Position behind = xyz(10, 1e-10);
  CHECK(arc_of(start, {before, Plane::xy, 0.0, 0.0, 1}).sweep() == Approx(2.0 * kPi));
  CHECK(arc_of(start, {behind, Plane::xy, 0.0, 0.0, 1}).sweep() == Approx(2.0 * kPi));
}

TEST_CASE("A helix has the length of its unrolled triangle in each plane", "[MOT-4]") {
  for (const Plane plane : {Plane::xy, Plane::xz, Plane::yz}) {
    const PlaneAxes axes = axes_of(plane);
    Position start;
    start[axes.first] = 10.0;
    Position end;
    end[axes.second] = 10.0;
    end[axes.third] = 7.0;
    end[Axis::B] = 90.0;
    const Arc arc = arc_of(start, {end, plane, 0.0, 0.0, 2});
    CHECK(arc.length() == Approx(std::hypot(10.0 * 2.5 * kPi, 7.0)));
    // Half way: 1.25 turns, half of the rise, half of the rotary axis.
    const Position middle = arc.point(0.5 * arc.length());
    CHECK(middle[axes.first] == Approx(10.0 * std::cos(1.25 * kPi)));
    CHECK(middle[axes.second] == Approx(10.0 * std::sin(1.25 * kPi)));
    CHECK(middle[axes.third] == Approx(3.5));
    CHECK(middle[Axis::B] == Approx(45.0));
    CHECK(arc.point(arc.length()) == end);
    CHECK(arc.point(0.0) == start);
    require_derivatives(arc);
  }
}

TEST_CASE("A small radius mismatch becomes a spiral of constant speed that meets the end",
          "[MOT-4]") {
  // Radius 10 at the start, 10.005 at the end, half a turn and a rise of 3.
  const Arc arc = arc_of(xyz(10, 0), {xyz(-10.005, 0, 3), Plane::xy, 0.0, 0.0, 1});
  CHECK(arc.point(arc.length()) == xyz(-10.005, 0, 3));
  // The formula itself arrives there too, not only the stored end.
  CHECK(norm(arc.point(arc.length() * (1.0 - 1e-12)) - xyz(-10.005, 0, 3)) < 1e-9);
  for (int i = 0; i <= 10; ++i) {
    const double s = arc.length() * i / 10.0;
    CHECK(linear_length(arc.tangent(s)) == Approx(1.0).epsilon(1e-12));
    CHECK(arc.radius(s) == Approx(10.0 + 0.0005 * i).epsilon(1e-9));
  }
  require_derivatives(arc);
}

TEST_CASE("An arc's points lie on its circle to 0.1 µm for radii from 1 µm to 100 m", "[MOT-4]") {
  for (const double radius : {1e-3, 1.0, 50.0, 1e4, 1e5}) {
    const Position start = xyz(0, 0);
    const Arc arc = arc_of(start, {xyz(-radius, radius), Plane::xy, -radius, 0.0, 1});
    CHECK(arc.sweep() == Approx(0.5 * kPi));
    for (int i = 0; i <= 100; ++i) {
      const Position p = arc.point(arc.length() * i / 100.0);
      CHECK(std::abs(std::hypot(p[Axis::X] + radius, p[Axis::Y]) - radius) < 1e-7);
    }
  }
}

TEST_CASE("Arcs without radius, without turns or with radii that do not fit are refused",
          "[MOT-4]") {
  const Position start = xyz(10, 0);
  const auto code = [&](const ArcShape& shape) {
    const auto arc = make_arc(start, shape);
    REQUIRE_FALSE(arc.has_value());
    return arc.error().code;
  };
  CHECK(code({xyz(0, 10), Plane::xy, 10.0, 0.0, 1}) == ErrorCode::arc_impossible);
  CHECK(code({xyz(0, 10), Plane::xy, 0.0, 0.0, 0}) == ErrorCode::arc_impossible);
  CHECK(code({xyz(0, 10.2), Plane::xy, 0.0, 0.0, 1}) == ErrorCode::arc_impossible);
}

TEST_CASE("A rotary-only line is measured in degrees, any other in the mm of X Y Z", "[MOT-1]") {
  Position rotary;
  rotary[Axis::A] = 30.0;
  rotary[Axis::B] = 40.0;
  CHECK(Line({}, rotary).length() == Approx(50.0));
  CHECK(Line({}, rotary).measure() == Measure::rotary);
  Position mixed = xyz(3, 4);
  mixed[Axis::A] = 30.0;
  CHECK(Line({}, mixed).length() == Approx(5.0));
  CHECK(Line({}, mixed).direction()[Axis::A] == Approx(6.0));
}

TEST_CASE("A blend between lines is the parabola that passes the corner at cut |u2 - u1| / 4",
          "[MOT-2]") {
  // 90° corner at the origin, cut 1 mm: |u2 − u1| = √2, so the middle is √2/4 from the corner.
  const Cubic blend = hermite_cubic(xyz(-1, 0), xyz(1, 0), xyz(0, 1), xyz(0, 1), 2.0);
  CHECK(linear_length(blend.point(1.0)) == Approx(std::sqrt(2.0) / 4.0));
  CHECK(linear_length(blend.tangent(0.0)) == Approx(1.0));
  CHECK(linear_length(blend.tangent(2.0)) == Approx(1.0));
  // Constant q'' = (u2 − u1) / (2 cut).
  CHECK(norm(blend.bend(0.0) - xyz(-0.5, 0.5)) < 1e-12);
  CHECK(norm(blend.bend(2.0) - xyz(-0.5, 0.5)) < 1e-12);
  require_derivatives(blend);
}

}  // namespace cnc::motion::test
