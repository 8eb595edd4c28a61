// Homing as the server will do it, on the virtual machine: two moves, position latched on release.
#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

TEST_CASE("After two-move homing the machine counts where it physically is",
          "[hal][HOM-2][LNK-6]") {
  const double side = GENERATE(1.0, -1.0);
  const double steps_per_unit = GENERATE(200.0, -123.456);
  config::MachineConfig config = small_machine();
  config::AxisConfig& motor = config.axes[Axis::Y];
  motor.steps_per_unit = steps_per_unit;
  motor.home_velocity = side * 20.0;
  motor.home_position = side > 0 ? 300.77 : -100.77;
  const auto controller =
      make_virtual_controller(config, {.machine = {.start = Position::filled(40.0)}});
  Hand hand(*controller);
  CHECK(hand.status().position[Axis::Y] == 0.0);

  hand.move_while(Axis::Y, side * 400.0, [&] { return !hand.status().inputs.home[Axis::Y]; });
  REQUIRE(hand.status().inputs.home[Axis::Y]);
  controller->arm_home_latch(Axis::Y, LatchEdge::release);
  hand.move_while(Axis::Y, side * -20.0, [&] { return !hand.status().home_latch[Axis::Y].caught; });
  const Latch latch = hand.status().home_latch[Axis::Y];
  REQUIRE(latch.caught);
  const double beyond = hand.status().position[Axis::Y] - latch.position;
  REQUIRE(controller->set_position(Axis::Y, motor.home_position + beyond));

  CHECK(hand.status().position[Axis::Y] ==
        Approx(controller->machine().physical_position(Axis::Y)).margin(1e-9));
  CHECK(hand.status().home_latch[Axis::Y].position == latch.position);
  CHECK(controller->machine().lost_steps(Axis::Y) == 0);

  hand.move(Axis::Y, side * -100.0);
  CHECK(hand.status().position[Axis::Y] ==
        Approx(controller->machine().physical_position(Axis::Y)).margin(1e-9));
}
