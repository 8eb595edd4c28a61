// Seconds to ticks of 0.1 us without losing time.
#include "hal/cpu5/driver/tick_clock.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

using cnc::hal::cpu5::TickClock;

TEST_CASE("The sum of ticks stays within half a tick of the sum of seconds", "[hal][LNK-2]") {
  TickClock clock;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any_duration(20e-6, 0.01);
  double seconds = 0.0;
  std::uint64_t ticks = 0;
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double duration = any_duration(random);
    seconds += duration;
    ticks += clock.ticks_for(duration);
    worst = std::max(worst, std::abs(seconds * 1e7 - static_cast<double>(ticks)));
  }
  CHECK(worst < 0.5001);
}

TEST_CASE("A segment too short for the board is stretched, and the next ones pay it back",
          "[hal][LNK-2]") {
  TickClock clock;
  CHECK(clock.ticks_for(1e-6) == 100);     // 90 ticks too many
  CHECK(clock.ticks_for(0.0005) == 4980);  // 5000 less one part in 256, 19.5
  CHECK(clock.ticks_for(0.005) == 49930);  // all of the other 70
  CHECK(clock.ticks_for(0.005) == 50000);
}

TEST_CASE("A duration that is none gives none", "[hal]") {
  TickClock clock;
  CHECK(clock.ticks_for(0.0) == 0);
  CHECK(clock.ticks_for(-0.005) == 0);
  CHECK(clock.ticks_for(0.2) == 0);
  CHECK(clock.ticks_for(std::numeric_limits<double>::quiet_NaN()) == 0);
  CHECK(clock.ticks_for(std::numeric_limits<double>::infinity()) == 0);
  CHECK(clock.ticks_for(0.005) == 50000);
}
