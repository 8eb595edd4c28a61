// The edges on the drives' pins.
#include "hal/cpu5/firmware/pulse_shaper.h"

#include <catch2/catch.hpp>
#include <random>

#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

/// Watches one axis of a shaper's pins like an oscilloscope, and a drive that follows them.
class Scope {
 public:
  explicit Scope(const Setup& setup, std::size_t axis = 0) : setup_(setup), axis_(axis) {
    REQUIRE(pulses_possible(setup));
    shaper.set_up(setup);
    look(0);
  }

  void add(int direction, Ticks when) {
    play_until(when);
    REQUIRE(shaper.add_step(axis_, direction, when));
  }
  /// `lateness` of each interrupt, ticks.
  void play_until(Ticks end) {
    while (shaper.next_edge() < end) look(std::max(now_, shaper.next_edge() + lateness()));
  }

  PulseShaper shaper;
  std::function<Ticks()> lateness = [] { return Ticks{0}; };
  std::vector<Ticks> rises;
  std::int64_t count = 0;
  Ticks shortest_pulse = 1 << 30;
  Ticks shortest_pause = 1 << 30;
  Ticks shortest_setup = 1 << 30;
  Ticks shortest_hold = 1 << 30;

 private:
  void look(Ticks now) {
    now_ = now;
    const PulseShaper::Pins pins = shaper.make_edges(now);
    const bool step = (((pins.step ^ setup_.step_inverted) >> axis_) & 1) != 0;
    const bool up = (((pins.direction ^ setup_.direction_inverted) >> axis_) & 1) != 0;
    if (up != up_) {
      shortest_hold = std::min(shortest_hold, now - rise_);
      turn_ = now;
    }
    if (step && !step_) {
      shortest_pause = std::min(shortest_pause, now - fall_);
      shortest_setup = std::min(shortest_setup, now - turn_);
      rises.push_back(now);
      rise_ = now;
      count += up ? 1 : -1;
    }
    if (!step && step_) {
      shortest_pulse = std::min(shortest_pulse, now - rise_);
      fall_ = now;
    }
    step_ = step;
    up_ = up;
  }

  Setup setup_;
  std::size_t axis_;
  Ticks now_ = 0;
  bool step_ = false;
  bool up_ = false;
  Ticks rise_ = -1 << 30;
  Ticks fall_ = -1 << 30;
  Ticks turn_ = -1 << 30;
};

/// 400 kHz: a period of 25 ticks.
Setup drives(int width, int setup_time, int hold) {
  Setup setup = kFastBoard;
  setup.pulse_width = static_cast<std::uint16_t>(width);
  setup.direction_setup = static_cast<std::uint16_t>(setup_time);
  setup.direction_hold = static_cast<std::uint16_t>(hold);
  return setup;
}

}  // namespace

