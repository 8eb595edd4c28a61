// Emergency stop and reset (STA-2, STA-4).
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using interp::SpindleDirection;

namespace {

void press(Rig& rig) {
  rig.simulation.virtual_machine().press_estop(true);
  REQUIRE(rig.becomes(State::estop, 0.1));
}

void release(Rig& rig) { rig.simulation.virtual_machine().press_estop(false); }

/// Moves X at 20 mm/s with the spindle on; Y stands.
void start_cut(Rig& rig) {
  rig.start("M3 S12000\nM8\nG1 X500 F1200\n");
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 5.0; }));
}

Position full_rate(Axis axis) {
  Position rates;
  rates[axis] = 1.0;
  return rates;
}

}  // namespace

TEST_CASE("Emergency stop stops, switches everything off and ends the job", "[STA-4][safety]") {
  HomedRig rig;
  start_cut(rig);
  REQUIRE(rig.simulation.virtual_machine().outputs().spindle_on);
  press(rig);
  const auto& outputs = rig.simulation.virtual_machine().outputs();
  CHECK_FALSE(outputs.drives_enabled);
  CHECK_FALSE(outputs.spindle_on);
  CHECK_FALSE(outputs.flood);
  CHECK(rig.shown()->spindle == SpindleDirection::off);
  CHECK(rig.shown()->estop_input);
  CHECK_FALSE(rig.shown()->job.ended_well);
  CHECK(rig.last_error().code == ErrorCode::estop_pressed);
  // No pulse comes any more; a motor without current needs a moment to run out.
  const Position counted = rig.position();
  rig.run_for(0.5);
  const Position stands = rig.simulation.virtual_machine().physical_position();
  rig.run_for(2.0);
  CHECK(rig.position() == counted);
  CHECK(rig.simulation.virtual_machine().physical_position() == stands);
}

TEST_CASE("Where the axes were when the estop came and at the spindle's last pulse is shown",
          "[LNK-6][STA-4]") {
  HomedRig rig;
  start_cut(rig);
  rig.run_for(1.0);
  CHECK(rig.shown()->latches.estop.count == 0);
  const double from = rig.position()[Axis::X];
  press(rig);
  const LatchSnapshot latches = rig.shown()->latches;
  CHECK(latches.estop.count == 1);
  CHECK(latches.estop.position == rig.position());
  CHECK(latches.board_time - latches.estop.time < 0.1);
  // 200 turns a second: the last of them was at most 5 ms before, 0.1 mm at 20 mm/s.
  CHECK(latches.spindle_index.count > 100);
  CHECK(latches.estop.time - latches.spindle_index.time < 0.0051);
  CHECK(latches.spindle_index.position[Axis::X] >= from - 0.1);
  CHECK(latches.estop.position[Axis::X] - latches.spindle_index.position[Axis::X] < 0.11);
}

TEST_CASE("Axes that the emergency stop caught in motion have to be homed again",
          "[STA-4][safety]") {
  HomedRig rig;
  start_cut(rig);
  press(rig);
  CHECK_FALSE(rig.homed(Axis::X));
  CHECK(rig.homed(Axis::Y));
  CHECK(rig.homed(Axis::Z));
}

TEST_CASE("An emergency stop at rest costs no axis its home", "[STA-4]") {
  HomedRig rig;
  start_cut(rig);
  press(rig);
  release(rig);
  REQUIRE(rig.reset());
  REQUIRE(rig.home({Axis::X}));  // by hand
  // The board still shows the segment in which it was stopped; nothing moves now.
  rig.run_for(0.1);
  press(rig);
  for (const Axis axis : kLinearAxes) CHECK(rig.homed(axis));
}

