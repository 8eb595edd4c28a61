// How much faster than real time the virtual machine runs: driver, firmware core and motors
// together, on a 3-axis path at 100 mm/s with 200 steps/mm, in setpoints of 5 ms; and what the
// trace of the link costs an exchange.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "hal/sim/virtual_controller.h"
#include "hal/trace/ring.h"

namespace {

using namespace cnc;

constexpr double kSetpoint = 0.005;
constexpr double kFifoTime = 0.25;
constexpr double kCycle = 0.01;
constexpr double kSeconds = 1000.0;
constexpr double kSpeed = 100.0;

config::MachineConfig three_axis_machine() {
  config::MachineConfig config;
  std::int32_t port = 0;
  for (const Axis axis : kLinearAxes) {
    config.axes[axis].port = ++port;
    config.axes[axis].steps_per_unit = 200.0;
    config.axes[axis].negative_limit = -500.0;
    config.axes[axis].positive_limit = 500.0;
    config.axes[axis].velocity = kSpeed;
    config.axes[axis].acceleration = 250.0;  // 100^2 / 50 on the circle, and the run-up across it
  }
  return config;
}

// A circle of 50 mm in X Y with Z following, run at kSpeed after one second of run-up.
hal::Segment point_of_path(std::uint32_t id) {
  constexpr double kRadius = 50.0;
  const double time = id * kSetpoint;
  const double run_up = std::min(time, 1.0);
  const double way = kSpeed * (run_up * run_up / 2 + (time - run_up));
  const double speed = kSpeed * run_up;
  const double angle = way / kRadius;
  hal::Segment segment{.id = id, .duration = kSetpoint};
  const double side = kRadius / std::numbers::sqrt2;
  segment.position.values = {kRadius * std::sin(angle), side * (1 - std::cos(angle)),
                             side * (std::cos(angle) - 1)};
  const double turn = speed / std::numbers::sqrt2;
  segment.velocity.values = {speed * std::cos(angle), turn * std::sin(angle),
                             -turn * std::sin(angle)};
  return segment;
}

/// Of one exchange and one segment, while the ring goes round.
void measure_trace(const hal::ControllerStatus& status) {
  constexpr int kRounds = 1'000'000;
  hal::trace::Ring ring;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kRounds; ++i) {
    ring.write(point_of_path(static_cast<std::uint32_t>(i)));
    ring.write(hal::trace::Exchange{0.002 * i, 0, 0, 0, status});
  }
  const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
  const auto copying = std::chrono::steady_clock::now();
  const std::size_t words = ring.copy().size();
  const std::chrono::duration<double, std::milli> copied =
      std::chrono::steady_clock::now() - copying;
  std::printf("trace: %.0f ns for an exchange and a segment; %.1f MB copied in %.1f ms\n",
              spent.count() / kRounds, 8e-6 * static_cast<double>(words), copied.count());
}

}  // namespace

int main() {
  const auto controller =
      hal::sim::make_virtual_controller(three_axis_machine(), {.machine = {.start = Position{}}});
  if (!controller->connect()) return EXIT_FAILURE;
  controller->set_outputs({.drives_enabled = true});

  const auto begin = std::chrono::steady_clock::now();
  std::uint32_t id = 0;
  double now = 0.0;
  const hal::ControllerStatus* status = &controller->exchange(now);
  while (now < kSeconds && status->faults == 0) {
    while (id * kSetpoint < now + kFifoTime) {
      const hal::Segment next = point_of_path(++id);
      controller->push({&next, 1});
    }
    status = &controller->exchange(now);
    now += kCycle;
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;

  std::uint64_t lost = 0;
  for (const Axis axis : kLinearAxes) lost += controller->machine().lost_steps(axis);
  std::printf(
      "virtual machine: %.0f s of motion in %.3f s, %.0f times real time, faults %u, "
      "lost steps %llu\n",
      now, spent.count(), now / spent.count(), unsigned{status->faults},
      static_cast<unsigned long long>(lost));
  measure_trace(*status);
  return status->faults == 0 && lost == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
