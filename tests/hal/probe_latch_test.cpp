// The probe latch catches all axes at the very step of the touch, and the board stops by itself.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/hal/firmware_support.h"
#include "tests/hal/machine_support.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr std::int64_t kTouchStep = -12'340;

/// Z probes downwards and touches at kTouchStep; X goes along, half as far.
struct ProbeOnZ {
  ProbeOnZ() {
    board.keep_pulses = true;
    board.read_inputs = [this] {
      return Inputs{.probe = pressed || board.counts[2] <= kTouchStep};
    };
    Setup setup = kFastBoard;
    setup.max_acceleration.fill(std::llround(std::ldexp(2e6 / 1e14, kAccelerationBits)));
    REQUIRE(core.set_up(setup));
  }

  /// From standstill to 20000 steps down at `frequency` (ramps of 0.2 s), as far as the board lets
  /// it.
  void probe_down(double frequency) {
    const double ramp_way = frequency * 0.2 / 2;
    const double even_time = (20'000 - 2 * ramp_way) / frequency;
    push(0.1, -ramp_way / 4, -frequency / 2);
    push(0.1, -ramp_way, -frequency);
    const int pieces = static_cast<int>(even_time / 0.1) + 1;
    for (int i = 1; i <= pieces; ++i) {
      push(even_time / pieces, -ramp_way - (20'000 - 2 * ramp_way) * i / pieces, -frequency);
    }
    push(0.1, -20'000 + ramp_way / 4, -frequency / 2);
    push(0.1, -20'000, 0);
    while (core.status().moving) core.advance(ticks(0.01));
  }

  void push(double seconds, double end_step, double end_frequency) {
    Segment segment{.id = ++id, .duration = static_cast<std::uint32_t>(ticks(seconds))};
    segment.position[2] = steps(end_step);
    segment.velocity[2] = steps_per_second(end_frequency);
    segment.position[0] = segment.position[2] / 2;
    segment.velocity[0] = segment.velocity[2] / 2;
    if (core.status().fifo_free == 0) core.advance(core.status().queued_time / 2);
    REQUIRE((core.push(segment) || core.status().path_stop != PathStop::none));
  }

  WatchedBoard board;
  bool pressed = false;
  Core core{board};
  std::uint32_t id = 0;
};

}  // namespace

TEST_CASE("The probe latch catches every axis at the touching step and its tick, at any speed",
          "[hal][LNK-6][GCO-2]") {
  const double frequency = GENERATE(500.0, 20'000.0, 80'000.0);
  ProbeOnZ machine;
  machine.core.arm_probe();
  machine.probe_down(frequency);
  const Status status = machine.core.status();
  CHECK(status.probe_latch.caught);
  CHECK_FALSE(status.probe_latch.armed);
  CHECK_FALSE(status.probe_latch.active_at_arming);
  CHECK(status.probe_latch.counts[2] == kTouchStep);
  CHECK(status.probe_latch.counts[0] == kTouchStep / 2);
  CHECK(status.probe_latch.counts[1] == 0);
  const auto touch = std::ranges::find_if(machine.board.pulses, [z = 0](const Pulse& p) mutable {
    return p.axis == 2 && (z += p.direction) == kTouchStep;
  });
  REQUIRE(touch != machine.board.pulses.end());
  CHECK(status.probe_latch.time == touch->when);

  CHECK(status.path_stop == PathStop::stopped);
  CHECK(status.faults == 0);
  CHECK(status.fifo_count == 0);
  // v^2 / 2a of overshoot, the rest of the slice (100 us) in which it touched, the two slices
  // that were planned already, and what the last slice makes more than it should.
  const auto overshoot = static_cast<double>(kTouchStep - status.counts[2]);
  CHECK(overshoot <= frequency * frequency / (2 * 2e6) + 4 * frequency * 1e-4 + 1);
}

TEST_CASE("A probe that nobody armed, or that was disarmed, stops nothing", "[hal][LNK-6]") {
  ProbeOnZ machine;
  if (GENERATE(false, true)) {
    machine.core.arm_probe();
    machine.core.disarm_probe();
  }
  machine.probe_down(20'000);
  CHECK_FALSE(machine.core.status().probe_latch.caught);
  CHECK(machine.core.status().path_stop == PathStop::none);
  CHECK(machine.core.status().counts[2] == -20'000);
}

TEST_CASE("A probe that touches when it is armed is reported, and no probing move starts",
          "[hal][LNK-6][GCO-2]") {
  ProbeOnZ machine;
  machine.pressed = true;
  machine.core.arm_probe();
  CHECK(machine.core.status().probe_latch.active_at_arming);
  CHECK_FALSE(machine.core.status().probe_latch.armed);
  CHECK_FALSE(machine.core.status().probe_latch.caught);
  CHECK(machine.core.status().path_stop == PathStop::stopped);
  machine.probe_down(20'000);
  CHECK(machine.board.pulse_count == 0);
  CHECK_FALSE(machine.core.status().probe_latch.caught);

  machine.pressed = false;
  machine.core.release_stop();
  machine.core.arm_probe();
  CHECK(machine.core.status().probe_latch.armed);
  CHECK_FALSE(machine.core.status().probe_latch.active_at_arming);
}

TEST_CASE("A latch catches once: the second touch of the same arming changes nothing",
          "[hal][LNK-6]") {
  ProbeOnZ machine;
  machine.core.arm_probe();
  machine.pressed = true;
  machine.core.advance(1);
  REQUIRE(machine.core.status().probe_latch.caught);
  CHECK(machine.core.status().probe_latch.counts[2] == 0);
  machine.pressed = false;
  machine.core.advance(1);
  machine.core.release_stop();
  machine.probe_down(20'000);
  CHECK(machine.core.status().probe_latch.counts[2] == 0);
  CHECK(machine.core.status().counts[2] == -20'000);
}

}  // namespace cnc::hal::cpu5::firmware