TEST_CASE(
    "Drives that were off have held nothing: each axis is doubtful, unless they have encoders",
    "[STA-4][LNK-4][safety]") {
  struct Row {
    std::string_view how;
    void (*switch_off)(Rig&);
  };
  const std::vector<Row> rows{
      {"emergency stop", [](Rig& rig) { press(rig); }},
      {"drive alarm of another axis",
       [](Rig& rig) {
         rig.simulation.virtual_machine().raise_drive_alarm(Axis::A, true);
         REQUIRE(rig.becomes(State::error, 0.1));
       }},
      {"M81", [](Rig& rig) { REQUIRE(rig.mdi("M81")); }},
      {"M81 in a job, and M80 again",
       [](Rig& rig) {
         rig.start("M81\nG4 P0.1\nM80\n");
         REQUIRE(rig.becomes([&] { return rig.state() != State::running; }));
       }},
      {"M81 in a job, and X homed by hand before M80",
       [](Rig& rig) {
         rig.start("M81\nhome x\nM80\n");
         REQUIRE(rig.becomes([&] { return rig.state() != State::running; }));
       }},
      {"lost link",
       [](Rig& rig) {
         rig.simulation.virtual_controller().trouble().cable_out = true;
         REQUIRE(rig.becomes(State::off, 1.0));
       }},
  };
  for (const Row& row : rows) {
    for (const bool encoders : {false, true}) {
      CAPTURE(row.how, encoders);
      HomedRig rig({fmt::format("SAFETY.drivesHoldPosition={}", encoders ? 1 : 0)});
      const Position place = rig.position();
      row.switch_off(rig);
      rig.run_for(0.1);
      for (const Axis axis : kLinearAxes)
        CHECK(rig.shown()->trust[axis] == (encoders ? Trust::trusted : Trust::doubtful));
      CHECK(rig.position() == place);
    }
  }
}

TEST_CASE("A reset that switches no drive off costs no trust", "[STA-2][LNK-4]") {
  HomedRig rig({"SAFETY.drivesHoldPosition=0"});
  start_cut(rig);
  REQUIRE(rig.reset());
  REQUIRE(rig.reset());
  for (const Axis axis : kLinearAxes) CHECK(rig.homed(axis));
}

TEST_CASE("After an emergency stop the operator homes, or vouches for where the axes stand",
          "[STA-4][LNK-4][safety]") {
  Rig rig(shipped_machine({"SAFETY.drivesHoldPosition=0", "AXIS_X.homeVelocity=0",
                           "AXIS_Y.homeVelocity=0", "AXIS_Z.homeVelocity=0"}));
  REQUIRE(rig.reset());
  REQUIRE(rig.home());
  REQUIRE(rig.state() == State::ready);
  press(rig);
  release(rig);
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::needs_homing);
  REQUIRE(rig.machine.accept_position({}));
  CHECK(rig.becomes(State::ready, 0.1));
}

TEST_CASE("An axis in doubt is jogged slowly, and within its limits",
          "[STA-4][STA-5][STA-6][safety]") {
  Rig rig(shipped_machine({"SAFETY.drivesHoldPosition=0", "AXIS_X.homeVelocity=0",
                           "AXIS_Y.homeVelocity=0", "AXIS_Z.homeVelocity=0",
                           "AXIS_X.positiveLimit=20"}));
  REQUIRE(rig.reset());
  REQUIRE(rig.home());
  REQUIRE(rig.mdi("G53 G0 X18"));
  press(rig);
  release(rig);
  REQUIRE(rig.reset());
  REQUIRE(rig.state() == State::needs_homing);
  for (int i = 0; i < 10; ++i) {
    REQUIRE(rig.machine.jog(full_rate(Axis::X), 0.25));
    rig.run_for(0.1);
    CHECK(rig.shown()->velocity[Axis::X] <= 0.05 * 100.0 + 1e-6);
    CHECK(rig.position()[Axis::X] <= 20.0 + 1e-6);
  }
  CHECK(rig.position()[Axis::X] == Approx(20.0).margin(1e-3));
}

