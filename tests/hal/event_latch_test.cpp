// The latches that are always armed: spindle index and estop, with all step counts and the time.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/hal/firmware_support.h"
#include "tests/hal/machine_support.h"

namespace cnc::hal::cpu5::firmware {
namespace {

/// Axes that start and stop at their speed, which a board does not mind. X goes up, B down, more
/// slowly, for ever.
class Rig {
 public:
  Rig() {
    board.keep_pulses = true;
    board.read_inputs = [this] {
      Inputs inputs;
      inputs.estop1 = estop_from <= board.now && board.now < estop_until;
      while (next_pulse + capture_delay <= board.now) {
        last_pulse = next_pulse;
        next_pulse += kRevolution;
        ++pulses;
      }
      inputs.index_count = pulses;
      inputs.index_time = last_pulse;
      return inputs;
    };
    REQUIRE(core.set_up(kFastBoard));
  }

  /// In steps of the host's that have nothing to do with slices.
  void run(double seconds) {
    for (const Ticks end = core.time() + ticks(seconds); core.time() < end; core.advance(777)) {
      while (core.status().faults == 0 && core.status().fifo_free > 0) push();
    }
  }
  void push() {
    constexpr double kPiece = 0.0123;
    start += kFrequency * kPiece;
    Segment segment = x_segment(++id, kPiece, start, kFrequency);
    segment.position[4] = -segment.position[0] / 7;
    segment.velocity[4] = -segment.velocity[0] / 7;
    if (id == 1) segment.velocity[0] = segment.velocity[4] = 0;  // rest to rest: 1.5 times as fast
    REQUIRE(core.push(segment));
  }

  /// Where the axes stand.
  void begin_anew() {
    id = 0;
    start = static_cast<double>(core.status().counts[0]);
  }

  /// What the pins had made of each axis by `moment`.
  [[nodiscard]] PerAxis<std::int64_t> made_by(Ticks moment) const {
    PerAxis<std::int64_t> counts{};
    for (const Pulse& pulse : board.pulses)
      if (pulse.when <= moment) counts[pulse.axis] += pulse.direction;
    return counts;
  }

  static constexpr double kFrequency = 199'000;
  static constexpr Ticks kNever = Ticks{1} << 60;
  static constexpr Ticks kRevolution = 123'457;  // 4860 rpm

