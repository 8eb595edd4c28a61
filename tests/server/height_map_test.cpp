#include "server/machine/height_map.h"

#include <catch2/catch.hpp>

using namespace cnc;
using namespace cnc::server;

namespace {

Position point(double x, double y, double z) {
  Position result;
  result[Axis::X] = x;
  result[Axis::Y] = y;
  result[Axis::Z] = z;
  return result;
}

}  // namespace

TEST_CASE("A height map measured to and fro is followed from its first point", "[LNG-5]") {
  HeightMap map(10.0, 3, 2);
  for (const Position& probed : {point(100, 50, -80), point(110, 50, -79.9), point(120, 50, -79.7),
                                 point(120, 60, -79), point(110, 60, -80.2), point(100, 60, -80.1)})
    REQUIRE(map.add(probed));
  const auto surface = map.surface();
  REQUIRE(surface);
  CHECK((*surface)->at(100, 50).height == Approx(0.0).margin(1e-12));
  CHECK((*surface)->at(120, 50).height == Approx(0.3));
  CHECK((*surface)->at(110, 60).height == Approx(-0.2));
}

TEST_CASE("A height map that is none says what is wrong with it", "[LNG-5]") {
  struct Row {
    std::string_view rule;
    std::vector<Position> points;
    std::string_view message;
  };
  for (const Row& row : {
           Row{"nothing measured", {}, "has 0 of its 4 points"},
           Row{"one missed", {point(0, 0, 0), point(1, 0, 0), point(1, 1, 0)}, "has 3 of its 4"},
           Row{"askew",
               {point(0, 0, 0), point(1, 0.2, 0), point(1, 1, 0), point(0, 1, 0)},
               "does not lie on the grid"},
           Row{"too wide",
               {point(0, 0, 0), point(1, 0, 0), point(2, 0, 0), point(0, 1, 0)},
               "does not lie on the grid"},
           Row{"one twice",
               {point(0, 0, 0), point(1, 0, 0), point(1, 0, 0), point(0, 1, 0)},
               "measured twice"},
       }) {
    INFO(row.rule);
    HeightMap map(1.0, 2, 2);
    for (const Position& probed : row.points) REQUIRE(map.add(probed));
    const auto surface = map.surface();
    REQUIRE_FALSE(surface);
    CHECK(surface.error().code == ErrorCode::height_map_unusable);
    CHECK_THAT(surface.error().message, Catch::Contains(std::string(row.message)));
  }
}