TEST_CASE("A jogged axis loses its home as well", "[STA-4][safety]") {
  HomedRig rig;
  REQUIRE(rig.machine.jog_step(Axis::Y, 100.0, 0.2));
  rig.run_for(1.0);
  press(rig);
  CHECK_FALSE(rig.homed(Axis::Y));
  CHECK(rig.homed(Axis::X));
  release(rig);
  REQUIRE(rig.reset());
  const Position stands = rig.position();
  rig.run_for(1.0);
  CHECK(rig.position() == stands);  // the rest of the step is forgotten
}

TEST_CASE("Reset is refused while the button is pressed and works when it is released",
          "[STA-2][STA-4]") {
  HomedRig rig;
  press(rig);
  const auto refused = rig.reset();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::estop_pressed);
  CHECK(rig.state() == State::estop);
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().drives_enabled);
  release(rig);
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::ready);
  CHECK(rig.simulation.virtual_machine().outputs().drives_enabled);
}

TEST_CASE("A reset that another emergency stop cuts off can be repeated", "[STA-2][safety]") {
  // At whatever instant of the reset the button is hit.
  for (int cycles = 0; cycles < 8; ++cycles) {
    INFO("pressed after " << cycles << " cycles");
    HomedRig rig;
    press(rig);
    release(rig);
    rig.simulation.cycle();
    bool answered = false;
    rig.machine.reset([&](const Result<void>&) { answered = true; });
    for (int i = 0; i < cycles; ++i) rig.simulation.cycle();
    rig.simulation.virtual_machine().press_estop(true);
    REQUIRE(rig.becomes([&] { return answered && rig.state() == State::estop; }, 5.0));
    release(rig);
    rig.simulation.cycle();
    CHECK(rig.reset());
    CHECK(rig.state() == State::ready);
    CHECK(rig.simulation.virtual_machine().outputs().drives_enabled);
  }
}

TEST_CASE("After the emergency stop the machine moves from where it really stands",
          "[STA-4][safety]") {
  HomedRig rig;
  start_cut(rig);
  press(rig);
  release(rig);
  REQUIRE(rig.reset());
  const Position stands = rig.position();
  REQUIRE(rig.mdi("G91 G1 X1 F600"));
  CHECK(rig.position()[Axis::X] == Approx(stands[Axis::X] + 1.0).margin(0.005));  // one step
  CHECK(rig.position()[Axis::Y] == stands[Axis::Y]);
}

TEST_CASE("An interrupted command says so to its caller", "[STA-4]") {
  HomedRig rig;
  Result<void> line;
  rig.machine.mdi("G1 X100 F600", [&](Result<void> result) { line = std::move(result); });
  rig.run_for(1.0);
  press(rig);
  REQUIRE_FALSE(line);
  CHECK(line.error().code == ErrorCode::command_interrupted);
}

TEST_CASE("Reset stops a running program along a ramp, spindle and coolant off", "[STA-2]") {
  HomedRig rig;
  start_cut(rig);
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::ready);
  CHECK(rig.homed(Axis::X));  // a ramp loses no steps
  CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().spindle_on);
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().flood);
  CHECK_FALSE(rig.shown()->job.ended_well);
}

TEST_CASE("Reset switches a spindle off that a single line has started", "[STA-2][safety]") {
  HomedRig rig;
  REQUIRE(rig.mdi("M3 S5000"));
  REQUIRE(rig.simulation.virtual_machine().outputs().spindle_on);
  REQUIRE(rig.reset());
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().spindle_on);
  CHECK(rig.shown()->spindle == SpindleDirection::off);
  CHECK_THAT(rig.shown()->active_codes, Catch::Contains("M5"));
}

TEST_CASE("A fault of the board is an error state that reset leaves", "[STA-2][LNK-2]") {
  HomedRig rig;
  rig.simulation.link().push(hal::Segment{.id = 1, .duration = -1.0});
  REQUIRE(rig.becomes(State::error, 1.0));
  CHECK(rig.last_error().code == ErrorCode::motion_fault);
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G0 X1"));
  CHECK(rig.position()[Axis::X] == Approx(1.0).margin(1e-9));
}
