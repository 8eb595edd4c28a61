// The board watches the inputs of its I/O cards by rules of the configuration (CFG-16).
#include <catch2/catch.hpp>

#include "tests/hal/firmware_support.h"
#include "tests/hal/machine_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

constexpr PortBits input(int card, int number) {
  return PortBits{1} << (16 + 8 * (card - 1) + number - 1);
}

struct Guarded {
  explicit Guarded(const GuardRule& rule, std::size_t number = 0) {
    Setup setup = kFastBoard;
    setup.guards[number] = rule;
    setup.max_acceleration[0] =
        static_cast<StepAcceleration>(std::ldexp(1e6 / 1e14, kAccelerationBits));
    board.read_inputs = [this] { return Inputs{.ports = ports}; };
    REQUIRE(core.set_up(setup));
    REQUIRE(core.set_outputs({.drives_enabled = true, .flood = true}));
    for (std::uint32_t id = 1; id <= 20; ++id) {
      REQUIRE(core.push(x_segment(id, 0.01, 100.0 * id, id == 20 ? 0 : 10'000)));
    }
    core.advance(ticks(0.05));
  }
  [[nodiscard]] std::uint8_t count(std::size_t number = 0) {
    return core.status().guard_counts[number];
  }

  PortBits ports = 0;
  WatchedBoard board;
  Core core{board};
};

}  // namespace

TEST_CASE("A guard rule is true when all inputs that take part are as it says", "[hal][CFG-16]") {
  struct Row {
    std::uint8_t participants, compare;
    std::vector<std::pair<std::uint8_t, std::uint8_t>> inputs_and_count;  // count afterwards
  };
  const std::vector<Row> rows{
      {0b1, 0b1, {{0, 0}, {0b1, 1}, {0b11, 1}, {0b10, 1}, {0b1, 2}}},
      {0b1, 0b0, {{0b1, 0}, {0b0, 1}, {0b10, 1}, {0b1, 1}, {0b0, 2}}},
      {0b11, 0b01, {{0b10, 0}, {0b11, 0}, {0b01, 1}, {0b101, 1}, {0b11, 1}, {0b01, 2}}},
      {0b1000'0000, 0xFF, {{0x7F, 0}, {0x80, 1}}},
      {0, 0, {{0, 0}, {0xFF, 0}}},
      {0, 0xFF, {{0, 0}, {0xFF, 0}}},
  };
  const std::size_t card = GENERATE(0U, 1U, 2U);
  const std::size_t number = card * kRulesPerCard + GENERATE(0U, 7U);
  for (const Row& row : rows) {
    CardGuards guards;
    PerGuardRule<GuardRule> rules{};
    rules[number] = {row.participants, row.compare, GuardAction::warning};
    guards.set_rules(rules);
    for (const auto& [inputs, count] : row.inputs_and_count) {
      CAPTURE(row.participants, row.compare, inputs);
      // The other cards show the opposite.
      const PortBits others = static_cast<std::uint8_t>(~inputs) * PortBits{0x010101};
      const PortBits cards = (others & ~(PortBits{0xFF} << 8 * card)) | PortBits{inputs}
                                                                            << 8 * card;
      static_cast<void>(guards.look(cards << kFirstCardPort));
      CHECK(guards.counts()[number] == count);
    }
  }
}

TEST_CASE("Of rules that become true together the strongest acts; without an action none counts",
          "[hal][CFG-16]") {
  CardGuards guards;
  PerGuardRule<GuardRule> rules{};
  rules[0] = {1, 1, GuardAction::warning};
  rules[1] = {1, 1, GuardAction::quick_stop};
  rules[2] = {1, 1, GuardAction::smooth_stop};
  rules[3] = {1, 1, GuardAction::nothing};
  guards.set_rules(rules);
  CHECK(guards.look(0) == GuardAction::nothing);
  CHECK(guards.look(input(1, 1)) == GuardAction::quick_stop);
  CHECK(guards.counts()[0] == 1);
  CHECK(guards.counts()[3] == 0);
  CHECK(guards.look(input(1, 1)) == GuardAction::nothing);
  CHECK(guards.look(input(1, 1) | input(2, 1)) == GuardAction::nothing);
  // Set up anew they count anew, and what is true acts at once.
  guards.set_rules(rules);
  CHECK(guards.counts()[0] == 0);
  CHECK(guards.look(input(1, 1)) == GuardAction::quick_stop);
}

TEST_CASE("A warning is counted and stops nothing", "[hal][CFG-16]") {
  Guarded guarded({1, 1, GuardAction::warning}, 23);
  guarded.ports = input(3, 1);
  guarded.core.advance(ticks(0.2));
  CHECK(guarded.count(23) == 1);
  CHECK(guarded.core.status().counts[0] == 2000);
  CHECK(guarded.core.status().path_stop == PathStop::none);
  CHECK(guarded.board.last_outputs.flood);
}

TEST_CASE("A smooth stop brakes along the path and waits to be released", "[hal][CFG-16][safety]") {
  Guarded guarded({0b10, 0b10, GuardAction::smooth_stop});
  guarded.ports = input(1, 2);
  guarded.core.advance(ticks(0.05));
  Status status = guarded.core.status();
  CHECK(status.path_stop == PathStop::stopped);
  CHECK(status.faults == 0);
  CHECK(guarded.count() == 1);
  // From 10 kHz at 10^6 steps/s^2: 50 steps, and 3 in the three slices that are planned.
  CHECK(status.counts[0] >= 500 + 45);
  CHECK(status.counts[0] <= 500 + 55);
  CHECK(status.outputs.flood);
  CHECK_FALSE(guarded.core.push(x_segment(1, 0.1, 0)));
  // Still true: it does not act again.
  guarded.core.release_stop();
  REQUIRE(guarded.core.push(x_segment(1, 0.1, 600)));
  guarded.core.advance(ticks(0.2));
  CHECK(guarded.core.status().counts[0] == 600);
}

TEST_CASE("A smooth stop comes at a standstill too: what is on its way must not move",
          "[hal][CFG-16][safety]") {
  Guarded guarded({1, 1, GuardAction::smooth_stop});
  guarded.core.advance(ticks(0.3));
  REQUIRE_FALSE(guarded.core.status().moving);
  guarded.ports = input(1, 1);
  guarded.core.advance(ticks(0.001));
  CHECK(guarded.core.status().path_stop == PathStop::stopped);
  CHECK_FALSE(guarded.core.push(x_segment(21, 0.1, 0)));
}

TEST_CASE("A guard's stop during another stop has to be released by itself",
          "[hal][CFG-16][safety]") {
  Guarded guarded({0b1, 0b1, GuardAction::smooth_stop});
  guarded.core.stop_along_path();
  guarded.core.advance(ticks(0.002));
  guarded.ports = input(1, 1);
  guarded.core.advance(ticks(0.5));
  REQUIRE(guarded.core.status().path_stop == PathStop::stopped);
  CHECK(guarded.count() == 1);
  guarded.core.release_stop();  // meant for the first one
  CHECK(guarded.core.status().path_stop == PathStop::stopped);
  CHECK_FALSE(guarded.core.push(x_segment(21, 0.01, 0.0)));
  guarded.core.release_stop();
  CHECK(guarded.core.status().path_stop == PathStop::none);
}

TEST_CASE("A quick stop is a fault within a slice, everything off", "[hal][CFG-16][safety]") {
  Guarded guarded({1, 1, GuardAction::quick_stop});
  guarded.ports = input(1, 1);
  guarded.core.advance(2 * kSliceTicks);
  CHECK(guarded.core.status().faults == kGuardStop);
  // 10 kHz: one step in a slice.
  CHECK(guarded.core.status().counts[0] <= 502);
  CHECK(guarded.board.last_outputs == Outputs{});
  CHECK(guarded.count() == 1);
  // It can be cleared although the input stays: vacuum comes back only when its pump may be on.
  guarded.core.clear_faults();
  guarded.core.advance(ticks(0.01));
  CHECK(guarded.core.status().faults == 0);
  guarded.ports = 0;
  guarded.core.advance(ticks(0.01));
  guarded.ports = input(1, 1);
  guarded.core.advance(ticks(0.01));
  CHECK(guarded.core.status().faults == kGuardStop);
  CHECK(guarded.count() == 2);
}

TEST_CASE("Rules of the configuration reach the board, and their counts the host",
          "[hal][CFG-16]") {
  using namespace cnc;
  using namespace cnc::hal;
  config::MachineConfig config = sim::small_machine();
  config.guards[9] = {"oil low", 0b100, 0b000, config::GuardAction::warning};
  config.guards[10] = {"vacuum low", 0b1, 0b1, config::GuardAction::quick_stop};
  sim::SimOptions options{.machine = {.start = Position{}}};
  options.machine.io_cards[1] = true;
  options.machine.ports_on = PortBits{1} << (16 + 8 + 2);
  const auto controller = sim::make_virtual_controller(config, options);
  REQUIRE(controller->connect());
  double now = 0.0;
  CHECK(controller->exchange(now += 0.01).guard_counts[9] == 0);
  controller->machine().set_port_input(16 + 8 + 2, false);
  controller->exchange(now += 0.01);
  CHECK(controller->exchange(now += 0.01).guard_counts[9] == 1);
  CHECK(controller->exchange(now += 0.01).faults == 0);
  controller->machine().set_port_input(16 + 8, true);
  controller->exchange(now += 0.01);
  CHECK(controller->exchange(now += 0.01).faults == static_cast<Faults>(Fault::guard_stop));
}
