// Slaves, backlash, pitch and the height map on the whole machine (CFG-3, MOT-5, LNG-5).
#include <catch2/catch.hpp>
#include <cmath>

#include "server/daemon/shipped_files.h"
#include "server/job/settings.h"
#include "tests/server/macro_rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

namespace {

constexpr double kStep = 1.0 / 200.0;  // mm, of the shipped X and Y

double physical(Rig& rig, Axis axis) {
  return rig.simulation.virtual_machine().physical_position(axis);
}

/// What the motors got: the largest part of a limit that any of their cubics uses, and the furthest
/// that they went.
class MotorWitness {
 public:
  explicit MotorWitness(Rig& rig) : limits_(motor_limits(rig.machine.config())) {
    rig.machine.set_motor_listener([this](const motion::Setpoint& motors) { add(motors); });
  }
  /// The first setpoint tells where the motors are; it is not judged.
  void add(const motion::Setpoint& motors) {
    if (seen_) {
      for (const Axis axis : kAllAxes) {
        if (limits_.max_velocity[axis] == 0.0) continue;
        const auto cubic = motion::cubic_of(axis, position_, velocity_, motors);
        velocity_used = std::max(velocity_used, cubic.fastest() / limits_.max_velocity[axis]);
        for (const double a : {cubic.start_acceleration(), cubic.end_acceleration()})
          acceleration_used =
              std::max(acceleration_used, std::abs(a) / limits_.max_acceleration[axis]);
      }
    }
    seen_ = true;
    position_ = motors.position;
    velocity_ = motors.velocity;
  }
  void check() const {
    CHECK(seen_);
    CHECK(velocity_used <= 1.0 + 1e-6);
    CHECK(acceleration_used <= 1.0 + 1e-6);
  }
  [[nodiscard]] const Position& position() const { return position_; }

  double velocity_used = 0.0;
  double acceleration_used = 0.0;

 private:
  motion::AxisLimits limits_;
  Position position_;
  Position velocity_;
  bool seen_ = false;
};

/// A gantry: the second motor of X on output 4, with other steps and slower.
std::vector<std::string> gantry() {
  return {"AXIS_A.port=4",           "AXIS_A.mode=slaveX",       "AXIS_A.stepsPerUnit=-400",
          "AXIS_A.negativeLimit=0",  "AXIS_A.positiveLimit=600", "AXIS_A.velocity=40",
          "AXIS_A.acceleration=250", "AXIS_A.homeVelocity=-10",  "AXIS_X.homeVelocity=-10"};
}

}  // namespace

TEST_CASE("A slave moves with its master, by its own steps and at its own limits",
          "[CFG-3][MOT-1]") {
  ReadyRig rig(free_machine(gantry()));
  MotorWitness witness(rig);
  const double begin = rig.simulation.time();
  REQUIRE(rig.mdi("G0 X80 Y10"));
  // 80 mm at the slave's 40 mm/s and 250 mm/s².
  CHECK(rig.simulation.time() - begin >= 80.0 / 40.0 + 40.0 / 250.0);
  CHECK(physical(rig, Axis::X) == Approx(80.0).margin(kStep));
  CHECK(physical(rig, Axis::A) == Approx(80.0).margin(kStep));
  CHECK(rig.position()[Axis::X] == Approx(80.0).margin(kStep));
  CHECK(rig.position()[Axis::A] == 0.0);
  witness.check();
}

TEST_CASE("A slave is no axis of programs and hands", "[CFG-3]") {
  ReadyRig rig(free_machine(gantry()));
  const auto moved = rig.mdi("G0 A10");
  REQUIRE_FALSE(moved);
  CHECK(moved.error().code == ErrorCode::axis_not_connected);
  CHECK_FALSE(rig.machine.jog_step(Axis::A, 1.0, 0.5));
  CHECK_FALSE(rig.home({Axis::A}));
}

TEST_CASE("Homing the master homes a gantry, and the slave keeps its place beside it", "[CFG-3]") {
  SimulationOptions options;
  Position start;
  start[Axis::X] = 30.0;
  start[Axis::A] = 28.5;  // the bridge stands askew
  start[Axis::Y] = 50.0;
  start[Axis::Z] = -10.0;
  options.machine.start = start;
  Rig rig(shipped_machine(gantry()), options);
  REQUIRE(rig.reset());
  REQUIRE(rig.home());
  CHECK(rig.simulation.virtual_machine().lost_steps(Axis::A) == 0);
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G0 X100"));
  CHECK(physical(rig, Axis::X) == Approx(100.0).margin(kStep));
  CHECK(physical(rig, Axis::A) == Approx(98.5).margin(3.0 * kStep));
}

