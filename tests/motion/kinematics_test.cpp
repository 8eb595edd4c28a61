#include "motion/kinematics.h"

#include <catch2/catch.hpp>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

/// A gantry: A is the second motor of X.
MotorAxes gantry() {
  MotorAxes axes = kOwnAxes;
  axes[Axis::A] = Axis::X;
  return axes;
}

}  // namespace

TEST_CASE("Every motor moves its own axis", "[CFG-7]") {
  const Kinematics kinematics;
  const Position place{{1, 2, 3, 4, 5, 6}};
  CHECK(kinematics.joints_at(place) == place);
  CHECK(kinematics.machine_at(place) == place);
  CHECK(kinematics.joint_velocity(place) == place);
}

TEST_CASE("A slave follows its master, and its letter is no axis any more", "[CFG-3][CFG-7]") {
  const Kinematics kinematics(gantry());
  const Position joints = kinematics.joints_at(xyz(10, 20, 30));
  CHECK(joints[Axis::A] == 10.0);
  CHECK(kinematics.joint_velocity(xyz(-3, 0))[Axis::A] == -3.0);
  CHECK(kinematics.machine_at(joints) == xyz(10, 20, 30));
}

TEST_CASE("The slower motor of a gantry sets the limits of the axis", "[CFG-3][MOT-1]") {
  AxisLimits joints = reference_limits();
  joints.max_velocity[Axis::A] = 40.0;        // X: 100
  joints.max_acceleration[Axis::A] = 2000.0;  // X: 500
  const AxisLimits machine = Kinematics(gantry()).machine_limits(joints);
  CHECK(machine.max_velocity[Axis::X] == 40.0);
  CHECK(machine.max_acceleration[Axis::X] == 500.0);
  CHECK(machine.max_velocity[Axis::Y] == 100.0);
  CHECK(machine.max_velocity[Axis::A] == 0.0);
}

TEST_CASE("A slave keeps its distance from its master", "[CFG-3]") {
  Kinematics kinematics(gantry());
  const Position tolerance = Position::filled(0.01);
  Position found = xyz(100, 0);
  found[Axis::A] = 98.5;
  kinematics.accept(found, tolerance);
  CHECK(kinematics.joints_at(xyz(100, 0)) == found);
  CHECK(kinematics.joints_at(xyz(120, 0))[Axis::A] == 118.5);
  CHECK(kinematics.machine_at(found) == xyz(100, 0));
  // What steps of another length leave is no new distance: it would add up stop by stop.
  found[Axis::A] = 98.505;
  kinematics.accept(found, tolerance);
  CHECK(kinematics.skew(Axis::A) == -1.5);
}

}  // namespace cnc::motion::test
