// Orders of manual motion act at once, however much of it the board holds (LNK-8): a step, a stop,
// a home switch that is met (MAN-1, MAN-2, HOM-2).
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/core.h>

#include "tests/server/recorded_motion.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr double kLongestLatency = 0.010;  // s
constexpr double kPeriod = 0.002;          // of the link in cncserver, s
constexpr double kExact = 1e-9;

SimulationOptions fast(const Position& start) {
  SimulationOptions options{.machine = {.start = start}};
  options.period = kPeriod;
  return options;
}

struct FastRig : ReadyRig {
  FastRig() : ReadyRig(free_machine(), fast({})) {}

  /// The link thread has not been woken for so long.
  void delay_link(double seconds) { simulation.link().cycle(simulation.time() + seconds); }
  void check_limits(const RecordedMotion& motion) {
    CHECK(motion.usage(machine.config()) <= 1.0 + 1e-6);
    for (const Axis axis : kLinearAxes) CHECK(simulation.virtual_machine().lost_steps(axis) == 0);
  }
};

/// From the last status that the machine had seen when it was asked, to where the new path begins.
double latency(const RecordedMotion& motion, double request) {
  return motion.end_of_kept() - (request - kPeriod);
}

Position only_x(double value) { return Position{{value}}; }

}  // namespace

TEST_CASE("A step that is given while moving acts within 10 ms, and adds up exactly",
          "[LNK-8][MAN-2]") {
  // 0.4 s at 100 mm/s on 500 mm/s²: given while it accelerates, moves and brakes.
  for (int ticks = 10; ticks < 280; ticks += 9) {
    const double step = ticks % 2 == 0 ? 15.0 : -25.0;
    CAPTURE(ticks, step);
    FastRig rig;
    RecordedMotion motion(rig);
    REQUIRE(rig.machine.jog_step(Axis::X, 40.0, 1.0));
    for (int i = 0; i < ticks; ++i) rig.simulation.cycle();
    const double request = rig.simulation.time();
    REQUIRE(rig.machine.jog_step(Axis::X, step, 1.0));
    CHECK(motion.cuts() == 1);
    CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
    REQUIRE(rig.becomes(State::ready));
    CHECK(motion.end()[Axis::X] == Approx(40.0 + step).margin(kExact));
    rig.check_limits(motion);
  }
}

TEST_CASE("Steps add up exactly however late the link is", "[LNK-8][MAN-2]") {
  for (int late = 0; late < 40; ++late) {
    CAPTURE(late);
    FastRig rig;
    RecordedMotion motion(rig);
    double target = 0.0;
    for (int i = 0; i < 12; ++i) {
      const double step = i % 4 == 3 ? -2.5 : 1.75;
      target += step;
      REQUIRE(rig.machine.jog_step(Axis::X, step, 0.7));
      // Each at another distance from the one before: its cut is answered, or is not.
      const int wait = (3 * i + late) % 14;
      if ((i + late) % 3 == 0) rig.delay_link(0.01 + 0.001 * late);
      for (int cycle = 0; cycle < wait; ++cycle) rig.simulation.cycle();
    }
    REQUIRE(rig.becomes(State::ready));
    CHECK(motion.end()[Axis::X] == Approx(target).margin(kExact));
    rig.check_limits(motion);
  }
}

TEST_CASE("A step whose carrying out was void is carried out again", "[LNK-8][MAN-2]") {
  // The 0.2 mm are planned to their end at once, and cut off before the board has begun with them.
  FastRig rig;
  RecordedMotion motion(rig);
  REQUIRE(rig.machine.jog_step(Axis::X, 0.2, 1.0));
  for (int i = 0; i < 4; ++i) rig.simulation.cycle();
  REQUIRE(motion.end()[Axis::X] == Approx(0.2).margin(kExact));
  REQUIRE(rig.machine.jog_step(Axis::Y, 30.0, 1.0));
  REQUIRE(motion.cuts() == 1);
  REQUIRE(rig.becomes(State::ready));
  CHECK(motion.end()[Axis::X] == Approx(0.2).margin(kExact));
  CHECK(motion.end()[Axis::Y] == Approx(30.0).margin(kExact));
}

