// Switches of the virtual machine as they really are: they bounce, they get stuck, and limit
// switches, door and estop chain are wired together.
#include "hal/sim/contact.h"

#include "hal/sim/height_map.h"
#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;
using BoardInputs = cpu5::firmware::Inputs;
using cpu5::firmware::Ticks;
using Switch = VirtualMotor::Switch;

namespace {

constexpr Ticks kMillisecond = cpu5::firmware::kTicksPerSecond / 1000;

/// A hand on the machine without a board: its steps and its looks at the inputs.
class Bench {
 public:
  explicit Bench(const MachineOptions& options,
                 const config::MachineConfig& config = small_machine())
      : machine(config, options) {
    machine.set_outputs({.drives_enabled = true});
  }
  void step(Axis axis, int count) {
    for (int i = 0; i < std::abs(count); ++i) {
      machine.step(index_of(axis), count < 0 ? -1 : 1, now);
      look(kMillisecond);  // 1000 steps/s are slow enough to start and stop at once
    }
  }
  BoardInputs look(Ticks passed = 0) { return machine.inputs(now += passed); }

  VirtualMachine machine;
  Ticks now = 0;
};

std::vector<bool> bounces(std::uint64_t seed) {
  Contact contact(5 * kMillisecond, seed);
  std::vector<bool> seen;
  for (Ticks time = 0; time < 10 * kMillisecond; time += kMillisecond / 10) {
    seen.push_back(contact.read(time >= kMillisecond, time));
  }
  return seen;
}

}  // namespace

TEST_CASE("A contact shows an edge at once, flickers for its bounce time, and is quiet then",
          "[hal][sim]") {
  const std::vector<bool> seen = bounces(1);
  CHECK(std::none_of(seen.begin(), seen.begin() + 10, [](bool on) { return on; }));
  CHECK(seen[10]);
  const auto off = std::count(seen.begin() + 10, seen.begin() + 60, false);
  CHECK(off > 5);  // of 50 looks while it bounces
  CHECK(off < 45);
  CHECK(std::all_of(seen.begin() + 60, seen.end(), [](bool on) { return on; }));
}

TEST_CASE("The same seed bounces the same way, another one otherwise", "[hal][sim]") {
  CHECK(bounces(7) == bounces(7));
  CHECK(bounces(7) != bounces(8));
}

TEST_CASE("A contact without bounce or fault shows what it touches", "[hal][sim]") {
  Contact contact(0, 1);
  CHECK(contact.read(true, 10));
  CHECK(contact.read(true, 11));
  CHECK_FALSE(contact.read(false, 11));
  contact.stick(true);
  CHECK(contact.read(false, 12));
  contact.stick(std::nullopt);
  CHECK_FALSE(contact.read(false, 13));
}

TEST_CASE("A home switch that bounces flickers on the input, not in the mechanics",
          "[hal][sim][HOM-2]") {
  // Hysteresis 0.2 mm of 200 steps/mm: it trips 40 steps behind the home position of 301 mm.
  Bench bench({.start = Position::filled(301.0), .switch_bounce = 0.02});
  bench.step(Axis::X, 39);
  CHECK(bench.look().home == 0);
  bench.machine.step(0, 1, bench.now);
  CHECK(bench.look().home == 0b000001);
  int open = 0;
  for (int i = 0; i < 150; ++i) open += bench.look(kMillisecond / 10).home == 0 ? 1 : 0;
  CHECK(open > 15);
  CHECK(bench.machine.home_switch(Axis::X));
  bench.look(10 * kMillisecond);
  for (int i = 0; i < 150; ++i) CHECK(bench.look(kMillisecond / 10).home == 0b000001);
}

TEST_CASE("A stuck home switch shows the same wherever the axis is", "[hal][sim][HOM-2]") {
  const bool state = GENERATE(true, false);
  Bench bench({.start = Position::filled(state ? 100.0 : 305.0)});
  CHECK((bench.look().home == 0) == state);
  for (const Axis axis : kLinearAxes) bench.machine.stick_switch(axis, Switch::home, state);
  CHECK(bench.look().home == (state ? 0b000111 : 0));
  for (const Axis axis : kLinearAxes) bench.machine.stick_switch(axis, Switch::home, std::nullopt);
  CHECK((bench.look().home == 0) == state);
}

