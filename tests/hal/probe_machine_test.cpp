// Probing end to end: tool, stock and tool setter, seen as a Controller.
#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

namespace {

/// Stock with its top at -20 mm sloping by 1 % in X; a tool setter, top at -10 mm, at X 50 Y 50.
SimOptions with_stock(double x = 0.0, double y = 0.0) {
  Position start{};
  start[Axis::X] = x;
  start[Axis::Y] = y;
  TouchOptions touch{.stock = [](double at_x, double) { return -20.0 + 0.01 * at_x; },
                     .tool_setter = ToolSetter{.x = 50, .y = 50, .half_width = 5, .top = -10},
                     .tool_lengths = {{1, 7.5}, {2, 12.0}}};
  return {.machine = {.start = start, .touch = std::move(touch)}};
}

class Probing {
 public:
  explicit Probing(const SimOptions& options)
      : controller(make_virtual_controller(small_machine(), options)), hand(*controller) {}

  VirtualMachine& machine() { return controller->machine(); }

  /// Z downwards to `depth` at 20 mm/s with ramps of 0.1 s; waits until it has stopped.
  void probe(double depth) {
    const Position start = hand.status().position;
    controller->arm_probe_latch();
    const double speed = 20.0;
    double z = start[Axis::Z];
    push(start, 0.1, z -= 1.0, -speed);
    while (z > depth + 2.5) push(start, 0.05, z -= 1.0, -speed);
    push(start, 0.1, z -= 1.0, 0.0);
    hand.status();
    while (hand.status().moving) hand.wait(0.005);
  }

  std::unique_ptr<VirtualController> controller;
  Hand hand;
  std::uint32_t id = 100;

 private:
  void push(const Position& start, double duration, double z, double velocity) {
    Segment segment{.id = ++id, .duration = duration, .position = start};
    segment.position[Axis::Z] = z;
    segment.velocity[Axis::Z] = velocity;
    REQUIRE(controller->push({&segment, 1}) == 1);
  }
};

}  // namespace

TEST_CASE("Probing the stock latches the step at which the tip touches it", "[hal][GCO-2][LNK-6]") {
  struct Row {
    const char* what;
    double x;
    double y;
    double tool_length;
    double touch;  // machine Z
  };
  const Row row = GENERATE(values<Row>({
      {"stock, no tool", 0, 0, 0, -20.0},
      {"stock, tool of 7.5 mm", 0, 0, 7.5, -12.5},
      {"stock further up the slope", 40, 0, 0, -19.6},
      {"tool setter", 50, 50, 0, -10.0},
      {"edge of the tool setter", 55, 45, 7.5, -2.5},
      {"beside the tool setter", 55.1, 45, 0, -19.449},  // between steps: the next one, -19.45
  }));
  INFO(row.what);
  Probing probing(with_stock(row.x, row.y));
  probing.machine().set_tool_length(row.tool_length);
  probing.probe(-30.0);
  const ControllerStatus& status = probing.hand.status();
  REQUIRE(status.probe_latch.caught);
  const double step = 1.0 / 200;
  const double touch = std::floor(row.touch / step + 1e-6) * step;
  CHECK(status.probe_latch.position[Axis::Z] == Approx(touch).margin(1e-9));
  CHECK(status.probe_latch.position[Axis::X] == Approx(0.0).margin(1e-9));
  CHECK(status.faults == 0);
  CHECK(status.path_stop == PathStop::stopped);
  CHECK(status.fifo_count == 0);
  CHECK(status.inputs.probe);
  // 20 mm/s against 3000 mm/s^2: v^2 / 2a = 1/15 mm, and less than two slices of 100 us.
  const double overshoot = status.probe_latch.position[Axis::Z] - status.position[Axis::Z];
  CHECK(overshoot == Approx(1.0 / 15).margin(0.005));
}

TEST_CASE("The latched position keeps the counting of the moment of the touch", "[hal][LNK-6]") {
  Probing probing(with_stock());
  probing.probe(-30.0);
  REQUIRE(probing.hand.status().probe_latch.caught);
  REQUIRE(probing.controller->set_position(Axis::Z, 100.0));
  CHECK(probing.hand.status().position[Axis::Z] == Approx(100.0));
  CHECK(probing.hand.status().probe_latch.position[Axis::Z] == Approx(-20.0));
}

