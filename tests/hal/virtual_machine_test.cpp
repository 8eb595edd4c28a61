// Motors, travel stops, switches and the estop button of the virtual machine.
#include "hal/sim/virtual_machine.h"

#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

namespace {

void step(VirtualMachine& machine, Axis axis, int count) {
  for (int i = 0; i < std::abs(count); ++i) machine.step(index_of(axis), count < 0 ? -1 : 1, 0);
}

VirtualMachine machine_at(double position, const config::MachineConfig& config) {
  VirtualMachine machine(config, {.start = Position::filled(position)});
  machine.set_outputs({.drives_enabled = true});
  return machine;
}

}  // namespace

TEST_CASE("At power-up the axes stand in the middle of their travel", "[hal][sim]") {
  // From -100 to the home switch at 301: the middle is 100.5.
  const VirtualMachine machine(small_machine(), {});
  CHECK(machine.physical_position(Axis::X) == Approx(100.5));
  CHECK(machine.physical_position(Axis::A) == 0.0);
}

TEST_CASE("A motor moves its axis by one step's length per step, in its own sense", "[hal][sim]") {
  config::MachineConfig config = small_machine();
  config.axes[Axis::Y].steps_per_unit = -400.0;
  VirtualMachine machine = machine_at(0.0, config);
  step(machine, Axis::X, 1000);
  step(machine, Axis::Y, 1000);
  CHECK(machine.physical_position(Axis::X) == Approx(5.0));
  CHECK(machine.physical_position(Axis::Y) == Approx(-2.5));
  CHECK(machine.physical_position(Axis::Z) == Approx(0.0));
}

TEST_CASE("Steps against a travel stop are lost and counted", "[hal][sim]") {
  // 5 mm behind the home position of 301 mm is the stop: 306 mm, 1200 steps from 300.
  VirtualMachine machine = machine_at(300.0, small_machine());
  step(machine, Axis::X, 1200);
  CHECK(machine.lost_steps(Axis::X) == 0);
  step(machine, Axis::X, 30);
  CHECK(machine.physical_position(Axis::X) == Approx(306.0));
  CHECK(machine.lost_steps(Axis::X) == 30);
  step(machine, Axis::X, -200);
  CHECK(machine.physical_position(Axis::X) == Approx(305.0));
  CHECK(machine.lost_steps(Axis::X) == 30);
  CHECK(machine.lost_steps(Axis::Y) == 0);

  VirtualMachine other_end = machine_at(-100.0, small_machine());
  step(other_end, Axis::Z, -1001);
  CHECK(other_end.physical_position(Axis::Z) == Approx(-105.0));
  CHECK(other_end.lost_steps(Axis::Z) == 1);
}

TEST_CASE("A motor whose drive is off loses its steps", "[hal][sim]") {
  VirtualMachine machine = machine_at(0.0, small_machine());
  machine.set_outputs({});
  step(machine, Axis::X, 10);
  CHECK(machine.physical_position(Axis::X) == Approx(0.0));
  CHECK(machine.lost_steps(Axis::X) == 10);
}

TEST_CASE("An axis without a port has no motor", "[hal][sim]") {
  VirtualMachine machine = machine_at(0.0, small_machine());
  step(machine, Axis::B, 500);
  CHECK(machine.physical_position(Axis::B) == 0.0);
  CHECK(machine.lost_steps(Axis::B) == 0);
}

TEST_CASE("A rotary axis without travel turns for ever", "[hal][sim]") {
  config::MachineConfig config = small_machine();
  config.axes[Axis::A].port = 4;
  config.axes[Axis::A].steps_per_unit = 10.0;
  VirtualMachine machine = machine_at(0.0, config);
  step(machine, Axis::A, 36'000);
  CHECK(machine.physical_position(Axis::A) == Approx(3600.0));
  CHECK(machine.lost_steps(Axis::A) == 0);
  CHECK_FALSE(machine.home_switch(Axis::A));
}

TEST_CASE("A home switch trips behind the home position and releases exactly there",
          "[hal][sim][HOM-2]") {
  // Home at 301 mm, hysteresis 0.2 mm = 40 steps: from 300 mm it is 200 steps to the release
  // position and 240 to the trip.
  const int sense = GENERATE(1, -1);
  config::MachineConfig config = small_machine();
  config.axes[Axis::X].steps_per_unit = 200.0 * sense;
  VirtualMachine machine = machine_at(300.0, config);
  step(machine, Axis::X, 239 * sense);
  CHECK_FALSE(machine.home_switch(Axis::X));
  step(machine, Axis::X, 1 * sense);
  CHECK(machine.home_switch(Axis::X));
  CHECK(machine.inputs(0).home == 0b000001);
  step(machine, Axis::X, -39 * sense);
  CHECK(machine.home_switch(Axis::X));
  step(machine, Axis::X, -1 * sense);
  CHECK_FALSE(machine.home_switch(Axis::X));
  CHECK(machine.physical_position(Axis::X) == 301.0);
}

TEST_CASE("A home switch stays on all the way to the stop", "[hal][sim][HOM-2]") {
  config::MachineConfig config = small_machine();
  config.axes[Axis::X].home_velocity = -20.0;
  config.axes[Axis::X].home_position = -101.0;
  VirtualMachine machine = machine_at(-100.0, config);
  CHECK_FALSE(machine.home_switch(Axis::X));
  step(machine, Axis::X, -2000);
  CHECK(machine.physical_position(Axis::X) == Approx(-106.0));
  CHECK(machine.home_switch(Axis::X));
}

TEST_CASE("An axis that is switched on while on its home switch says so", "[hal][sim]") {
  CHECK(VirtualMachine(small_machine(), {.start = Position::filled(305.0)}).home_switch(Axis::X));
}

TEST_CASE("The estop button is an input until it is pulled out", "[hal][sim][STA-4]") {
  VirtualMachine machine = machine_at(0.0, small_machine());
  machine.press_estop(true);
  CHECK(machine.inputs(0).estop1);
  machine.press_estop(false);
  CHECK_FALSE(machine.inputs(0).estop1);
}
