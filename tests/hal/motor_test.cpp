// Motors have a torque that ends somewhere: a legal motion never loses a step, and a faulty one
// does.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

namespace {

struct Motor {
  const char* what;
  double steps_per_unit;
  double velocity;
  double acceleration;
};

const std::vector<Motor> kMotors{
    {"router", 200, 50, 200},
    {"fast router", 400, 500, 3'000},
    {"printer", 80, 400, 4'000},
    {"fine screw", 1'000, 100, 1'000},
    {"very fine screw", 10'000, 30, 5'000},
    {"strong and short", 2'000, 60, 20'000},
    {"coarse rotary table", 10, 50, 200},
    {"slow rotary table", 100, 5, 5},
};

config::MachineConfig machine_with(const Motor& motor) {
  config::MachineConfig config;
  config::AxisConfig& axis = config.axes[Axis::X];
  axis.port = 1;
  axis.steps_per_unit = motor.steps_per_unit;
  axis.velocity = motor.velocity;
  axis.acceleration = motor.acceleration;
  return config;
}

/// Drives X along pieces of constant acceleration, which a segment holds exactly.
class Drive {
 public:
  explicit Drive(const config::MachineConfig& config, const MachineOptions& options = {})
      : controller_(make_virtual_controller(config, {.machine = options})) {
    REQUIRE(controller_->connect());
    controller_->set_outputs({.drives_enabled = true});
    controller_->exchange(0.0);
  }

  VirtualMachine& machine() { return controller_->machine(); }
  [[nodiscard]] double velocity() const { return velocity_; }
  [[nodiscard]] std::uint64_t lost() { return machine().lost_steps(Axis::X); }
  [[nodiscard]] const ControllerStatus& status() { return controller_->exchange(now_); }

  void accelerate(double acceleration, double duration) {
    while (duration > 1e-9) {
      const double piece = std::min(duration, 0.1);
      duration -= piece;
      position_ += velocity_ * piece + acceleration * piece * piece / 2;
      velocity_ += acceleration * piece;
      push(piece);
    }
  }
  void change_velocity(double target, double acceleration) {
    const double duration = std::abs(target - velocity_) / acceleration;
    accelerate(std::copysign(acceleration, target - velocity_), duration);
    velocity_ = target;
  }
  /// To `velocity` at once, which the board does not mind.
  void jump(double velocity) { velocity_ = velocity; }
  /// Everything that is in the board, and a while more.
  void finish(double rest = 0.5) {
    for (double end = queued_until_ + rest; now_ < end; now_ += 0.01) controller_->exchange(now_);
  }

 private:
  void push(double duration) {
    Segment segment{.id = ++id_, .duration = duration};
    segment.position[Axis::X] = position_;
    segment.velocity[Axis::X] = velocity_;
    while (controller_->free_segments() < 8) controller_->exchange(now_ += 0.01);
    REQUIRE(controller_->push({&segment, 1}) == 1);
    queued_until_ = std::max(queued_until_, now_) + duration;
  }

  std::unique_ptr<VirtualController> controller_;
  double now_ = 0.0;
  double queued_until_ = 0.0;
  double position_ = 0.0;
  double velocity_ = 0.0;
  std::uint32_t id_ = 0;
};

}  // namespace

TEST_CASE("No legal motion loses a step, whatever the motor", "[hal][sim][LNK-6]") {
  const Motor motor = GENERATE(from_range(kMotors));
  INFO(motor.what);
  std::mt19937 random(20260101);
  Drive drive(machine_with(motor));
  const auto draw = [&random](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  // All of the acceleration one way or the other, or a part of it, for any time, or none: the
  // velocity stays within its limits because a piece that would leave them is turned round.
  const double longest = std::min(0.1, motor.velocity / motor.acceleration);
  for (int i = 0; i < 3'000; ++i) {
    const double duration = std::pow(10.0, draw(std::log10(0.001), std::log10(longest)));
    const double part = i % 4 == 0 ? draw(0.0, 1.0) : i % 7 == 0 ? 0.0 : 1.0;
    double acceleration = motor.acceleration * part * (draw(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
    const double end = drive.velocity() + acceleration * duration;
    if (std::abs(end) > motor.velocity) acceleration = -acceleration;
    drive.accelerate(acceleration, duration);
  }
  drive.change_velocity(0.0, motor.acceleration);
  drive.finish();
  CHECK(drive.status().faults == 0);
  CHECK(drive.lost() == 0);
}

TEST_CASE("Full acceleration to and fro at any rhythm loses no step", "[hal][sim][LNK-6]") {
  const Motor motor = GENERATE(from_range(kMotors));
  // Through the resonance of the rotor in its field, sqrt(1.5 a / full step): from 1 to 200 Hz.
  const double frequency = GENERATE(1.0, 3.0, 8.0, 20.0, 45.0, 90.0, 200.0);
  INFO(motor.what << " at " << frequency << " Hz");
  Drive drive(machine_with(motor));
  const double quarter = 0.25 / frequency;
  const double acceleration = std::min(motor.acceleration, motor.velocity / quarter);
  for (int i = 0; i < 60; ++i) {
    drive.accelerate(acceleration, quarter);
    drive.accelerate(-acceleration, 2 * quarter);
    drive.accelerate(acceleration, quarter);
  }
  drive.finish();
  CHECK(drive.lost() == 0);
}

TEST_CASE("Single steps at any low speed are no jerks", "[hal][sim]") {
  const Motor motor = GENERATE(from_range(kMotors));
  const double step_frequency = GENERATE(0.7, 5.0, 33.0, 170.0, 600.0);
  INFO(motor.what << " at " << step_frequency << " steps/s");
  const double speed = std::min(step_frequency / motor.steps_per_unit, motor.velocity);
  Drive drive(machine_with(motor));
  drive.change_velocity(speed, motor.acceleration);
  drive.accelerate(0.0, 10.0);
  drive.change_velocity(-speed, motor.acceleration);
  drive.accelerate(0.0, 10.0);
  drive.change_velocity(0.0, motor.acceleration);
  drive.finish();
  CHECK(drive.lost() == 0);
}

TEST_CASE("Twice the configured acceleration loses steps", "[hal][sim][LNK-6]") {
  // The motor has 1.5 times; a third of what is asked for is missing, and the ramp is long enough
  // for two full steps of lag: 0.5 a t^2 / 2 with t = v / 2a is v^2 / 16 a, against 8 steps.
  const Motor motor = GENERATE(filter(
      [](const Motor& m) {
        return m.velocity * m.velocity / 16 / m.acceleration * m.steps_per_unit > 16;
      },
      from_range(kMotors)));
  INFO(motor.what);
  Drive drive(machine_with(motor));
  drive.change_velocity(motor.velocity, 2 * motor.acceleration);
  drive.accelerate(0.0, 0.2);
  drive.change_velocity(0.0, motor.acceleration);
  drive.finish();
  CHECK(drive.status().faults == 0);
  CHECK(drive.lost() > 0);
  const double counted = drive.status().position[Axis::X];
  CHECK(drive.machine().physical_position(Axis::X) < counted);
}

TEST_CASE("A motor beyond its top speed stalls, and moves again when it was slow", "[hal][sim]") {
  const Motor motor{"router", 200, 50, 500};
  Drive drive(machine_with(motor));
  // 2.2 times the velocity, gently: above the top speed of twice the velocity nothing is left.
  drive.change_velocity(110.0, 250.0);
  drive.accelerate(0.0, 1.0);
  drive.change_velocity(0.0, 250.0);
  drive.finish();
  const std::uint64_t lost = drive.lost();
  // The ramp to twice the velocity, 100^2 / 2 / 250 = 20 mm, was made; the second at full speed was
  // not, 110 mm, nor most of the ramp down, 110^2 / 2 / 250 = 24 mm.
  CHECK(lost > 110 * 200);
  CHECK(drive.machine().physical_position(Axis::X) > 20.0);
  CHECK(drive.machine().physical_position(Axis::X) < 60.0);
  const double stalled_at = drive.machine().physical_position(Axis::X);
  drive.change_velocity(50.0, 500.0);
  drive.change_velocity(0.0, 500.0);
  drive.finish();
  CHECK(drive.lost() == lost);
  CHECK(drive.machine().physical_position(Axis::X) == Approx(stalled_at + 5.0));  // 50^2 / 500
}

TEST_CASE("Pulses that cease at speed let the motor run on, but not at creeping speed",
          "[hal][sim][LNK-8]") {
  const Motor motor{"router", 200, 50, 500};
  Drive drive(machine_with(motor));
  const double speed = GENERATE(1.0, 50.0);
  drive.change_velocity(speed, motor.acceleration);
  drive.accelerate(0.0, 0.5);
  drive.jump(0.0);
  // A segment of no length: nothing moves from its start on.
  drive.accelerate(0.0, 0.001);
  drive.finish(1.0);
  const double run_on =
      drive.machine().physical_position(Axis::X) - drive.status().position[Axis::X];
  if (speed == 1.0) {
    CHECK(drive.lost() == 0);
    CHECK(run_on == Approx(0.0).margin(1e-9));
    return;
  }
  // Braked by 1.5 a and then, out of step, by half of it: between 50^2 / 2 / 750 = 1.7 mm and twice
  // as much. Those steps are lost: nobody counted them.
  CHECK(run_on > 1.7);
  CHECK(run_on < 3.4);
  CHECK(drive.lost() == static_cast<std::uint64_t>(std::llround(run_on * 200)));
}

TEST_CASE("The torque falls as one over the speed above the corner", "[hal][sim]") {
  const MotorCurve curve{.acceleration = 900, .corner_velocity = 30, .top_velocity = 90};
  CHECK(curve.acceleration_at(0) == 900);
  CHECK(curve.acceleration_at(-30) == 900);
  CHECK(curve.acceleration_at(45) == Approx(600));  // 900 * 30 / 45
  CHECK(curve.acceleration_at(-90) == Approx(300));
  CHECK(curve.acceleration_at(90.001) == 0);
}

TEST_CASE("A motor too weak for its configuration loses steps at speed only", "[hal][sim]") {
  // At 40 mm/s there is left of the torque 500 * 10 / 40 = 125 mm/s^2.
  MachineOptions options;
  options.axes[Axis::X].motor = {
      .acceleration = 500.0, .corner_velocity = 10.0, .top_velocity = 80.0};
  const double speed = GENERATE(8.0, 40.0);
  Drive drive(machine_with({"weak", 200, 50, 300}), options);
  drive.change_velocity(speed, 300.0);
  drive.change_velocity(0.0, 300.0);
  drive.finish();
  CHECK((drive.lost() > 0) == (speed == 40.0));
}

TEST_CASE("A closed-loop drive raises its alarm for its own axis until it is switched off",
          "[hal][sim]") {
  const bool closed_loop = GENERATE(true, false);
  MachineOptions options;
  options.start = Position{};
  options.axes[Axis::Y].motor.closed_loop = closed_loop;
  VirtualMachine machine(small_machine(), options);
  machine.set_outputs({.drives_enabled = true});
  CHECK(machine.inputs(0).alarm == 0);
  machine.lose_steps(Axis::Y, 7);
  CHECK(machine.lost_steps(Axis::Y) == 7);
  CHECK(machine.physical_position(Axis::Y) == Approx(7 / 200.0));
  CHECK(machine.inputs(1).alarm == (closed_loop ? 0b000010 : 0));
  machine.set_outputs({});
  CHECK(machine.inputs(2).alarm == 0);
  machine.step(1, 1, 2);  // without power: nobody's fault
  CHECK(machine.inputs(3).alarm == 0);
}

TEST_CASE("A slave's motor is as strong as its master's motion asks for", "[hal][sim]") {
  config::MachineConfig config = machine_with({"master", 200, 100, 2'000});
  config.axes[Axis::A] = config.axes[Axis::X];
  config.axes[Axis::A].port = 2;
  config.axes[Axis::A].mode = config::AxisMode::slave_x;
  config.axes[Axis::A].velocity = 5.0;
  config.axes[Axis::A].acceleration = 5.0;
  const auto controller = make_virtual_controller(config);
  Hand hand(*controller);
  for (const Axis axis : {Axis::X, Axis::A}) hand.move(axis, 3.0);  // 6 * 3 / 0.1^2 = 1800 mm/s^2
  hand.wait(0.5);
  CHECK(controller->machine().lost_steps(Axis::X) == 0);
  CHECK(controller->machine().lost_steps(Axis::A) == 0);
}
