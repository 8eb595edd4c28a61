// The link loop is real-time: after connect() neither driver nor board allocates.
#include "tests/allocations.h"
#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

TEST_CASE("Exchange, push and the other real-time calls allocate nothing", "[hal]") {
  const auto controller = make_virtual_controller(
      small_machine(), {.machine = {.touch = {.stock = [](double x, double y) { return x - y; }},
                                    .heaters = {{.pwm = 1}},
                                    .loop_back_delay = 0.01}});
  REQUIRE(controller->connect());
  REQUIRE(test::allocations() > 0);  // the counter counts: the controller itself is on the heap
  const std::size_t before = test::allocations();
  controller->set_outputs({.drives_enabled = true, .spindle_pwm = 0.5, .ports = Ports(5)});
  controller->arm_home_latch(Axis::X, LatchEdge::activate);
  for (std::uint32_t i = 1; i <= 1000; ++i) {
    Segment segment{.id = i, .duration = 0.005};
    segment.position[Axis::X] = 0.05 * i;
    controller->push({&segment, 1});
    controller->exchange(0.005 * i);
  }
  controller->disarm_home_latch(Axis::X);
  controller->stop_along_path();
  controller->exchange(5.5);
  controller->release_stop();
  controller->arm_probe_latch();
  controller->exchange(5.6);
  controller->disarm_probe_latch();
  controller->quick_stop();
  controller->clear_faults();
  controller->set_position(Axis::Y, 1.0);
  const Position end = controller->exchange(6.0).position;
  const std::size_t after = test::allocations();
  CHECK(after == before);
  CHECK(end[Axis::X] > 40.0);
}
