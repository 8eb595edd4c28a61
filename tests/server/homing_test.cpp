// Homing by switch and by hand (HOM-1, HOM-2; manual 2.10). The virtual machine's switch releases
// exactly at the axis' home position, so a perfectly homed machine counts what its physical
// position is.
#include <catch2/catch.hpp>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

namespace {

constexpr double kRounding = 1e-9;

std::vector<std::string> homed_axes_in_order(const Rig& rig) {
  std::vector<std::string> axes;
  for (const LogMessage& message : rig.simulation.log().after(0))
    if (message.text.ends_with(" is homed.")) axes.push_back(message.text.substr(5, 1));
  return axes;
}

/// Reset, nothing homed, in the middle of the travel.
struct UnhomedRig : Rig {
  explicit UnhomedRig(const hal::sim::MachineOptions& options = {})
      : Rig(shipped_machine(), {.machine = options}) {
    REQUIRE(reset());
    REQUIRE(state() == State::needs_homing);
  }

  [[nodiscard]] double error_of(Axis axis) const {
    return position()[axis] -
           const_cast<Simulation&>(simulation).virtual_machine().physical_position(axis);
  }
};

}  // namespace

TEST_CASE("Homing takes Z out of the way first, then X and Y", "[HOM-2]") {
  UnhomedRig rig;
  REQUIRE(rig.home());
  CHECK(homed_axes_in_order(rig) == std::vector<std::string>{"Z", "X", "Y"});
  CHECK(rig.state() == State::ready);
}

TEST_CASE("A homed axis counts its physical position to the step", "[HOM-2][LNK-6]") {
  UnhomedRig rig;
  REQUIRE(std::abs(rig.error_of(Axis::X)) > 100.0);  // power-up counts from 0 in the middle of 600
  REQUIRE(rig.home());
  for (const Axis axis : kLinearAxes) {
    INFO(axis_name(axis));
    CHECK(rig.homed(axis));
    CHECK(std::abs(rig.error_of(axis)) <= kRounding);
  }
}

TEST_CASE("An axis that stands on its switch is homed as exactly", "[HOM-2]") {
  UnhomedRig rig({.start = Position{{-2.0, 100.0, 0.0}}});
  REQUIRE(rig.simulation.virtual_machine().home_switch(Axis::X));
  REQUIRE(rig.home({Axis::X}));
  CHECK(std::abs(rig.error_of(Axis::X)) <= kRounding);
}

TEST_CASE("Homing again is as exact, however late the link answers", "[HOM-2][safety]") {
  UnhomedRig rig;
  REQUIRE(rig.home({Axis::X}));
  bool answered = false;
  rig.machine.home({Axis::X}, [&](const Result<void>& result) {
    CHECK(result);
    answered = true;
  });
  // The machine looks twice at every status of the board: what it saw the first time is old news.
  for (int cycle = 0; cycle < 20'000 && !answered; ++cycle) {
    rig.simulation.cycle();
    rig.machine.cycle(rig.simulation.time());
  }
  REQUIRE(answered);
  rig.simulation.cycle();
  CHECK(std::abs(rig.error_of(Axis::X)) <= kRounding);
}

TEST_CASE("An axis without home velocity is homed by hand, where it stands", "[HOM-1]") {
  Rig rig(shipped_machine({"AXIS_Z.homeVelocity=0"}), {.machine = {.start = Position{}}});
  REQUIRE(rig.reset());
  const double before = rig.simulation.virtual_machine().physical_position(Axis::Z);
  REQUIRE(rig.home({Axis::Z}));
  CHECK(rig.simulation.virtual_machine().physical_position(Axis::Z) == before);
  CHECK(rig.position()[Axis::Z] == Approx(10.0).margin(kRounding));  // homePosition of Z
  CHECK(rig.homed(Axis::Z));
  CHECK(rig.state() == State::needs_homing);  // X and Y are not
}

TEST_CASE("A switch that is never met ends homing at the end of the search", "[HOM-2][safety]") {
  // The switch needs 10 mm beyond home position to trip; the machine's stop is 5 mm beyond it.
  UnhomedRig rig({.stop_margin = 5.0, .switch_hysteresis = 10.0});
  const auto answer = rig.home({Axis::X});
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::home_switch_not_found);
  CHECK_THAT(answer.error().message, Contains("Axis X"));
  CHECK_FALSE(rig.homed(Axis::X));
  CHECK(rig.state() == State::needs_homing);
  CHECK_FALSE(rig.shown()->velocity[Axis::X] != 0.0);
}

TEST_CASE("A switch that does not release ends homing with an error", "[HOM-2][safety]") {
  // The way back is half of the travel, 300 mm; the axis stands 390 mm behind the switch.
  UnhomedRig rig({.start = Position{{-390.0, 100.0, 0.0}}, .stop_margin = 400.0});
  const auto answer = rig.home({Axis::X});
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::home_switch_stuck);
  CHECK_FALSE(rig.homed(Axis::X));
}

TEST_CASE("Stop ends homing: what is homed stays homed, the axis under way is not", "[HOM-2]") {
  UnhomedRig rig;
  Result<void> homing;
  rig.machine.home({}, [&](Result<void> result) { homing = std::move(result); });
  REQUIRE(rig.becomes([&] { return rig.homed(Axis::Z); }));
  rig.run_for(1.0);
  REQUIRE(rig.shown()->velocity[Axis::X] < 0.0);
  REQUIRE(rig.stop());
  REQUIRE_FALSE(homing);
  CHECK(homing.error().code == ErrorCode::command_interrupted);
  CHECK(rig.homed(Axis::Z));
  CHECK_FALSE(rig.homed(Axis::X));
  CHECK(rig.state() == State::needs_homing);
  const Position stands = rig.position();
  rig.run_for(1.0);
  CHECK(rig.position() == stands);
}

TEST_CASE("An axis that is homed again counts as not homed until it is", "[HOM-2]") {
  UnhomedRig rig;
  REQUIRE(rig.home());
  rig.machine.home({Axis::Y}, [](const Result<void>&) {});
  rig.simulation.cycle();
  CHECK_FALSE(rig.homed(Axis::Y));
  REQUIRE(rig.becomes(State::ready));
  CHECK(rig.homed(Axis::Y));
}

TEST_CASE("An axis that is not connected cannot be homed", "[HOM-2]") {
  UnhomedRig rig;
  const auto answer = rig.home({Axis::X, Axis::A});
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::axis_not_connected);
  CHECK_THAT(answer.error().message, Contains("Axis A"));
  CHECK(rig.state() == State::needs_homing);
  CHECK(homed_axes_in_order(rig).empty());
}