TEST_CASE("Limit switches stand behind either end of the travel, before the hard stops",
          "[hal][sim]") {
  // Travel -100 … 300 mm, home switch at 301 mm: they trip 2 mm behind, at -102 and 303 mm, and
  // release 0.2 mm before that. 200 steps/mm.
  const bool high = GENERATE(true, false);
  const bool in_chain = GENERATE(true, false);
  MachineOptions options{.start = Position::filled(high ? 302.0 : -101.0)};
  options.axes[Axis::Y] = {.limit_low_port = port_bit(3),
                           .limit_high_port = port_bit(102),
                           .limits_in_estop_chain = in_chain};
  const auto bit = cpu5::firmware::PortBits{1} << *port_bit(high ? 102 : 3);
  const int outwards = high ? 1 : -1;
  Bench bench(options);
  bench.step(Axis::Y, 199 * outwards);
  CHECK(bench.look().ports == 0);
  CHECK_FALSE(bench.look().estop());
  bench.step(Axis::Y, outwards);
  CHECK(bench.look().ports == bit);
  CHECK(bench.look().estop1 == in_chain);
  CHECK(bench.look().estop2 == in_chain);
  bench.step(Axis::Y, -39 * outwards);
  CHECK(bench.look().ports == bit);
  bench.step(Axis::Y, -outwards);
  CHECK(bench.look().ports == 0);
  CHECK_FALSE(bench.look().estop());
  CHECK(bench.machine.lost_steps(Axis::Y) == 0);
}

TEST_CASE("Limit switches that are wired to nothing do nothing", "[hal][sim]") {
  Bench bench({.start = Position::filled(305.0)});
  CHECK(bench.look().ports == 0);
  CHECK_FALSE(bench.look().estop());
}

TEST_CASE("The estop chain has two channels, and the door may be in it", "[hal][sim][STA-4]") {
  const bool in_chain = GENERATE(true, false);
  Bench bench({.door = DoorOptions{.port = port_bit(7), .in_estop_chain = in_chain}});
  bench.machine.press_estop2(true);
  CHECK_FALSE(bench.look().estop1);
  CHECK(bench.look().estop2);
  bench.machine.press_estop2(false);
  CHECK_FALSE(bench.look().estop());
  bench.machine.open_door(true);
  CHECK(bench.look().ports == cpu5::firmware::PortBits{1} << 6);
  CHECK(bench.look().estop1 == in_chain);
  CHECK(bench.look().estop2 == in_chain);
  bench.machine.open_door(false);
  CHECK(bench.look().ports == 0);
  CHECK_FALSE(bench.look().estop());
  bench.machine.stick_door(true);
  CHECK(bench.look().ports == cpu5::firmware::PortBits{1} << 6);
  CHECK_FALSE(bench.machine.door_open());
}

