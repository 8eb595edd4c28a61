#include "motion/height_surface.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/motion/dice.h"

namespace cnc::motion::test {

namespace {

HeightSurface random_surface(Dice& dice, std::vector<double>& heights) {
  const auto columns = static_cast<std::size_t>(1 + dice.pick(6));
  const auto rows = static_cast<std::size_t>(1 + dice.pick(6));
  heights.resize(columns * rows);
  for (double& height : heights) height = dice.between(-0.5, 0.5);
  return {-3.0, 4.0, 2.5, columns, rows, heights};
}

}  // namespace

TEST_CASE("A surface goes through its points", "[MOT-5][LNG-5]") {
  const std::vector<double> heights{0.0, 0.1, -0.2, 0.3, 0.05, 0.4};
  const HeightSurface surface(10.0, 20.0, 5.0, 3, 2, heights);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      CHECK(surface.at(10.0 + 5.0 * double(column), 20.0 + 5.0 * double(row)).height ==
            Approx(heights[row * 3 + column]).margin(1e-12));
}

TEST_CASE("A plane is followed exactly, up to its rims", "[MOT-5][LNG-5]") {
  std::vector<double> heights;
  const auto plane = [](double x, double y) { return 0.02 * x - 0.01 * y; };
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column) heights.push_back(plane(10.0 * column, 10.0 * row));
  const HeightSurface surface(0.0, 0.0, 10.0, 5, 4, heights);
  for (double x = 0.0; x <= 40.0; x += 0.7) {
    for (double y = 0.0; y <= 30.0; y += 0.9) {
      const auto value = surface.at(x, y);
      REQUIRE(value.height == Approx(plane(x, y)).margin(1e-12));
      REQUIRE(value.slope_x == Approx(0.02));
      REQUIRE(value.slope_y == Approx(-0.01));
    }
  }
  // Outside it comes to rest within one cell.
  CHECK(surface.at(50.0, 15.0).slope_x == Approx(0.0).margin(1e-12));
  CHECK(surface.at(500.0, 15.0).height == surface.at(50.0, 15.0).height);
  CHECK(surface.at(-500.0, -500.0).height == surface.at(-10.0, -10.0).height);
}

TEST_CASE("A wave is followed between its points", "[MOT-5]") {
  // Interpolation error of a cubic with slopes from differences: at most h³/24 · max|f'''| · 1.2
  const double k = 2.0 * 3.14159265358979 / 60.0;
  std::vector<double> heights;
  for (int row = 0; row < 13; ++row)
    for (int column = 0; column < 13; ++column) heights.push_back(0.1 * std::sin(k * 5.0 * column));
  const HeightSurface surface(0.0, 0.0, 5.0, 13, 13, heights);
  const double bound = 1.2 * 5.0 * 5.0 * 5.0 / 24.0 * 0.1 * k * k * k;
  for (double x = 5.0; x <= 55.0; x += 0.3)
    REQUIRE(std::abs(surface.at(x, 33.0).height - 0.1 * std::sin(k * x)) <= bound);
}

TEST_CASE("Height and slope are continuous everywhere and keep to their bounds", "[MOT-5]") {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    std::vector<double> heights;
    const HeightSurface surface = random_surface(dice, heights);
    const SurfaceBounds& most = surface.bounds();
    constexpr double kStep = 1e-4;
    for (int i = 0; i < 2000; ++i) {
      const double x = dice.between(-12.0, 25.0);
      const double y = dice.between(-5.0, 30.0);
      const auto here = surface.at(x, y);
      const auto right = surface.at(x + kStep, y);
      const auto above = surface.at(x, y + kStep);
      REQUIRE(here.height >= surface.lowest() - 1e-12);
      REQUIRE(here.height <= surface.highest() + 1e-12);
      REQUIRE(std::abs(here.slope_x) <= most.slope_x + 1e-9);
      REQUIRE(std::abs(here.slope_y) <= most.slope_y + 1e-9);
      // Differences are slopes, and differences of slopes bends: also across the cells' borders.
      REQUIRE(right.height - here.height == Approx(0.5 * (here.slope_x + right.slope_x) * kStep)
                                                .margin(2.0 * most.bend_xx * kStep * kStep));
      REQUIRE(std::abs(right.slope_x - here.slope_x) <= most.bend_xx * kStep * 1.0001 + 1e-9);
      REQUIRE(std::abs(above.slope_y - here.slope_y) <= most.bend_yy * kStep * 1.0001 + 1e-9);
      REQUIRE(std::abs(above.slope_x - here.slope_x) <= most.bend_xy * kStep * 1.0001 + 1e-9);
    }
  }
}

}  // namespace cnc::motion::test