TEST_CASE("Backlash: the motor goes further by the play, the machine shows where it is",
          "[MOT-5]") {
  ReadyRig rig(free_machine({"AXIS_X.backlash=0.05", "AXIS_Y.backlash=0.05"}));
  MotorWitness witness(rig);
  REQUIRE(rig.mdi("G0 X20 Y20"));
  CHECK(physical(rig, Axis::X) == Approx(20.0).margin(kStep));
  REQUIRE(rig.mdi("G0 X10"));
  CHECK(physical(rig, Axis::X) == Approx(9.95).margin(kStep));
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kStep));
  REQUIRE(rig.mdi("G2 X10 Y20 I10 F3000"));
  REQUIRE(rig.mdi("G0 X10.01"));
  CHECK(physical(rig, Axis::X) == Approx(10.01).margin(kStep));
  CHECK(rig.position()[Axis::X] == Approx(10.01).margin(kStep));
  witness.check();
  CHECK(witness.acceleration_used > 0.75);
}

TEST_CASE("Backlash survives homing, pause, stop and jog", "[MOT-5][HOM-1]") {
  Rig rig(shipped_machine({"AXIS_X.backlash=0.1", "AXIS_Z.backlash=0.1"}));
  REQUIRE(rig.reset());
  REQUIRE(rig.home());
  // Homing left the switch upwards: there the play is taken up, and machine = motor.
  REQUIRE(rig.mdi("G0 X50"));
  const double offset = physical(rig, Axis::X) - 50.0;
  CHECK(std::abs(offset) <= 0.1 + kStep);
  REQUIRE(rig.mdi("G0 X40"));
  CHECK(physical(rig, Axis::X) - 40.0 == Approx(offset - 0.1).margin(2.0 * kStep));
  rig.start("G1 X60 F1200\nG1 X40\nG1 X60\n");
  rig.run_for(1.5);
  REQUIRE(rig.pause());
  REQUIRE(rig.machine.resume());
  REQUIRE(rig.becomes(State::ready));
  CHECK(physical(rig, Axis::X) - 60.0 == Approx(offset).margin(2.0 * kStep));
  REQUIRE(rig.machine.jog_step(Axis::X, -1.0, 0.5));
  REQUIRE(rig.becomes(State::ready));
  CHECK(rig.position()[Axis::X] == Approx(59.0).margin(kStep));
  CHECK(physical(rig, Axis::X) - 59.0 == Approx(offset - 0.1).margin(2.0 * kStep));
  REQUIRE(rig.mdi("G0 X100"));
  CHECK(physical(rig, Axis::X) - 100.0 == Approx(offset).margin(2.0 * kStep));
}

TEST_CASE("Re-planning at any moment goes on with the play as it was then",
          "[MOT-5][JOB-8][MAN-8]") {
  ReadyRig rig(free_machine({"AXIS_X.backlash=0.1", "AXIS_Y.backlash=0.05"}));
  std::string zigzag;
  for (int i = 1; i <= 40; ++i)
    zigzag += "G1 X" + std::to_string(i % 2 == 0 ? 10 : 14) + " Y" + std::to_string(i % 3) +
              (i % 5 == 0 ? " F1500\nG61.1\n" : " F3000\nG64 P0.1\n");
  rig.start(zigzag + "G1 X20 Y5\nG1 X12 Y3\n");
  // Every motor setpoint is checked against the motor's limits from where the plan was cut: a state
  // that does not belong there would be refused, and the job fail.
  for (int i = 0; i < 60 && rig.state() == State::running; ++i) {
    rig.run_for(0.013 + 0.007 * (i % 11));
    if (i % 4 == 3) {
      if (rig.pause()) REQUIRE(rig.machine.resume());
    } else {
      static_cast<void>(
          rig.machine.set_overrides({.feed = 0.3 + 0.3 * (i % 7), .rapid = 1.0, .speed = 1.0}));
    }
  }
  REQUIRE(rig.becomes(State::ready, 600.0));
  CHECK(rig.shown()->job.ended_well);
  CHECK(physical(rig, Axis::X) == Approx(12.0 - 0.1).margin(kStep));
  CHECK(physical(rig, Axis::Y) == Approx(3.0 - 0.05).margin(kStep));
  CHECK(rig.position()[Axis::X] == Approx(12.0).margin(kStep));
}

