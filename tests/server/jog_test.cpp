// Manual motion: the lease, the limits, the steps (MAN-1, MAN-2, STA-5, STA-6).
#include <catch2/catch.hpp>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr double kExact = 1e-9;
// The shipped X axis.
constexpr double kVelocity = 100.0;
constexpr double kAcceleration = 500.0;

Position only(Axis axis, double value) {
  Position position;
  position[axis] = value;
  return position;
}

double fastest_over(Rig& rig, Axis axis, double seconds) {
  double fastest = 0.0;
  for (const double end = rig.simulation.time() + seconds; rig.simulation.time() < end;) {
    rig.simulation.cycle();
    fastest = std::max(fastest, std::abs(rig.shown()->velocity[axis]));
  }
  return fastest;
}

}  // namespace

TEST_CASE("A jog whose lease runs out stops by itself", "[MAN-1][safety]") {
  ReadyRig rig;
  const double lease = GENERATE(0.05, 0.25, 1.0);
  REQUIRE(rig.machine.jog(only(Axis::X, 1.0), lease));
  const double begin = rig.simulation.time();
  REQUIRE(rig.becomes(State::ready, 10.0));
  // The lease, what cannot be replaced any more (two exchanges of 5 ms, 1 ms, a segment of 5 ms),
  // the ramp 100 / 500 s, and a few cycles of 5 ms.
  CHECK(rig.simulation.time() - begin <= lease + 0.016 + kVelocity / kAcceleration + 0.03);
  CHECK(rig.position()[Axis::X] > 0.0);
  const Position stands = rig.position();
  rig.run_for(1.0);
  CHECK(rig.position() == stands);
}

TEST_CASE("A renewed lease keeps the machine moving at the wanted rate", "[MAN-1]") {
  ReadyRig rig;
  for (int i = 0; i < 20; ++i) {
    REQUIRE(rig.machine.jog(only(Axis::X, 0.5), 0.25));
    rig.run_for(0.1);
    CHECK(rig.state() == State::jogging);
  }
  CHECK(rig.shown()->velocity[Axis::X] == Approx(0.5 * kVelocity));
}

TEST_CASE("A released key stops at once along the ramp", "[MAN-1]") {
  ReadyRig rig;
  REQUIRE(rig.machine.jog(only(Axis::X, 1.0), 1.0));
  rig.run_for(0.5);
  const double begin = rig.simulation.time();
  rig.machine.jog_stop();
  REQUIRE(rig.becomes(State::ready, 1.0));
  CHECK(rig.simulation.time() - begin <= 0.016 + kVelocity / kAcceleration + 0.03);
}

TEST_CASE("Jog ends exactly on the soft limit of a homed axis", "[STA-6][safety]") {
  HomedRig rig({"AXIS_X.positiveLimit=20"});
  const double side = GENERATE(1.0, -1.0);
  REQUIRE(rig.mdi("G0 X10"));
  for (int i = 0; i < 30; ++i) {
    REQUIRE(rig.machine.jog(only(Axis::X, side), 0.25));
    rig.run_for(0.1);
    CHECK(rig.position()[Axis::X] <= 20.0 + kExact);
    CHECK(rig.position()[Axis::X] >= -kExact);
  }
  CHECK(rig.position()[Axis::X] == Approx(side > 0.0 ? 20.0 : 0.0).margin(kExact));
  CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
}

TEST_CASE("A step beyond the soft limit ends on it", "[STA-6][MAN-2]") {
  HomedRig rig({"AXIS_X.positiveLimit=20"});
  REQUIRE(rig.machine.jog_step(Axis::X, 50.0, 1.0));
  REQUIRE(rig.becomes(State::ready));
  CHECK(rig.position()[Axis::X] == Approx(20.0).margin(kExact));
}

TEST_CASE("Before homing a machine jogs at 5 % and no faster", "[STA-5]") {
  Rig rig(shipped_machine(), {});
  REQUIRE(rig.reset());
  REQUIRE(rig.state() == State::needs_homing);
  REQUIRE(rig.machine.jog(only(Axis::X, 1.0), 1.0));
  CHECK(fastest_over(rig, Axis::X, 0.9) == Approx(0.05 * kVelocity));
  REQUIRE(rig.becomes(State::needs_homing));
  REQUIRE(rig.machine.jog_step(Axis::X, 2.0, 1.0));
  CHECK(fastest_over(rig, Axis::X, 0.3) == Approx(0.05 * kVelocity));
}

TEST_CASE("After homing a machine jogs at its full velocity", "[STA-5]") {
  HomedRig rig;
  REQUIRE(rig.machine.jog(only(Axis::X, 1.0), 1.0));
  CHECK(fastest_over(rig, Axis::X, 1.0) == Approx(kVelocity));
}

TEST_CASE("Steps that are given while moving add up", "[MAN-2]") {
  ReadyRig rig;
  for (int i = 0; i < 10; ++i) {
    REQUIRE(rig.machine.jog_step(Axis::Y, 0.1, 0.5));
    rig.run_for(0.01);
  }
  REQUIRE(rig.becomes(State::ready));
  CHECK(rig.position()[Axis::Y] == Approx(1.0).margin(kExact));
}

TEST_CASE("Two axes jog at once, each at its own rate", "[MAN-1]") {
  ReadyRig rig;
  Position rates = only(Axis::X, 0.5);
  rates[Axis::Y] = -0.25;
  REQUIRE(rig.machine.jog(rates, 0.5));
  rig.run_for(0.45);
  CHECK(rig.shown()->velocity[Axis::X] == Approx(50.0));
  CHECK(rig.shown()->velocity[Axis::Y] == Approx(-25.0));
}

TEST_CASE("An axis that is not connected does not jog", "[MAN-1]") {
  ReadyRig rig;
  for (const auto& answer :
       {rig.machine.jog(only(Axis::A, 0.5), 0.25), rig.machine.jog_step(Axis::A, 1.0, 0.5)}) {
    REQUIRE_FALSE(answer);
    CHECK(answer.error().code == ErrorCode::axis_not_connected);
  }
  CHECK(rig.state() == State::ready);
}

TEST_CASE("A program goes on from where the machine was jogged to", "[MAN-1]") {
  ReadyRig rig;
  REQUIRE(rig.machine.jog_step(Axis::X, 7.0, 0.5));
  REQUIRE(rig.becomes(State::ready));
  REQUIRE(rig.mdi("G91 G0 X3"));
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kExact));
}
