// The home latch catches the count of the very step at which the switch changes.
#include <catch2/catch.hpp>

#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

constexpr std::int64_t kSwitchStep = 1234;

/// X closes its switch at kSwitchStep and beyond.
struct SwitchOnX {
  SwitchOnX() {
    board.keep_pulses = true;
    board.read_inputs = [this] {
      return Inputs{.home = board.counts[0] >= kSwitchStep ? axis_bit(0) : std::uint8_t{0}};
    };
    core.set_up(kFastBoard);
  }

  /// From standstill to `end_step` and to a stop, at `frequency` in between.
  void travel(double end_step, double frequency) {
    const auto from = static_cast<double>(core.status().counts[0]);
    const double sign = end_step < from ? -1.0 : 1.0;
    const double ramp = 0.05;  // s; makes frequency * ramp / 2 steps
    const double ramp_steps = sign * frequency * ramp / 2;
    const double even_time = ((end_step - from) - 2 * ramp_steps) * sign / frequency;
    REQUIRE(even_time > 0);
    const int pieces = static_cast<int>(even_time / 0.1) + 1;
    push(ramp, from + ramp_steps, sign * frequency);
    for (int i = 1; i <= pieces; ++i) {
      const double part = static_cast<double>(i) / pieces;
      push(even_time / pieces, from + ramp_steps + part * (end_step - from - 2 * ramp_steps),
           sign * frequency);
    }
    push(ramp, end_step, 0.0);
    core.advance(core.status().queued_time);
    REQUIRE(core.status().faults == 0);
    REQUIRE(core.status().counts[0] == std::llround(end_step));
  }

  void push(double seconds, double end_step, double end_frequency) {
    Segment segment = x_segment(++id, seconds, end_step, end_frequency);
    segment.position[1] = segment.position[0] / 3;  // Y goes along and must not disturb
    segment.velocity[1] = segment.velocity[0] / 3;
    if (core.status().fifo_free == 0) core.advance(core.status().queued_time / 2);
    REQUIRE(core.push(segment));
  }

  /// When X made the step that took it to `count` the last time.
  [[nodiscard]] Ticks last_step_to(std::int64_t count) const {
    std::int64_t at = 0;
    Ticks when = -1;
    for (const Pulse& pulse : board.pulses) {
      if (pulse.axis != 0) continue;
      at += pulse.direction;
      if (at == count) when = pulse.when;
    }
    return when;
  }

  WatchedBoard board;
  Core core{board};
  std::uint32_t id = 0;
};

}  // namespace

TEST_CASE("A latch catches the switching step and its tick at any speed", "[hal][LNK-6][HOM-2]") {
  const double frequency = GENERATE(500.0, 20'000.0, 399'000.0);
  SwitchOnX machine;
  machine.core.arm_latch(0, Edge::activate);
  machine.travel(40'000, frequency);
  const HomeLatch there = machine.core.status().home_latch[0];
  CHECK(there.caught);
  CHECK_FALSE(there.armed);
  CHECK(there.count == kSwitchStep);
  CHECK(there.time == machine.last_step_to(kSwitchStep));

  machine.core.arm_latch(0, Edge::release);
  CHECK_FALSE(machine.core.status().home_latch[0].caught);
  machine.travel(-30'000, frequency);
  const HomeLatch back = machine.core.status().home_latch[0];
  CHECK(back.caught);
  CHECK(back.count == kSwitchStep - 1);  // the first step at which the switch is open again
  CHECK(back.time == machine.last_step_to(kSwitchStep - 1));
}

TEST_CASE("A latch ignores the edge that it was not armed for", "[hal][LNK-6]") {
  SwitchOnX machine;
  machine.core.arm_latch(0, Edge::release);
  machine.travel(2000, 5000);
  CHECK_FALSE(machine.core.status().home_latch[0].caught);
  CHECK(machine.core.status().home_latch[0].armed);
}

TEST_CASE("A switch that is on already is no edge", "[hal][LNK-6]") {
  SwitchOnX machine;
  machine.travel(2000, 5000);
  machine.core.arm_latch(0, Edge::activate);
  machine.travel(3000, 5000);
  CHECK_FALSE(machine.core.status().home_latch[0].caught);
}

TEST_CASE("A disarmed latch catches nothing", "[hal][LNK-6]") {
  SwitchOnX machine;
  machine.core.arm_latch(0, Edge::activate);
  machine.core.disarm_latch(0);
  machine.travel(2000, 5000);
  CHECK_FALSE(machine.core.status().home_latch[0].caught);
}

TEST_CASE("A switch pressed by hand while the axis stands still is caught too", "[hal][LNK-6]") {
  WatchedBoard board;
  bool pressed = false;
  board.read_inputs = [&] { return Inputs{.home = pressed ? axis_bit(4) : std::uint8_t{0}}; };
  Core core(board);
  core.set_up(kFastBoard);
  core.arm_latch(4, Edge::activate);
  core.advance(ticks(1.0));
  CHECK_FALSE(core.status().home_latch[4].caught);
  pressed = true;
  core.advance(ticks(0.001));
  CHECK(core.status().home_latch[4].caught);
  CHECK(core.status().home_latch[4].time > ticks(1.0));
  CHECK(core.status().home_latch[4].time <= ticks(1.001));
  CHECK(core.status().home_latch[4].count == 0);
}