TEST_CASE("Pulses have their width and pause at every frequency, and leave at an even distance",
          "[hal][LNK-3]") {
  const Ticks period = GENERATE(as<Ticks>{}, 25, 26, 40, 100, 1'000, 10'000'000);
  const int setup_time = GENERATE(0, 50, 400);
  Scope scope(drives(12, setup_time, 50));
  for (int i = 1; i <= 200; ++i) scope.add(1, i * period);
  scope.play_until(1000 * period);
  REQUIRE(scope.rises.size() == 200);
  // Upwards is not how the direction pin starts: the first pulse, too, has its set-up time.
  for (int i = 1; i <= 200; ++i) {
    CHECK(scope.rises[static_cast<std::size_t>(i) - 1] == i * period + setup_time);
  }
  CHECK(scope.shortest_pulse == 12);
  CHECK(scope.shortest_pause == period - 12);
  CHECK(scope.shortest_setup == setup_time);
}

TEST_CASE("At a reversal the direction holds after the last pulse and stands before the next",
          "[hal][LNK-3]") {
  // Ticks from the last step upwards to the first one downwards; hold 30, set-up 50.
  struct Row {
    Ticks between;
    Ticks pulse_after_pulse;
  };
  const Row row =
      GENERATE(values<Row>({{1, 80}, {40, 80}, {79, 80}, {80, 80}, {81, 81}, {5000, 5000}}));
  INFO(row.between);
  Scope scope(drives(10, 50, 30));
  for (int i = 1; i <= 10; ++i) scope.add(1, 100 * i);
  for (int i = 0; i < 10; ++i) scope.add(-1, 1000 + row.between + 100 * i);
  scope.play_until(100'000);
  REQUIRE(scope.rises.size() == 20);
  CHECK(scope.count == 0);
  CHECK(scope.rises[10] - scope.rises[9] == row.pulse_after_pulse);
  CHECK(scope.rises[19] == 1900 + row.between + 50);  // the delay is made up for
  CHECK(scope.shortest_setup >= 50);
  CHECK(scope.shortest_hold >= 30);
  CHECK(scope.shortest_pulse >= 10);
  CHECK(scope.shortest_pause >= 10);
}

TEST_CASE("Interrupts that come late shorten nothing and lose no pulse", "[hal][LNK-3]") {
  std::mt19937 random(3);
  Scope scope(drives(10, 20, 30));
  scope.lateness = [&] { return static_cast<Ticks>(random() % 8); };
  Ticks when = 0;
  std::int64_t count = 0;
  for (int i = 0; i < 20'000; ++i) {
    const int direction = i / 37 % 3 == 0 ? -1 : 1;
    const bool turns = i % 37 == 0;
    when += turns ? 200 : 40 + static_cast<Ticks>(random() % 100);
    scope.add(direction, when);
    count += direction;
  }
  scope.play_until(when + 10'000);
  CHECK(scope.rises.size() == 20'000);
  CHECK(scope.count == count);
  CHECK(scope.shortest_pulse >= 10);
  CHECK(scope.shortest_pause >= 10);
  CHECK(scope.shortest_setup >= 20);
  CHECK(scope.shortest_hold >= 30);
}

TEST_CASE("Polarity is the pin's own: inverted axes rest high and pulse low", "[hal][LNK-3]") {
  Setup setup = drives(10, 0, 0);
  setup.step_inverted = 0b000010;
  setup.direction_inverted = 0b000100;
  PulseShaper shaper;
  shaper.set_up(setup);
  CHECK(shaper.make_edges(0) == PulseShaper::Pins{.step = 0b000010, .direction = 0b000100});
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) REQUIRE(shaper.add_step(axis, 1, 100));
  CHECK(shaper.next_edge() == 100);
  CHECK(shaper.make_edges(100).direction == 0b111011);
  CHECK(shaper.make_edges(100).step == 0b111101);
  shaper.set_up(setup);  // in the middle of a pulse
  CHECK(shaper.make_edges(109) == PulseShaper::Pins{.step = 0b111101, .direction = 0b111011});
  CHECK(shaper.next_edge() == 110);
  CHECK(shaper.make_edges(110).step == 0b000010);
  CHECK(shaper.next_edge() == PulseShaper::kNever);
}

TEST_CASE("Axes do not hold each other up", "[hal][LNK-3]") {
  Scope scope(drives(10, 50, 30), 4);
  for (int i = 1; i <= 50; ++i) {
    scope.add(1, 1000 * i);
    // X turns round at each step, 5 ticks away.
    REQUIRE(scope.shaper.add_step(0, i % 2 == 0 ? 1 : -1, 1000 * i));
  }
  scope.play_until(100'000);
  REQUIRE(scope.rises.size() == 50);
  for (std::size_t i = 0; i < 50; ++i) {
    CHECK(scope.rises[i] == static_cast<Ticks>(1000 * (i + 1) + 50));
  }
}

TEST_CASE("A path that turns round at full speed without end is noticed before a step is lost",
          "[hal][LNK-3][safety]") {
  PulseShaper shaper;
  shaper.set_up(drives(10, 400, 400));
  int waiting = 0;
  while (shaper.add_step(0, waiting % 2 == 0 ? 1 : -1, 25 * waiting)) ++waiting;
  CHECK(waiting == 64);
}

TEST_CASE("Pulses that the highest step frequency leaves no time for are refused at set-up",
          "[hal][LNK-3]") {
  struct Row {
    double frequency;
    int width;
    int setup_time;
    int hold;
    bool possible;
  };
  // Twice the width has to fit into the period: 25 ticks at 400 kHz, 100 at 100 kHz.
  const Row row = GENERATE(values<Row>({{400e3, 12, 0, 0, true},
                                        {400e3, 13, 0, 0, false},
                                        {100e3, 49, 0, 0, true},
                                        {100e3, 51, 0, 0, false},
                                        {100e3, 0, 0, 0, false},
                                        {100e3, 40, 400, 400, true},
                                        {100e3, 40, 401, 0, false},
                                        {100e3, 40, 0, 401, false}}));
  Setup setup = drives(row.width, row.setup_time, row.hold);
  setup.max_velocity = steps_per_second(row.frequency);
  INFO(row.frequency << " Hz, width " << row.width);
  WatchedBoard board;
  Core core(board);
  CHECK(core.set_up(setup) == row.possible);
}

TEST_CASE("A fault that the board reports stops the pulses like one of the core's own",
          "[hal][safety]") {
  WatchedBoard board;
  Core core(board);
  REQUIRE(core.set_up(kFastBoard));
  REQUIRE(core.push(x_segment(1, 0.1, 500, 10'000)));
  core.advance(ticks(0.09));
  core.report(kBadSegment);
  const std::uint64_t before = board.pulse_count;
  core.advance(ticks(0.1));
  CHECK(core.status().faults == kBadSegment);
  CHECK(board.pulse_count == before);
}
