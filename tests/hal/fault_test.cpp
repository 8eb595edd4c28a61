// What the board does by itself when something is wrong, and what it refuses.
#include <catch2/catch.hpp>
#include <limits>

#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

constexpr Outputs kEverythingOn{.drives_enabled = true,
                                .spindle_on = true,
                                .tool_direction = true,
                                .spindle_pwm = Outputs::kFullPwm,
                                .mist = true,
                                .flood = true};

struct Rig {
  explicit Rig(const Setup& setup = kFastBoard) {
    board.read_inputs = [this] { return Inputs{.estop1 = estop_when && estop_when()}; };
    REQUIRE(core.set_up(setup));
    REQUIRE(core.set_outputs(kEverythingOn));
  }

  /// Ten milliseconds of run-up to 10 kHz, then ten at that speed: 50 and 100 steps.
  void push_run() {
    REQUIRE(core.push(x_segment(1, 0.010, 50, 10'000)));
    REQUIRE(core.push(x_segment(2, 0.010, 150, 10'000)));
  }

  /// And 90 ms more at that speed: 900 steps.
  void push_long_run() {
    push_run();
    for (std::uint32_t i = 3; i < 12; ++i)
      REQUIRE(core.push(x_segment(i, 0.010, 100.0 * i - 50.0, 10'000)));
  }

  WatchedBoard board;
  std::function<bool()> estop_when;
  Core core{board};
};

/// After 5 ms of silence, from 10 kHz within 10 ms, where the way is as long as it takes: 50 steps.
Setup braking_setup() {
  Setup setup = kFastBoard;
  setup.host_timeout = ticks(0.005);
  setup.max_acceleration.fill(std::llround(std::ldexp(1e6 / 1e14, kAccelerationBits)));
  return setup;
}

}  // namespace

TEST_CASE("A FIFO that runs dry while moving is an underrun", "[hal][LNK-2]") {
  Rig rig;
  rig.push_run();
  rig.core.advance(ticks(0.0199));
  CHECK(rig.core.status().faults == 0);
  rig.core.advance(ticks(0.0001));
  CHECK(rig.core.status().faults == kFifoUnderrun);
  CHECK(rig.core.status().counts[0] == 150);
  CHECK_FALSE(rig.core.status().moving);
  rig.core.advance(ticks(1.0));
  CHECK(rig.core.status().counts[0] == 150);
}

TEST_CASE("A FIFO that runs dry at a standstill is no underrun", "[hal][LNK-2]") {
  Rig rig;
  rig.push_run();
  rig.core.push(x_segment(3, 0.010, 200));
  rig.core.advance(ticks(1.0));
  CHECK(rig.core.status().faults == 0);
  CHECK(rig.core.status().counts[0] == 200);
  CHECK(rig.board.last_outputs == kEverythingOn);

  REQUIRE(rig.core.push(x_segment(4, 0.010, 210)));  // and goes on from there
  rig.core.advance(ticks(0.010));
  CHECK(rig.core.status().counts[0] == 210);
}

TEST_CASE("An estop input stops the pulses within one slice and makes the outputs safe",
          "[hal][STA-4]") {
  Rig rig;
  rig.push_run();
  bool pressed = false;
  rig.estop_when = [&] { return pressed; };
  rig.core.advance(ticks(0.012));
  const auto count = rig.core.status().counts[0];
  CHECK(count == 70);
  pressed = true;
  rig.core.advance(ticks(0.005));
  CHECK(rig.core.status().counts[0] - count <= 1);  // one slice at 10 kHz
  CHECK(rig.core.status().faults == kEstop);
  CHECK(rig.core.status().fifo_count == 0);
  CHECK(rig.core.status().queued_time == 0);
  CHECK(rig.board.last_outputs == Outputs{});
  CHECK(rig.core.status().outputs == Outputs{});
}

TEST_CASE("An estop that an armed axis runs into stops it on that very step",
          "[hal][STA-4][LNK-6]") {
  // 399 kHz: forty steps to a slice, so stopping at the slice's end would be seen.
  Rig rig;
  rig.estop_when = [&] { return rig.board.counts[0] >= 10'001; };
  rig.core.arm_latch(0, Edge::activate);
  REQUIRE(rig.core.push(x_segment(1, 0.050, 399'000 * 0.025, 399'000)));
  REQUIRE(rig.core.push(x_segment(2, 0.050, 399'000 * 0.075, 399'000)));
  rig.core.advance(ticks(0.1));
  CHECK(rig.core.status().faults == kEstop);
  CHECK(rig.core.status().counts[0] == 10'001);
}

TEST_CASE("Faults stay until cleared, and an estop until it is released", "[hal][STA-2]") {
  Rig rig;
  bool pressed = true;
  rig.estop_when = [&] { return pressed; };
  rig.core.advance(1);
  REQUIRE(rig.core.status().faults == kEstop);
  CHECK_FALSE(rig.core.push(x_segment(1, 0.010, 10)));
  CHECK_FALSE(rig.core.set_outputs(kEverythingOn));

  rig.core.clear_faults();
  CHECK(rig.core.status().faults == kEstop);
  pressed = false;
  rig.core.advance(ticks(0.1));
  CHECK(rig.core.status().faults == kEstop);
  rig.core.clear_faults();
  CHECK(rig.core.status().faults == 0);
  CHECK(rig.board.last_outputs == Outputs{});  // nothing comes back on by itself
  CHECK(rig.core.push(x_segment(17, 0.010, 10)));
}

TEST_CASE("Drives stay on after a fault when the setup says so, the spindle does not",
          "[hal][STA-4]") {
  Setup setup = kFastBoard;
  setup.drives_off_on_fault = false;
  Rig rig(setup);
  rig.push_run();
  rig.core.advance(ticks(0.1));
  REQUIRE(rig.core.status().faults == kFifoUnderrun);
  CHECK(rig.board.last_outputs == Outputs{.drives_enabled = true});
}

TEST_CASE("A bad segment is a fault and is not executed", "[hal][LNK-2][LNK-3]") {
  constexpr std::int64_t kHuge = std::numeric_limits<std::int64_t>::max();
  struct Case {
    const char* why;
    Segment segment;
  };
  Segment far_z = x_segment(2, 0.010, 100);
  far_z.position[2] = -kHuge - 1;
  Segment fast_c = x_segment(2, 0.010, 100);
  fast_c.velocity[5] = -kHuge - 1;
  Segment no_time = x_segment(2, 0.010, 100);
  no_time.duration = 0;
  Segment too_long = x_segment(2, 0.010, 100);
  too_long.duration = kMaxSegmentTicks + 1;
  const Case bad = GENERATE_COPY(values<Case>({
      {"an id left out", x_segment(3, 0.010, 100)},
      {"an id again", x_segment(1, 0.010, 100)},
      {"id 0", x_segment(0, 0.010, 100)},
      {"no duration", no_time},
      {"a duration too long", too_long},
      {"a position out of range", far_z},
      {"a velocity out of range", fast_c},
      {"an end velocity above the limit", x_segment(2, 0.010, 2050, 401'000)},
      {"a mean speed above the limit", x_segment(2, 0.010, 4100, 399'000)},
      // From 10 kHz to rest over 2700 steps in 10 ms: the middle runs at 1.5 * 270 kHz - 2.5 kHz.
      {"a speed above the limit between two slow ends", x_segment(2, 0.010, 2750)},
  }));
  INFO(bad.why);
  Rig rig;
  REQUIRE(rig.core.push(x_segment(1, 0.010, 50, 10'000)));
  CHECK_FALSE(rig.core.push(bad.segment));
  CHECK(rig.core.status().faults == kBadSegment);
  rig.core.advance(ticks(1.0));
  CHECK(rig.board.pulse_count == 0);
  CHECK(rig.board.last_outputs == Outputs{});
}

TEST_CASE("A segment just below the step frequency limit is executed", "[hal][LNK-3]") {
  Rig rig;
  // 2600 steps in 10 ms from 10 kHz to rest: the middle runs at 1.5 * 260 kHz - 2.5 kHz = 387.5
  // kHz.
  REQUIRE(rig.core.push(x_segment(1, 0.010, 50, 10'000)));
  REQUIRE(rig.core.push(x_segment(2, 0.010, 2650)));
  rig.core.advance(ticks(0.02));
  CHECK(rig.core.status().counts[0] == 2650);
}

TEST_CASE("A board that was not set up executes nothing", "[hal][LNK-3]") {
  WatchedBoard board;
  Core core(board);
  CHECK_FALSE(core.push(x_segment(1, 0.010, 1)));
  CHECK(core.status().faults == kBadSegment);
}

TEST_CASE("A setup out of range or while moving is refused", "[hal][LNK-3]") {
  Rig rig;
  CHECK_FALSE(rig.core.set_up({.max_velocity = 0}));
  CHECK_FALSE(rig.core.set_up({.max_velocity = kTopVelocity + 1}));
  CHECK_FALSE(rig.core.set_up({.max_velocity = kTopVelocity, .host_timeout = -1}));
  rig.push_run();
  CHECK_FALSE(rig.core.set_up(kFastBoard));
}

TEST_CASE("Segment numbers skip 0 when they wrap", "[hal]") {
  Rig rig;
  REQUIRE(rig.core.push(x_segment(std::numeric_limits<std::uint32_t>::max(), 0.010, 10)));
  CHECK(rig.core.push(x_segment(1, 0.010, 20)));
}

TEST_CASE("A full FIFO takes no more, without a fault, until a segment has been started",
          "[hal][LNK-2]") {
  Rig rig;
  for (std::uint32_t id = 1; id <= kFifoCapacity; ++id) {
    REQUIRE(rig.core.push(x_segment(id, 0.010, id)));
  }
  CHECK(rig.core.status().fifo_free == 0);
  CHECK_FALSE(rig.core.push(x_segment(kFifoCapacity + 1, 0.010, kFifoCapacity + 1)));
  CHECK(rig.core.status().faults == 0);
  rig.core.advance(ticks(0.005));
  CHECK(rig.core.push(x_segment(kFifoCapacity + 1, 0.010, kFifoCapacity + 1)));
  rig.core.advance(ticks(0.010 * (kFifoCapacity + 1)));
  CHECK(rig.core.status().counts[0] == kFifoCapacity + 1);
  CHECK(rig.core.status().faults == 0);
}

TEST_CASE("A quick stop drops what is queued, and motion goes on from where it stopped", "[hal]") {
  Rig rig;
  rig.push_run();
  rig.core.advance(ticks(0.012));
  rig.core.quick_stop();
  CHECK(rig.core.status().counts[0] == 70);
  CHECK(rig.core.status().fifo_count == 0);
  CHECK_FALSE(rig.core.status().moving);
  CHECK(rig.core.status().faults == 0);
  CHECK(rig.board.last_outputs == kEverythingOn);
  rig.core.advance(ticks(1.0));
  CHECK(rig.core.status().counts[0] == 70);

  REQUIRE(rig.core.push(x_segment(900, 0.010, 60)));
  rig.core.advance(ticks(0.010));
  CHECK(rig.core.status().counts[0] == 60);
}

TEST_CASE("A silent host: the board brakes along the path, then the link counts as lost",
          "[hal][LNK-4]") {
  Rig rig(braking_setup());
  rig.core.host_alive();
  rig.push_long_run();
  for (int i = 0; i < 3; ++i) {
    rig.core.advance(ticks(0.004));
    rig.core.host_alive();
  }
  rig.core.advance(ticks(0.014));
  CHECK(rig.core.status().faults == 0);
  CHECK(rig.core.status().path_stop == PathStop::stopping);
  CHECK(rig.board.last_outputs == kEverythingOn);
  rig.core.advance(ticks(0.003));
  CHECK(rig.core.status().faults == kLinkLost);
  // Heard at 12 ms, at step 70; lost at 17 ms and 120; planned ahead by up to 0.3 ms.
  CHECK(static_cast<double>(rig.core.status().counts[0]) == Approx(120 + 50).margin(4));
  CHECK(rig.board.last_outputs == Outputs{});
}

TEST_CASE("A host that is heard again while the board brakes finds a fault, and the outputs off",
          "[hal][LNK-4][safety]") {
  Rig rig(braking_setup());
  rig.core.host_alive();
  rig.push_long_run();
  rig.core.advance(ticks(0.006));
  REQUIRE(rig.core.status().path_stop == PathStop::stopping);
  for (int i = 0; i < 20; ++i) {
    rig.core.host_alive();
    rig.core.advance(ticks(0.001));
  }
  CHECK(rig.core.status().faults == kLinkLost);
  CHECK(rig.board.last_outputs == Outputs{});
  rig.core.clear_faults();
  rig.core.host_alive();
  rig.core.advance(ticks(0.004));
  CHECK(rig.core.status().faults == 0);
}

TEST_CASE("A host that goes while the machine moves stops it; one that goes later leaves it safe",
          "[hal][LNK-4]") {
  Rig rig;
  rig.core.host_alive();
  rig.push_run();
  REQUIRE(rig.core.push(x_segment(3, 0.010, 200)));
  rig.core.advance(ticks(0.015));
  rig.core.host_left();
  rig.core.advance(ticks(0.020));
  CHECK(rig.core.status().faults == kLinkLost);
  CHECK(rig.board.last_outputs == Outputs{});

  rig.core.clear_faults();
  REQUIRE(rig.core.set_outputs(kEverythingOn));
  rig.core.host_left();
  CHECK(rig.board.last_outputs == Outputs{});
  rig.core.advance(ticks(1.0));
  CHECK(rig.core.status().faults == 0);
}

TEST_CASE("A drive that begins to raise its alarm is a fault once", "[hal][LNK-4]") {
  Rig rig;
  std::uint8_t alarm = 0;
  rig.board.read_inputs = [&] { return Inputs{.alarm = alarm}; };
  rig.push_run();
  rig.core.advance(ticks(0.012));
  alarm = axis_bit(0);
  rig.core.advance(ticks(0.001));
  CHECK(rig.core.status().faults == kStepLoss);
  CHECK(rig.core.status().inputs.alarm == axis_bit(0));
  CHECK_FALSE(rig.core.status().moving);
  // It lasts, and may be cleared.
  rig.core.clear_faults();
  rig.core.advance(ticks(0.1));
  CHECK(rig.core.status().faults == 0);
  alarm |= axis_bit(2);
  rig.core.advance(ticks(0.001));
  CHECK(rig.core.status().faults == kStepLoss);
}

TEST_CASE("Whose drive raised the alarm is known although the fault switches it off",
          "[hal][LNK-4][safety]") {
  Rig rig;
  std::uint8_t alarm = 0;
  rig.board.read_inputs = [&] { return Inputs{.alarm = alarm}; };
  rig.push_run();
  rig.core.advance(ticks(0.012));
  alarm = axis_bit(1);
  rig.core.advance(ticks(0.001));
  alarm = 0;
  rig.core.advance(ticks(0.1));
  CHECK(rig.core.status().faults == kStepLoss);
  CHECK(rig.core.status().inputs.alarm == axis_bit(1));
  rig.core.clear_faults();
  CHECK(rig.core.status().inputs.alarm == 0);
}

TEST_CASE("A host that speaks in time keeps the link, moving or not", "[hal][LNK-4]") {
  Setup setup = kFastBoard;
  setup.host_timeout = ticks(0.005);
  Rig rig(setup);
  for (int i = 0; i < 100; ++i) {
    rig.core.host_alive();
    rig.core.advance(ticks(0.005));
  }
  CHECK(rig.core.status().faults == 0);
  rig.core.advance(1);
  CHECK(rig.core.status().faults == kLinkLost);
}