TEST_CASE("After a touch nothing is taken until the stop is released, then the retract runs",
          "[hal][LNK-6][GCO-2]") {
  Probing probing(with_stock());
  probing.probe(-30.0);
  Segment back{.id = 1, .duration = 0.1, .position = probing.hand.status().position};
  back.position[Axis::Z] = -18.0;
  CHECK(probing.controller->free_segments() == 0);
  CHECK(probing.controller->push({&back, 1}) == 0);
  probing.controller->release_stop();
  CHECK(probing.controller->free_segments() == cpu5::firmware::kFifoCapacity);
  REQUIRE(probing.controller->push({&back, 1}) == 1);
  probing.hand.status();
  probing.hand.wait(0.1);
  CHECK(probing.hand.status().path_stop == PathStop::none);
  CHECK(probing.hand.status().position[Axis::Z] == Approx(-18.0));
  CHECK(probing.hand.status().faults == 0);
  CHECK_FALSE(probing.hand.status().inputs.probe);
  CHECK(probing.hand.status().probe_latch.caught);  // until armed again
}

TEST_CASE("A probing move that touches nothing ends as planned", "[hal][GCO-2]") {
  Probing probing(with_stock());
  probing.probe(-10.0);
  CHECK_FALSE(probing.hand.status().probe_latch.caught);
  CHECK(probing.hand.status().probe_latch.armed);
  CHECK(probing.hand.status().path_stop == PathStop::none);
  probing.controller->disarm_probe_latch();
  CHECK_FALSE(probing.hand.status().probe_latch.armed);
}

TEST_CASE("A probe that touches already: the move that follows the arming is not executed",
          "[hal][GCO-2]") {
  Probing probing(with_stock());
  probing.machine().set_tool_length(25.0);
  const double before = probing.hand.status().position[Axis::Z];
  probing.probe(-30.0);
  const ControllerStatus& status = probing.hand.status();
  CHECK(status.probe_latch.active_at_arming);
  CHECK_FALSE(status.probe_latch.caught);
  CHECK(status.path_stop == PathStop::stopped);
  CHECK(status.position[Axis::Z] == before);
}

TEST_CASE("The tool in the spindle has its length from the tool table", "[hal][sim]") {
  Probing probing(with_stock());
  probing.machine().load_tool(2);
  CHECK(probing.machine().tool_length() == 12.0);
  probing.probe(-30.0);
  CHECK(probing.hand.status().probe_latch.position[Axis::Z] == Approx(-8.0));
  probing.machine().load_tool(99);
  CHECK(probing.machine().tool_length() == 0.0);
}

TEST_CASE("Without stock and tool setter the probe touches nothing", "[hal][sim]") {
  const auto controller = make_virtual_controller(small_machine());
  controller->machine().set_tool_length(1000.0);
  CHECK_FALSE(controller->machine().probe_touches());
}

TEST_CASE("stop_along_path brakes with the configured acceleration", "[hal][LNK-8]") {
  config::MachineConfig config = small_machine();
  config.axes[Axis::Z].acceleration = 1000.0;
  const auto controller = make_virtual_controller(config, {.machine = {.start = Position{}}});
  Hand hand(*controller);
  Segment run{.id = 1, .duration = 0.1};
  run.position[Axis::Z] = 2.5;
  run.velocity[Axis::Z] = 50.0;
  controller->push({&run, 1});
  for (std::uint32_t id = 2; id <= 11; ++id) {
    run = {.id = id, .duration = 0.1, .position = run.position, .velocity = run.velocity};
    run.position[Axis::Z] += 5.0;
    controller->push({&run, 1});
  }
  hand.status();
  hand.wait(0.2);
  const double begin = hand.status().position[Axis::Z];
  controller->stop_along_path();
  CHECK(hand.status().path_stop == PathStop::stopping);
  hand.wait(0.025);
  CHECK(hand.status().time_scale == Approx(0.5).margin(0.01));  // 50 mm/s / 1000 mm/s^2 = 50 ms
  hand.wait(0.03);
  CHECK(hand.status().path_stop == PathStop::stopped);
  CHECK_FALSE(hand.status().moving);
  // v^2 / 2a = 1.25 mm, and 0.3 ms at 50 mm/s before it begins: three slices were planned.
  CHECK(hand.status().position[Axis::Z] - begin == Approx(1.25 + 0.015).margin(0.012));
  CHECK(controller->machine().physical_position(Axis::Z) ==
        Approx(hand.status().position[Axis::Z]));
}