TEST_CASE("A reset leaves the machine where it is, with every compensation", "[MOT-5]") {
  ReadyRig rig(free_machine({"AXIS_X.backlash=0.1"}));
  REQUIRE(rig.mdi("G0 X20"));
  REQUIRE(rig.mdi("G0 X10"));
  const double before = physical(rig, Axis::X);
  REQUIRE(rig.reset());
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kStep));
  REQUIRE(rig.mdi("G0 X10"));
  CHECK(physical(rig, Axis::X) == before);
}

TEST_CASE("Pitch: the motor makes up for its screw, the machine shows the true position",
          "[MOT-5][CFG-24]") {
  MachineData data = free_machine();
  data.config.axes[Axis::X].pitch_table = {{0, 0}, {50, 50.1}, {200, 200.2}};
  ReadyRig rig(std::move(data));
  MotorWitness witness(rig);
  REQUIRE(rig.mdi("G0 X200.2"));
  CHECK(physical(rig, Axis::X) == Approx(200.0).margin(kStep));
  CHECK(rig.position()[Axis::X] == Approx(200.2).margin(kStep));
  REQUIRE(rig.mdi("G1 X50.1 F6000"));
  CHECK(physical(rig, Axis::X) == Approx(50.0).margin(kStep));
  witness.check();
}

TEST_CASE("ZHC ON follows the measured slope, ZHC OFF leaves it", "[MOT-5][LNG-5]") {
  MacroRig macro(shipped_macros());
  Rig& rig = macro.rig;
  REQUIRE(rig.becomes(State::ready));
  const auto early = macro.run("ZHC ON");
  REQUIRE_FALSE(early);
  CHECK(early.error().code == ErrorCode::height_map_unusable);
  REQUIRE(macro.run("G92 Z75"));  // work Z 0 = machine -75
  REQUIRE(macro.run("gosub zhcmgrid", {3, 2, 5, -20, 10, 600}));
  REQUIRE(macro.run("G92.1"));

  // The bench is a slope of 0.1 in X and 0.05 in Y; the first point counts 0.
  REQUIRE(macro.run("G0 X0 Y0 Z-20"));
  MotorWitness witness(rig);
  REQUIRE(macro.run("ZHC ON"));
  const auto added = [&](double x, double y) { return 0.1 * x + 0.05 * y; };
  for (const auto& [x, y] : {std::pair{20.0, 10.0}, {10.0, 0.0}, {5.0, 7.0}, {0.0, 0.0}}) {
    REQUIRE(macro.run("G1 X" + std::to_string(x) + " Y" + std::to_string(y) + " F3000"));
    INFO("at " << x << ", " << y);
    // The probe stops on a step of 5 µm: so exact are the points.
    CHECK(physical(rig, Axis::Z) == Approx(-20.0 + added(x, y)).margin(3.0 * kStep));
    CHECK(rig.position()[Axis::Z] == Approx(-20.0).margin(kStep));
  }
  CHECK_FALSE(macro.run("ZHCINIT 10 2 2"));

  REQUIRE(macro.run("G0 X20 Y10"));
  REQUIRE(macro.run("ZHC OFF"));
  CHECK(physical(rig, Axis::Z) == Approx(-20.0).margin(kStep));
  witness.check();
}

TEST_CASE("With a height map Z keeps away from the end of its travel", "[MOT-5][STA-5]") {
  MacroRig macro(shipped_macros());
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("G92 Z75"));
  REQUIRE(macro.run("gosub zhcmgrid", {3, 2, 5, -20, 10, 600}));
  REQUIRE(macro.run("G92.1"));
  REQUIRE(macro.run("ZHC ON"));
  // Up to 2.5 mm (20, 10) and one cell more are added; the travel ends at 10.
  const auto refused = macro.run("G53 G0 Z9");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::travel_limit);
  CHECK(macro.rig.state() == State::ready);
  REQUIRE(macro.run("ZHC OFF"));
  CHECK(macro.run("G53 G0 Z9"));
}