  WatchedBoard board;
  Ticks capture_delay = 0;  // from the pulse until the board can read it
  Ticks next_pulse = kNever;
  Ticks last_pulse = 0;
  std::uint32_t pulses = 0;
  Ticks estop_from = kNever;
  Ticks estop_until = kNever;
  Core core{board};
  std::uint32_t id = 0;
  double start = 0.0;
};

}  // namespace

TEST_CASE("The spindle's index has the step counts of its very tick, however late it is seen",
          "[hal][LNK-6]") {
  Rig rig;
  rig.capture_delay = GENERATE(0, 1, 999);
  rig.next_pulse = GENERATE(1'000'000, 1'000'501);
  for (std::uint32_t pulse = 1; pulse <= 40; ++pulse) {
    while (rig.core.status().inputs.index_count < pulse) rig.run(1e-4);
    const Status status = rig.core.status();
    REQUIRE(status.inputs.index_time == rig.last_pulse);
    REQUIRE(status.index_counts[0] != status.counts[0]);  // it has gone on
    REQUIRE(status.index_counts == rig.made_by(rig.last_pulse));
  }
}

TEST_CASE("An index pulse just before a quick stop has its step counts", "[hal][LNK-6]") {
  Rig rig;
  rig.run(0.2);
  const Ticks now = rig.core.time();
  rig.next_pulse = now + GENERATE(1, 300);
  rig.core.advance(301);
  rig.core.quick_stop();
  rig.core.advance(ticks(0.01));
  const Status status = rig.core.status();
  REQUIRE(status.inputs.index_count == 1);
  CHECK(status.index_counts == rig.made_by(rig.last_pulse));
}

TEST_CASE("A spindle whose pulses were counted before power-up has caught nothing",
          "[hal][LNK-6]") {
  WatchedBoard board;
  board.read_inputs = [] { return Inputs{.index_count = 7, .index_time = -123}; };
  Core core(board);
  core.advance(ticks(0.1));
  CHECK(core.status().index_counts == PerAxis<std::int64_t>{});
}

TEST_CASE("An estop is caught with its time where the pulses end", "[hal][LNK-6][safety]") {
  Rig rig;
  rig.run(0.2);
  rig.estop_from = rig.core.time() + GENERATE(1, 500, 1500);
  rig.run(0.05);
  const EstopLatch latch = rig.core.status().estop_latch;
  CHECK(latch.count == 1);
  CHECK(latch.time >= rig.estop_from);
  CHECK(latch.time < rig.estop_from + kSliceTicks);
  CHECK(latch.counts == rig.core.status().counts);
  CHECK(latch.counts == rig.made_by(latch.time));
  CHECK(rig.board.pulses.back().when <= latch.time);
}

TEST_CASE("Each press of the estop is caught once", "[hal][LNK-6][safety]") {
  Rig rig;
  rig.run(0.1);
  rig.estop_from = rig.core.time();
  rig.run(0.1);
  const EstopLatch first = rig.core.status().estop_latch;
  rig.core.clear_faults();  // it is still pressed
  rig.run(0.1);
  REQUIRE(rig.core.status().faults == kEstop);
  CHECK(rig.core.status().estop_latch.count == 1);
  CHECK(rig.core.status().estop_latch.time == first.time);

  rig.estop_until = rig.core.time();
  rig.run(0.1);
  rig.core.clear_faults();
  rig.begin_anew();
  REQUIRE(rig.core.status().faults == 0);
  CHECK(rig.core.status().estop_latch.time == first.time);  // kept
  rig.estop_from = rig.core.time();
  rig.estop_until = Rig::kNever;
  rig.run(0.1);
  CHECK(rig.core.status().estop_latch.count == 2);
  CHECK(rig.core.status().estop_latch.time >= rig.estop_from);
}

}  // namespace cnc::hal::cpu5::firmware

namespace cnc::hal::sim {

TEST_CASE("The latch of the estop stays what it was when the axis counts anew", "[hal][LNK-6]") {
  const auto controller = make_virtual_controller(small_machine(), {.driver = {.host_timeout = 0}});
  Hand hand(*controller);
  hand.move(Axis::X, 20.0);
  const double before = hand.status().time;
  controller->machine().press_estop(true);
  hand.wait(0.01);
  const EventLatch caught = hand.status().estop_latch;
  CHECK(caught.count == 1);
  CHECK(caught.position == hand.status().position);
  CHECK(caught.time > before);
  CHECK(caught.time <= hand.status().time);

  controller->machine().press_estop(false);
  controller->clear_faults();
  hand.wait(0.01);
  REQUIRE(controller->set_position(Axis::X, -7.0));
  hand.wait(500.0);  // longer than the wire can tell
  CHECK(hand.status().estop_latch.position == caught.position);
  CHECK(hand.status().estop_latch.time == caught.time);
}

TEST_CASE("A board that was reset has caught nothing", "[hal][LNK-6]") {
  const auto controller = make_virtual_controller(small_machine(), {.driver = {.host_timeout = 0}});
  Hand hand(*controller);
  controller->set_outputs({.drives_enabled = true, .spindle_on = true, .spindle_pwm = 1.0});
  hand.status();
  hand.wait(2.0);
  controller->machine().press_estop(true);
  hand.wait(0.01);
  controller->machine().press_estop(false);
  REQUIRE(hand.status().estop_latch.count == 1);
  CHECK(hand.status().index_latch.count > 100);
  CHECK(hand.status().index_latch.time > 1.99);
  controller->machine().set_index_missing(true);
  controller->board().reset();
  for (int i = 0; i < 1000 && (i < 10 || !hand.status().connected); ++i) hand.wait(0.002);
  REQUIRE(hand.status().counts_lost);
  CHECK(hand.status().estop_latch.count == 0);
}

}  // namespace cnc::hal::sim
