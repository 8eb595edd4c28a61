#include "motion/extents.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

TEST_CASE("The extents of an arc reach to the quadrant points that it passes", "[MOT-4]") {
  // Around the origin with radius 10 from 45° to 135°: passes 90° only.
  const double c = 10.0 / std::sqrt(2.0);
  const auto arc = make_arc(xyz(c, c), {xyz(-c, c, 5), Plane::xy, 0.0, 0.0, 1});
  REQUIRE(arc.has_value());
  const Extents extents = extents_of_arc(*arc);
  CHECK(extents.max[Axis::Y] == Approx(10.0));
  CHECK(extents.min[Axis::Y] == Approx(c));
  CHECK(extents.min[Axis::X] == Approx(-c));
  CHECK(extents.max[Axis::X] == Approx(c));
  CHECK(extents.min[Axis::Z] == 0.0);
  CHECK(extents.max[Axis::Z] == 5.0);
}

TEST_CASE("The extents of any arc contain it and are no larger than it", "[MOT-4]") {
  for (const Plane plane : {Plane::xy, Plane::xz, Plane::yz}) {
    const PlaneAxes axes = axes_of(plane);
    for (int from = 0; from < 24; ++from) {
      for (const int turns : {1, -1, 2, -2, 7}) {
        const double a = 0.27 * from;
        const double b = 0.61 * from + 1.0;
        Position start;
        start[axes.first] = 3.0 + 10.0 * std::cos(a);
        start[axes.second] = -2.0 + 10.0 * std::sin(a);
        Position end;
        end[axes.first] = 3.0 + 10.01 * std::cos(b);
        end[axes.second] = -2.0 + 10.01 * std::sin(b);
        end[axes.third] = 4.0;
        const auto arc = make_arc(start, {end, plane, 3.0, -2.0, turns});
        REQUIRE(arc.has_value());
        const Extents extents = extents_of_arc(*arc);
        Extents seen{start, start};
        for (int i = 0; i <= 20000; ++i) seen.include(arc->point(arc->length() * i / 20000.0));
        for (const Axis axis : kAllAxes) {
          // Dense samples miss the top by R θ²/8 < 1e-5 at most.
          CHECK(extents.min[axis] <= seen.min[axis] + 1e-7);
          CHECK(extents.max[axis] >= seen.max[axis] - 1e-7);
          CHECK(extents.min[axis] >= seen.min[axis] - 2e-5);
          CHECK(extents.max[axis] <= seen.max[axis] + 2e-5);
        }
      }
    }
  }
}

}  // namespace cnc::motion::test