TEST_CASE("An open door cuts spindle and coolant off if they are wired so", "[hal][sim][SPN-1]") {
  const bool wired = GENERATE(true, false);
  Bench bench({.door = DoorOptions{.stops_spindle = wired, .stops_coolant = wired}});
  bench.machine.set_outputs({.drives_enabled = true,
                             .tool_direction = true,
                             .spindle_pwm = cpu5::firmware::Outputs::kFullPwm,
                             .mist = true,
                             .flood = true});
  bench.look(2000 * kMillisecond);
  CHECK(bench.machine.spindle_speed() == Approx(24'000).epsilon(0.001));
  bench.machine.open_door(true);
  bench.look(3000 * kMillisecond);
  CHECK(bench.machine.spindle_speed() == Approx(wired ? 0 : 24'000).epsilon(0.001));
  CHECK(bench.machine.flood_time() == Approx(wired ? 2.0 : 5.0));
  CHECK(bench.machine.mist_time() == Approx(wired ? 2.0 : 5.0));
  bench.machine.open_door(false);
  bench.look(2000 * kMillisecond);
  CHECK(bench.machine.spindle_speed() == Approx(24'000).epsilon(0.001));
  CHECK(bench.machine.flood_time() == Approx(wired ? 4.0 : 7.0));
}

TEST_CASE("A heavy spindle speeds up in a straight line", "[hal][sim][SPN-1]") {
  // 12000 rpm at 4000 rpm/s; then the lag of 0.05 s, which begins 4000 * 0.05 = 200 rpm before.
  Bench bench({.spindle = {.time_constant = 0.05, .acceleration = 4'000}});
  bench.machine.set_outputs(
      {.tool_direction = true, .spindle_pwm = cpu5::firmware::Outputs::kFullPwm / 2});
  bench.look(1000 * kMillisecond);
  CHECK(bench.machine.spindle_speed() == Approx(4'000).margin(2));
  bench.look(1000 * kMillisecond);
  CHECK(bench.machine.spindle_speed() == Approx(8'000).margin(2));
  bench.look(2000 * kMillisecond);
  CHECK(bench.machine.spindle_speed() == Approx(12'000).margin(2));
}

TEST_CASE("A spindle without its index sensor turns unseen", "[hal][sim][LNK-6]") {
  Bench bench({});
  bench.machine.set_outputs(
      {.tool_direction = true, .spindle_pwm = cpu5::firmware::Outputs::kFullPwm});
  bench.look(2000 * kMillisecond);
  const std::uint32_t seen = bench.look().index_count;
  CHECK(seen > 100);
  bench.machine.set_index_missing(true);
  CHECK(bench.look(1000 * kMillisecond).index_count == seen);
  bench.machine.set_index_missing(false);
  CHECK(bench.look(1000 * kMillisecond).index_count == Approx(seen + 400).margin(1));
}

TEST_CASE("A stuck probe touches always, or never", "[hal][sim][GCO-2]") {
  Bench bench(
      {.start = Position::filled(50.0), .touch = {.stock = [](double, double) { return 50.0; }}});
  CHECK(bench.look().probe);
  bench.machine.stick_probe(false);
  CHECK_FALSE(bench.look().probe);
  bench.machine.stick_probe(std::nullopt);
  bench.step(Axis::Z, 1);
  CHECK_FALSE(bench.look().probe);
  bench.machine.stick_probe(true);
  CHECK(bench.look().probe);
}

TEST_CASE("A height map is bilinear within its grid and nothing outside", "[hal][sim][GCO-2]") {
  // Two rows of three points, 10 mm apart in X and 20 mm in Y, from (-5, 0).
  const HeightMap map{
      .x = -5, .y = 0, .dx = 10, .dy = 20, .columns = 3, .heights = {0, 1, 2, 4, 5, 10}};
  CHECK(map(-5, 0) == 0);
  CHECK(map(15, 0) == 2);
  CHECK(map(15, 20) == 10);
  CHECK(map(0, 0) == Approx(0.5));
  CHECK(map(-5, 5) == Approx(1.0));   // a quarter of the way from 0 to 4
  CHECK(map(10, 10) == Approx(4.5));  // (1 + 2 + 5 + 10) / 4, the middle of a cell
  CHECK(map(-5.001, 0) < -1e300);
  CHECK(map(0, 20.001) < -1e300);
}

TEST_CASE("Ports of a card that is not there read inactive", "[hal][sim][ARC-4]") {
  Bench bench({.loop_back_delay = 0.0, .io_cards = {true, false, true}});
  for (std::size_t port = 0; port < cpu5::firmware::kPortCount; ++port) {
    bench.machine.set_port_input(port, true);
  }
  // 16 AUX, eight of card 1, none of card 2, eight of card 3.
  CHECK(bench.look().ports == 0xff'00'ff'ffff);
  for (std::size_t port = 0; port < cpu5::firmware::kPortCount; ++port) {
    bench.machine.set_port_input(port, false);
  }
  bench.machine.set_outputs({.ports = 0xff'ff'ff'ffff});
  CHECK(bench.look(kMillisecond).ports == 0xff'00'ff'ffff);
}

TEST_CASE("Inputs are active from power-up where the options say so", "[hal][sim]") {
  MachineOptions options{.ports_on = 0b101};
  options.analog[2] = 0.25;
  Bench bench(options);
  CHECK(bench.look().ports == 0b101);
  CHECK(bench.look().analog[2] == BoardInputs::kFullAnalog / 4);
}

TEST_CASE("A board that begins anew counts its time from zero, the machine goes on",
          "[hal][sim][LNK-6]") {
  Bench bench({});
  bench.machine.set_outputs(
      {.tool_direction = true, .spindle_pwm = cpu5::firmware::Outputs::kFullPwm});
  const BoardInputs before = bench.look(3000 * kMillisecond);
  bench.machine.restart_board();
  const BoardInputs after = bench.machine.inputs(100 * kMillisecond);
  // 24000 rpm: 40 revolutions in 0.1 s, and the last one not longer than 2.5 ms ago.
  CHECK(after.index_count == Approx(before.index_count + 40).margin(1));
  CHECK(after.index_time <= 100 * kMillisecond);
  CHECK(after.index_time > 97 * kMillisecond);
}
