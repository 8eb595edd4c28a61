// The fixed-point cubic against the same polynomial in long double.
#include <catch2/catch.hpp>
#include <random>

#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

long double in_steps(std::int64_t fixed) {
  return std::ldexp(static_cast<long double>(fixed), -32);
}

long double exact_distance(const AxisMotion& motion, Ticks elapsed) {
  const auto duration = static_cast<long double>(motion.duration);
  const long double u = static_cast<long double>(elapsed) / duration;
  const long double way = in_steps(motion.distance);
  const long double a = duration * in_steps(motion.start_velocity);
  const long double b = duration * in_steps(motion.end_velocity);
  return a * u + (3 * way - 2 * a - b) * u * u + (a + b - 2 * way) * u * u * u;
}

AxisMotion random_motion(std::mt19937_64& random) {
  const auto velocity = [&] {
    return std::uniform_int_distribution<StepVelocity>(-kTopVelocity, kTopVelocity)(random);
  };
  const Ticks duration = std::uniform_int_distribution<Ticks>(1, kMaxSegmentTicks)(random);
  return {.distance = velocity() * duration,
          .start_velocity = velocity(),
          .end_velocity = velocity(),
          .duration = duration};
}

}  // namespace

TEST_CASE("The fixed-point cubic stays within 2^-31 step of the true one", "[hal][LNK-2]") {
  std::mt19937_64 random(1);
  long double worst = 0;
  for (int i = 0; i < 20'000; ++i) {
    const AxisMotion motion = random_motion(random);
    const Cubic cubic(motion);
    const Ticks elapsed = std::uniform_int_distribution<Ticks>(0, motion.duration)(random);
    const long double error =
        in_steps(cubic.distance_after(elapsed)) - exact_distance(motion, elapsed);
    worst = std::max(worst, std::fabs(error));
  }
  CHECK(worst < std::ldexp(1.0L, -31));
}

TEST_CASE("The largest numbers that the core accepts do not overflow the cubic", "[hal][LNK-3]") {
  const StepVelocity top = kTopVelocity;
  for (const StepVelocity start : {-top, top}) {
    for (const StepVelocity end : {-top, top}) {
      for (const StepVelocity mean : {-top, top}) {
        const AxisMotion motion{mean * kMaxSegmentTicks, start, end, kMaxSegmentTicks};
        const Cubic cubic(motion);
        for (Ticks elapsed = 0; elapsed <= kMaxSegmentTicks; elapsed += kMaxSegmentTicks / 64) {
          const long double error =
              in_steps(cubic.distance_after(elapsed)) - exact_distance(motion, elapsed);
          REQUIRE(std::fabs(error) < std::ldexp(1.0L, -31));
        }
      }
    }
  }
}

TEST_CASE("A cubic leaves and arrives at the velocities of its ends", "[hal][LNK-2]") {
  // 0.1 ms after the start the way is v0 t, but for a t^2/2 and j t^3/6; the coefficients of the
  // cubic bound both: quadratic t^2/T^2 and cubic t^3/T^3, in steps.
  std::mt19937_64 random(2);
  constexpr Ticks kShort = 1000;
  for (int i = 0; i < 1000; ++i) {
    AxisMotion motion = random_motion(random);
    motion.duration = std::max<Ticks>(motion.duration, 10 * kShort);
    motion.distance = (motion.start_velocity + motion.end_velocity) / 2 * motion.duration;
    const Cubic cubic(motion);
    const long double first = in_steps(cubic.distance_after(kShort));
    const long double last =
        in_steps(motion.distance - cubic.distance_after(motion.duration - kShort));
    // With the mean of both velocities as its mean speed, the cubic is a constant acceleration.
    const long double acceleration = in_steps(motion.end_velocity - motion.start_velocity) /
                                     static_cast<long double>(motion.duration);
    const long double bend = acceleration * kShort * kShort / 2;
    const long double tolerance = std::ldexp(1.0L, -20);
    REQUIRE(std::fabs(first - in_steps(motion.start_velocity) * kShort - bend) < tolerance);
    REQUIRE(std::fabs(last - in_steps(motion.end_velocity) * kShort + bend) < tolerance);
  }
}

TEST_CASE("The peak speed is the highest slope anywhere in the segment", "[hal][LNK-3]") {
  SECTION("from rest to rest it is one and a half times the mean speed") {
    const AxisMotion motion{steps(1000), 0, 0, ticks(0.01)};
    CHECK(std::abs(peak_speed(motion) - steps_per_second(150'000)) <= 64);
  }
  SECTION("for random segments it is what sampling finds") {
    std::mt19937_64 random(3);
    for (int i = 0; i < 500; ++i) {
      const AxisMotion motion = random_motion(random);
      const auto duration = static_cast<long double>(motion.duration);
      const long double v0 = in_steps(motion.start_velocity);
      const long double v1 = in_steps(motion.end_velocity);
      const long double middle = 3 * in_steps(motion.distance) / duration - v0 - v1;
      long double sampled = 0;
      for (int k = 0; k <= 1000; ++k) {
        const long double u = k / 1000.0L;
        const long double v = v0 * (1 - u) * (1 - u) + 2 * middle * u * (1 - u) + v1 * u * u;
        sampled = std::max(sampled, std::fabs(v));
      }
      const long double found = in_steps(peak_speed(motion));
      REQUIRE(found >= sampled - in_steps(64));
      REQUIRE(found <= sampled * 1.0001L + in_steps(64));
    }
  }
}
