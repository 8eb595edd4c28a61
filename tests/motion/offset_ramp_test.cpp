#include "motion/offset_ramp.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/motion/dice.h"

namespace cnc::motion::test {

TEST_CASE("An offset takes the time of its triangle or trapezoid", "[MOT-5]") {
  struct Row {
    double goal, velocity, acceleration, time;
  };
  for (const Row& row : {
           Row{0.05, 10.0, 100.0, 2.0 * std::sqrt(0.05 / 100.0)},  // never reaches 10 mm/s
           Row{-0.05, 10.0, 100.0, 2.0 * std::sqrt(0.05 / 100.0)},
           Row{1.0, 2.0, 100.0, 1.0 / 2.0 + 2.0 / 100.0},  // d/v + v/a
       }) {
    OffsetRamp ramp(row.velocity, row.acceleration);
    ramp.go_to(row.goal);
    ramp.advance(row.time * 0.999);
    CHECK_FALSE(ramp.arrived());
    ramp.advance(row.time * 0.002);
    CHECK(ramp.arrived());
    CHECK(ramp.value() == row.goal);
  }
}

TEST_CASE("Whenever an offset is sent elsewhere, it keeps its limits and ends exactly", "[MOT-5]") {
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    const double velocity = dice.scale(0.1, 100.0);
    const double acceleration = dice.scale(1.0, 1000.0);
    OffsetRamp ramp(velocity, acceleration);
    double goal = 0.0;
    for (int i = 0; i < 200; ++i) {
      if (dice.chance(0.1)) ramp.go_to(goal = dice.between(-0.2, 0.2));
      const double v = ramp.velocity();
      const double p = ramp.value();
      const double t = dice.scale(1e-5, 0.05);
      ramp.advance(t);
      REQUIRE(std::abs(ramp.velocity()) <= velocity * (1.0 + 1e-7));
      // The last 1e-13 mm of a stop: sqrt(2 a 1e-13) is 1.4e-5 mm/s at the highest a.
      REQUIRE(std::abs(ramp.velocity() - v) <= acceleration * t * (1.0 + 1e-7) + 2e-5);
      // What lies between two velocities at this acceleration.
      const double mean = 0.5 * (ramp.velocity() + v);
      REQUIRE(std::abs(ramp.value() - p - mean * t) <= 0.25 * acceleration * t * t + 1e-9);
    }
    ramp.advance(1000.0);
    REQUIRE(ramp.arrived());
    REQUIRE(ramp.value() == goal);
    REQUIRE(ramp.phase() == 0.0);
  }
}

}  // namespace cnc::motion::test