TEST_CASE("A step of an axis that jogs counts from where it is just then", "[MAN-1][MAN-2]") {
  for (int ticks = 150; ticks < 156; ++ticks) {
    FastRig rig;
    REQUIRE(rig.machine.jog(only_x(1.0), 10.0));
    for (int i = 0; i < ticks; ++i) rig.simulation.cycle();
    // A new rate just before: its cut is not answered yet.
    if (ticks % 2 == 0) REQUIRE(rig.machine.jog(only_x(0.9), 10.0));
    const double here = rig.position()[Axis::X];
    REQUIRE(rig.machine.jog_step(Axis::X, 50.0, 1.0));
    rig.run_for(3.0);
    CHECK(rig.position()[Axis::X] == Approx(here + 50.0).margin(0.01));
    rig.machine.jog_stop();
    REQUIRE(rig.becomes(State::ready));
  }
}

TEST_CASE("A released key leaves no more than 10 ms and the ramp to be driven", "[LNK-8][MAN-1]") {
  for (const double rate : {0.05, 0.3, 1.0}) {
    CAPTURE(rate);
    FastRig rig;
    const auto& bench = rig.simulation.virtual_machine();
    const double speed = rate * rig.machine.config().axes[Axis::X].velocity;
    const double a = rig.machine.config().axes[Axis::X].acceleration;
    REQUIRE(rig.machine.jog(only_x(rate), 10.0));
    rig.run_for(0.5);
    const double here = bench.physical_position(Axis::X);
    rig.machine.jog_stop();
    REQUIRE(rig.becomes(State::ready));
    const double way = bench.physical_position(Axis::X) - here;
    CHECK(way <= speed * kLongestLatency + speed * speed / (2.0 * a) + 0.01);
  }
}

TEST_CASE("An axis runs on behind its switch by its ramp and what 17 ms take", "[LNK-8][HOM-2]") {
  // The switch shows in the status of the next exchange, 2 ms, from there on it takes 10 ms; a ramp
  // in ticks of 5 ms is at most one tick longer.
  for (const double speed : {5.0, 25.0, 50.0, 100.0}) {
    CAPTURE(speed);
    Rig rig(shipped_machine({fmt::format("AXIS_X.homeVelocity={}", -speed)}), [] {
      SimulationOptions options = fast(Position{{40.0, 100.0, 0.0}});
      options.machine.stop_margin = 50.0;
      return options;
    }());
    REQUIRE(rig.reset());
    const auto& bench = rig.simulation.virtual_machine();
    const double a = rig.machine.config().axes[Axis::X].acceleration;
    rig.machine.home({Axis::X}, [](const Result<void>&) {});
    REQUIRE(rig.becomes([&] { return bench.home_switch(Axis::X); }));
    const double met = bench.physical_position(Axis::X);
    double furthest = met;
    while (bench.home_switch(Axis::X)) {
      rig.simulation.cycle();
      furthest = std::min(furthest, bench.physical_position(Axis::X));
    }
    // Seen up to one cycle late, by which it is nearer to where it stops.
    CHECK(met - furthest <= speed * 0.017 + speed * speed / (2.0 * a) + 0.01);
    CHECK(met - furthest >= speed * speed / (2.0 * a));
    REQUIRE(rig.becomes(State::needs_homing));
    CHECK(rig.homed(Axis::X));
    CHECK(std::abs(rig.position()[Axis::X] - bench.physical_position(Axis::X)) <= kExact);
  }
}

TEST_CASE("A stop of homing acts within 10 ms, late cut or not", "[LNK-8][HOM-2][safety]") {
  for (const bool late : {false, true}) {
    CAPTURE(late);
    FastRig rig;
    RecordedMotion motion(rig);
    Result<void> homing;
    rig.machine.home({Axis::Z}, [&](Result<void> result) { homing = std::move(result); });
    rig.run_for(0.15);
    const double request = rig.simulation.time();
    rig.machine.stop([](const Result<void>&) {});
    REQUIRE(motion.cuts() == 1);
    CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
    if (late) rig.delay_link(0.03);
    REQUIRE(rig.becomes(State::ready, 1.0));
    REQUIRE_FALSE(homing);
    CHECK(homing.error().code == ErrorCode::command_interrupted);
    CHECK((motion.cuts() > 1) == late);
    CHECK(motion.setpoints().back().velocity == Position{});
    rig.check_limits(motion);
  }
}
