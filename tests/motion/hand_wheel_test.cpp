#include "motion/hand_wheel.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/motion/dice.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

constexpr double kTick = 0.005;
constexpr double kPerCount = 0.01;

/// An X axis that a hand turns: `counts` per tick.
struct Bench {
  explicit Bench(HandWheelMode mode, std::int32_t count = 0, double speed = 80.0)
      : jog(reference_limits(), kTick, {}),
        wheel(Axis::X, {mode, kPerCount, speed}, count, 0.0),
        count_now(count) {}

  void turn(std::int32_t counts, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      count_now = static_cast<std::int32_t>(static_cast<std::uint32_t>(count_now) +
                                            static_cast<std::uint32_t>(counts));
      REQUIRE(wheel.follow(jog, count_now, time));
      if (const auto setpoint = jog.next()) motion.setpoints.push_back(*setpoint);
      time += kTick;
    }
  }
  [[nodiscard]] double x() const { return jog.position()[Axis::X]; }

  JogPlanner jog;
  HandWheel wheel;
  std::int32_t count_now;
  double time = 0.0;
  Trajectory motion{{}, {}};
};

}  // namespace

TEST_CASE("Position mode: the axis ends where the wheel says, to the last count", "[MAN-3]") {
  Bench bench(HandWheelMode::position);
  bench.turn(7, 40);
  bench.turn(-2, 15);
  bench.turn(0, 1000);
  CHECK(bench.x() == kPerCount * (7 * 40 - 2 * 15));
  CHECK(bench.jog.standing());
}

TEST_CASE("Position mode: what was turned beyond the travel has to be turned back", "[MAN-3]") {
  Bench bench(HandWheelMode::position);
  bench.jog.set_travel(Axis::X, {-1.0, 5.0});
  bench.turn(10, 80);  // 8 mm
  bench.turn(0, 500);
  CHECK(bench.x() == 5.0);
  bench.turn(-10, 25);  // back to 5.5
  bench.turn(0, 500);
  CHECK(bench.x() == 5.0);
  bench.turn(-10, 10);  // to 4.5
  bench.turn(0, 500);
  CHECK(bench.x() == 4.5);
}

TEST_CASE("Position mode: planned far ahead and cut off at every turn, no count is lost",
          "[MAN-3][LNK-8]") {
  JogPlanner jog(reference_limits(), kTick, {});
  HandWheel wheel(Axis::X, {HandWheelMode::position, kPerCount, 80.0}, 0, 0.0);
  std::int32_t count = 0;
  for (int i = 0; i < 60; ++i) {
    count += i % 10 < 7 ? 9 : -4;
    REQUIRE(wheel.follow(jog, count, kTick * i));
    // Two ticks are driven; those behind them, to the end mostly, are void.
    static_cast<void>(jog.next());
    static_cast<void>(jog.next());
    const Position position = jog.position();
    const Position velocity = jog.velocity();
    for (int ahead = 0; ahead < 60 && jog.next(); ++ahead) {
    }
    jog.go_back(position, velocity, {});
  }
  while (jog.next()) {
  }
  CHECK(jog.position()[Axis::X] == kPerCount * count);
}

TEST_CASE("Position mode: the counter may wrap", "[MAN-3]") {
  Bench bench(HandWheelMode::position, std::numeric_limits<std::int32_t>::max() - 3);
  bench.turn(2, 10);
  bench.turn(0, 500);
  CHECK(bench.x() == kPerCount * 20);
}

TEST_CASE("Velocity mode: as fast as the wheel turns, and standing when it stands", "[MAN-3]") {
  Bench bench(HandWheelMode::velocity);
  bench.turn(10, 100);  // 10 * 0.01 mm in 5 ms
  CHECK(bench.jog.velocity()[Axis::X] == Approx(20.0));
  // Two windows of 40 ms, then v/a = 20/500 s.
  bench.turn(0, 8 + 8 + 8 + 1);
  CHECK(bench.jog.standing());
  const double there = bench.x();
  bench.turn(0, 100);
  CHECK(bench.x() == there);
}

TEST_CASE("Velocity mode: a wheel that is too quick is followed at the speed allowed", "[MAN-3]") {
  Bench bench(HandWheelMode::velocity, 0, 30.0);
  bench.turn(100, 200);
  CHECK(bench.jog.velocity()[Axis::X] == Approx(30.0));
  bench.turn(-100, 200);
  CHECK(bench.jog.velocity()[Axis::X] == Approx(-30.0));
}

TEST_CASE("A wheel without speed or way is refused", "[MAN-3]") {
  JogPlanner jog(reference_limits(), kTick, {});
  HandWheel still(Axis::X, {HandWheelMode::position, kPerCount, 0.0}, 0, 0.0);
  CHECK_FALSE(still.follow(jog, 1, 0.0));
  HandWheel broken(Axis::X, {HandWheelMode::position, std::nan(""), 10.0}, 0, 0.0);
  CHECK_FALSE(broken.follow(jog, 1, 0.0));
  CHECK_FALSE(jog.next());
}

TEST_CASE("However the wheel is turned, limits and travel are kept", "[MAN-3]") {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    Bench bench(dice.chance(0.5) ? HandWheelMode::position : HandWheelMode::velocity, dice.pick(9));
    bench.jog.set_travel(Axis::X, {-2.0, 3.0});
    for (int i = 0; i < 60; ++i) bench.turn(dice.pick(81) - 40, 1 + dice.pick(20));
    bench.turn(0, 400);
    CHECK(bench.jog.standing());
    const Usage usage = usage_of(bench.motion, reference_limits());
    REQUIRE(usage.velocity <= 1.0 + 1e-9);
    REQUIRE(usage.acceleration <= 1.0 + 1e-9);
    for (const Setpoint& setpoint : bench.motion.setpoints) {
      REQUIRE(setpoint.position[Axis::X] >= -2.0);
      REQUIRE(setpoint.position[Axis::X] <= 3.0);
    }
  }
}

}  // namespace cnc::motion::test
