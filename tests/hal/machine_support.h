// A small machine, and a hand on its controller that moves it in virtual time.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>

#include "hal/sim/virtual_controller.h"

namespace cnc::hal::sim {

/// X Y Z on ports 1 … 3, 200 steps/mm, travel -100 … 300 mm, homing to the positive end. As fast as
/// Hand moves it: 5 mm from rest to rest in 0.1 s begin with 6 * 5 / 0.1^2 = 3000 mm/s^2.
inline config::MachineConfig small_machine() {
  config::MachineConfig config;
  std::int32_t port = 0;
  for (const Axis axis : kLinearAxes) {
    config::AxisConfig& motor = config.axes[axis];
    motor.port = ++port;
    motor.steps_per_unit = 200.0;
    motor.negative_limit = -100.0;
    motor.positive_limit = 300.0;
    motor.velocity = 75.0;
    motor.acceleration = 3000.0;
    motor.home_velocity = 20.0;
    motor.home_position = 301.0;
  }
  return config;
}

/// Moves by segments of 0.1 s, from rest to rest, at most 5 mm each: 1.5 * 50 mm/s at the fastest.
class Hand {
 public:
  explicit Hand(VirtualController& controller) : controller_(controller) {
    REQUIRE(controller_.connect());
    controller_.set_outputs({.drives_enabled = true});
    status();
  }

  const ControllerStatus& status() { return controller_.exchange(now_); }

  void wait(double duration) {
    now_ += duration;
    status();
  }

  /// Moves one axis by `distance` while `go_on` says so, checked after each 5 mm.
  template <typename Condition>
  void move_while(Axis axis, double distance, Condition go_on) {
    const int pieces = static_cast<int>(std::ceil(std::abs(distance) / 5.0));
    for (int i = 0; i < pieces && go_on(); ++i) {
      Segment segment{.id = ++id_, .duration = 0.1, .position = status().position};
      segment.position[axis] += distance / pieces;
      REQUIRE(controller_.push({&segment, 1}) == 1);
      status();
      wait(0.1);
    }
  }
  void move(Axis axis, double distance) {
    move_while(axis, distance, [] { return true; });
  }

 private:
  VirtualController& controller_;
  double now_ = 1000.0;  // a steady clock starts anywhere
  std::uint32_t id_ = 0;
};

}  // namespace cnc::hal::sim
