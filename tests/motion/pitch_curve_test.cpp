#include "motion/pitch_curve.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/motion/dice.h"

namespace cnc::motion::test {

TEST_CASE("The manual's pitch table: the motor makes up for what was measured", "[MOT-5][CFG-24]") {
  // Manual 2.3: at machine position 50 the machine is at 50.01; to be at 50.01 the motor goes
  // to 50.
  const std::vector<config::PitchPoint> table{{0, 0},        {50, 50.01},   {200, 200.02},
                                              {300, 300.03}, {400, 400.04}, {500, 500.05}};
  const PitchCurve curve(table);
  for (const config::PitchPoint& point : table) {
    CHECK(point.calibrated + curve.at(point.calibrated).correction == Approx(point.machine));
    CHECK(curve.undone(point.machine) == Approx(point.calibrated));
  }
  CHECK(curve.largest() == Approx(0.05));
  CHECK(curve.at(-100.0).correction == 0.0);
  CHECK(curve.at(900.0).correction == Approx(-0.05));
  CHECK(curve.at(900.0).slope == 0.0);
}

TEST_CASE("Without a table nothing is corrected", "[MOT-5]") {
  const PitchCurve none;
  CHECK(none.at(12.0).correction == 0.0);
  CHECK(none.undone(12.0) == 12.0);
  CHECK(none.steepest() == 0.0);
}

TEST_CASE("A pitch curve is smooth, monotone between its points and undone exactly", "[MOT-5]") {
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    std::vector<config::PitchPoint> table{{dice.between(-50, 50), dice.between(-50, 50)}};
    for (int i = 0; i < 12; ++i) {
      const double way = dice.scale(0.5, 100.0);
      table.push_back(
          {table.back().machine + way, table.back().calibrated + way * dice.between(0.951, 1.049)});
    }
    const PitchCurve curve(table);
    double steepest = 0.0;
    for (std::size_t i = 0; i + 1 < table.size(); ++i) {
      const auto& a = table[i];
      const auto& b = table[i + 1];
      const double ea = a.machine - a.calibrated;
      const double eb = b.machine - b.calibrated;
      constexpr int kParts = 50;
      for (int k = 0; k < kParts; ++k) {
        const double x = a.calibrated + (b.calibrated - a.calibrated) * k / kParts;
        const auto here = curve.at(x);
        const auto next = curve.at(x + 1e-4);
        REQUIRE(here.correction >= std::min(ea, eb) - 1e-12);
        REQUIRE(here.correction <= std::max(ea, eb) + 1e-12);
        REQUIRE(next.correction - here.correction ==
                Approx(0.5e-4 * (here.slope + next.slope)).margin(1e-8 * curve.most_curved()));
        REQUIRE(std::abs(next.slope - here.slope) <= curve.most_curved() * 1.0001e-4 + 1e-12);
        steepest = std::max(steepest, std::abs(here.slope));
        REQUIRE(curve.undone(x + here.correction) == Approx(x).margin(1e-11));
      }
    }
    REQUIRE(steepest <= curve.steepest() * (1.0 + 1e-12));
    REQUIRE(steepest >= curve.steepest() * 0.98);
  }
}

}  // namespace cnc::motion::test
