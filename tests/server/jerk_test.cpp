// The whole machine with limits of jerk: jog, homing, jobs with pauses.
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <random>

#include "tests/server/recorded_motion.h"
#include "tests/server/rig.h"

namespace cnc::server::test {

namespace {

constexpr double kJerk = 20'000.0;

const std::vector<std::string> kJerkLimits{"AXIS_X.jerk=20000", "AXIS_Y.jerk=20000",
                                           "AXIS_Z.jerk=20000"};

/// The largest jerk of any setpoint, from rest at the begin.
double largest_jerk(const RecordedMotion& motion, const Position& begin) {
  double largest = 0.0;
  Position position = begin;
  Position velocity;
  for (const motion::Setpoint& setpoint : motion.setpoints()) {
    for (const Axis axis : kLinearAxes) {
      const auto cubic = motion::cubic_of(axis, position, velocity, setpoint);
      largest = std::max(largest, std::abs(cubic.jerk()));
    }
    position = setpoint.position;
    velocity = setpoint.velocity;
  }
  return largest;
}

std::string wave() {
  std::string program = "G21 G90 G64 P0.02 F3000\n";
  for (int i = 1; i <= 200; ++i) {
    program += "G1 X" + std::to_string(0.5 * i) + " Y" +
               std::to_string(5.0 + 2.0 * std::sin(0.3 * i)) + "\n";
  }
  return program + "G0 X5 Y5\nM30\n";
}

/// Detail of 0.2 mm, which the jerk lets be driven at 5 to 10 mm/s, at a feed of 100 mm/s for which
/// the planner looks ahead over a second of it.
std::string relief() {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> height(-0.15, 0.15);
  std::string program = "G21 G90 G64 P0.005 F6000\n";
  for (int i = 1; i <= 250; ++i)
    program += fmt::format("G1 X{:.4f} Y{:.4f}\n", 0.2 * i, 5.0 + height(engine));
  return program + "M30\n";
}

}  // namespace

TEST_CASE("With limits of jerk a jog starts, changes its speed and stops within them",
          "[MOT-3][MAN-1]") {
  ReadyRig rig(free_machine(kJerkLimits));
  const Position begin = rig.position();
  RecordedMotion motion(rig);
  AxisArray<double> rates{};
  rates[Axis::X] = 1.0;
  REQUIRE(rig.machine.jog(rates, 1.0));
  rig.run_for(0.4);
  rates[Axis::X] = -0.3;
  REQUIRE(rig.machine.jog(rates, 0.5));
  REQUIRE(rig.becomes(State::ready, 10.0));
  CHECK(motion.setpoints().size() > 50);
  // What was taken back is not in the recording: the jerk is that of what the board executed.
  CHECK(largest_jerk(motion, begin) <= kJerk * (1.0 + 1e-3));
}

TEST_CASE("With limits of jerk a job pauses, goes on and ends where it should", "[MOT-3][JOB-8]") {
  ReadyRig rig(free_machine(kJerkLimits));
  const Position begin = rig.position();
  RecordedMotion motion(rig);
  rig.start(wave());
  for (int i = 0; i < 3; ++i) {
    rig.run_for(0.25);
    REQUIRE(rig.pause());
    REQUIRE(rig.becomes(State::paused));
    REQUIRE(rig.machine.resume());
  }
  REQUIRE(rig.becomes(State::ready));
  CHECK(rig.position()[Axis::X] == 5.0);
  CHECK(rig.position()[Axis::Y] == 5.0);
  CHECK(motion.cuts() >= 3);
  CHECK(largest_jerk(motion, begin) <= kJerk * (1.0 + 1e-3));
}

TEST_CASE("With limits of jerk a pause and an override amid fine detail leave the board in motion",
          "[MOT-3][LNK-8][JOB-8][MAN-8][safety]") {
  SimulationOptions options = at_zero();
  options.period = 0.002;  // the link's cycle in cncserver
  ReadyRig undisturbed(free_machine(kJerkLimits), options);
  RecordedMotion reference(undisturbed);
  undisturbed.start(relief());
  REQUIRE(undisturbed.becomes(State::ready));
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> spread(0.3, 0.8);
  for (int repeat = 0; repeat < 6; ++repeat) {
    CAPTURE(repeat);
    ReadyRig rig(free_machine(kJerkLimits), options);
    RecordedMotion motion(rig);
    rig.start(relief());
    for (int i = 0; i < 4; ++i) {
      CAPTURE(i);
      rig.run_for(spread(engine));
      rig.machine.pause([](const Result<void>&) {});
      // The braking went out with the cut.
      CHECK(motion.setpoints().back().velocity == Position{});
      REQUIRE(rig.becomes(State::paused, 0.5));
      REQUIRE(rig.machine.resume());
      for (const double factor : {0.2, 1.5, 0.0, 1.0}) {
        rig.run_for(0.3 * spread(engine));
        REQUIRE(rig.machine.set_overrides({factor, 1.0, 1.0}));
        REQUIRE(rig.state() == State::running);
      }
    }
    REQUIRE(rig.becomes(State::ready));
    CHECK(rig.shown()->job.ended_well);
    CHECK(motion.cuts() >= 16);
    // A motion keeps within 10 nm of its plan, and halves of curved chords of 0.2 mm are straight.
    CHECK(motion.distance_from(reference) < 1e-4);
    CHECK(motion.usage(rig.machine.config()) <= 1.0 + 1e-6);
  }
}

TEST_CASE("With limits of jerk the machine homes", "[MOT-3][HOM-1]") {
  Rig rig(shipped_machine(kJerkLimits), {});
  REQUIRE(rig.reset());
  REQUIRE(rig.home());
  CHECK(rig.homed(Axis::X));
}

}  // namespace cnc::server::test
