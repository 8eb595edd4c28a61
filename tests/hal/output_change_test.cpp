// Outputs that change with a segment: at its first tick, and only if it begins.
#include <catch2/catch.hpp>
#include <random>

#include "hal/cpu5/firmware/host_frame.h"
#include "tests/hal/firmware_support.h"
#include "tests/hal/machine_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

constexpr OutputChange kFloodOn{.changed = OutputChange::kFlood, .on = OutputChange::kFlood};

/// Set up, on the way: `count` segments of 12.3457 ms and 100 steps, numbered from 1, the one
/// numbered `switching` with a change.
struct Cruise {
  static constexpr double kPiece = 0.0123457;
  static constexpr std::uint32_t kSwitching = 4;
  static constexpr Ticks kBegin = (kSwitching - 1) * 123457;

  explicit Cruise(const OutputChange& change = kFloodOn) {
    REQUIRE(core.set_up(kFastBoard));
    REQUIRE(core.set_outputs({.drives_enabled = true}));
    board.switchings.clear();
    for (std::uint32_t id = 1; id <= 20; ++id) {
      Segment segment = x_segment(id, kPiece, 100.0 * id, id == 20 ? 0.0 : 100 / kPiece);
      if (id == kSwitching) segment.change = change;
      REQUIRE(core.push(segment));
    }
  }

  WatchedBoard board;
  Core core{board};
};

}  // namespace

TEST_CASE("A segment's change of outputs comes at the tick at which it begins, in any phase",
          "[hal][LNK-9][SPN-1]") {
  std::mt19937 random(GENERATE(1U, 2U, 3U));
  const Ticks most = GENERATE(1, 37, 999, 1000, 1001, 20'000);
  Cruise cruise;
  while (cruise.core.time() < 2 * Cruise::kBegin) {
    cruise.core.advance(1 + static_cast<Ticks>(random()) % most);
  }
  REQUIRE(cruise.board.switchings.size() == 1);
  const Switching& switching = cruise.board.switchings[0];
  CHECK(switching.when == Cruise::kBegin);
  CHECK(switching.counts[0] == 100 * (Cruise::kSwitching - 1));
  CHECK(switching.outputs == Outputs{.drives_enabled = true, .flood = true});
  CHECK(cruise.core.status().outputs == switching.outputs);
}

TEST_CASE("A change of outputs changes what it names and nothing else", "[hal][LNK-9]") {
  struct Row {
    OutputChange change;
    Outputs expected;
  };
  Outputs before{.drives_enabled = true,
                 .spindle_on = true,
                 .tool_direction = true,
                 .spindle_pwm = 1000,
                 .mist = true,
                 .ports = 0b101};
  before.pwm[2] = 500;
  const auto expect = [&](auto edit) {
    Outputs expected = before;
    edit(expected);
    return expected;
  };
  const std::vector<Row> rows{
      {{.changed = 1}, expect([](Outputs& o) { o.spindle_on = false; })},
      {{.changed = 2}, expect([](Outputs& o) { o.tool_direction = false; })},
      {{.changed = 4}, expect([](Outputs& o) { o.mist = false; })},
      {{.changed = 8, .on = 8}, expect([](Outputs& o) { o.flood = true; })},
      {{.changed = 16, .spindle_pwm = 65536}, expect([](Outputs& o) { o.spindle_pwm = 65536; })},
      {{.port = 1}, expect([](Outputs& o) { o.ports = 0b100; })},
      {{.port = 40, .port_on = true},
       expect([](Outputs& o) { o.ports = 0b101 | PortBits{1} << 39; })},
      {{.pwm = 3, .pwm_value = 7}, expect([](Outputs& o) { o.pwm[2] = 7; })},
      {{.pwm = 8, .pwm_value = 9}, expect([](Outputs& o) { o.pwm[7] = 9; })},
  };
  for (const Row& row : rows) {
    Cruise cruise(row.change);
    // What the operator switches meanwhile is not undone by what is in the FIFO.
    REQUIRE(cruise.core.set_outputs(before));
    cruise.core.advance(2 * Cruise::kBegin);
    CHECK(cruise.core.status().outputs == row.expected);
    // And the same at once.
    WatchedBoard board;
    Core core(board);
    REQUIRE(core.set_outputs(before));
    REQUIRE(core.change_outputs(row.change));
    CHECK(board.last_outputs == row.expected);
  }
}

TEST_CASE("A segment that is dropped before it has begun switches nothing",
          "[hal][LNK-9][safety]") {
  // Long before; when its first slice is planned already; a tick before it begins.
  const Ticks before = GENERATE(100'000, 2500, 1500, 500, 1);
  struct Row {
    std::string_view how;
    std::function<void(Cruise&)> drop;
  };
  const std::vector<Row> rows{
      {"quick stop", [](Cruise& c) { c.core.quick_stop(); }},
      {"cleared faults", [](Cruise& c) { c.core.clear_faults(); }},
      {"estop", [](Cruise& c) { c.board.read_inputs = [] { return Inputs{.estop1 = true}; }; }},
      {"bad segment", [](Cruise& c) { CHECK_FALSE(c.core.push(x_segment(1, 0.1, 0))); }},
  };
  for (const Row& row : rows) {
    INFO(row.how);
    Cruise cruise;
    cruise.core.advance(Cruise::kBegin - before);
    row.drop(cruise);
    cruise.core.advance(2 * Cruise::kBegin);
    CHECK_FALSE(cruise.core.status().outputs.flood);
    for (const Switching& switching : cruise.board.switchings) CHECK_FALSE(switching.outputs.flood);
  }
}

TEST_CASE("A cut drops the changes behind it, and keeps those before", "[hal][LNK-9][LNK-8]") {
  const std::uint32_t kept = GENERATE(2U, 3U, 4U, 5U);
  Cruise cruise;
  cruise.core.advance(ticks(0.015));
  cruise.core.cut_behind(kept);
  REQUIRE(cruise.core.push(x_segment(1000, 0.02, 100.0 * kept + 81)));
  cruise.core.advance(ticks(0.2));
  CHECK(cruise.core.status().faults == 0);
  CHECK(cruise.core.status().outputs.flood == (kept >= Cruise::kSwitching));
}

TEST_CASE(
    "While it stops along the path a board switches at the very step where the segment begins",
    "[hal][LNK-9][LNK-8]") {
  // The segment begins 37 ms behind the start. Braking from 8100 steps/s at 200000 steps/s^2 takes
  // 40 ms and half as far as at full speed: begun at 1 ms it ends before, at 25 ms behind.
  const double begin = GENERATE(0.001, 0.025, 0.0369);
  WatchedBoard board;
  Core core(board);
  Setup setup = kFastBoard;
  setup.max_acceleration[0] =
      static_cast<StepAcceleration>(std::ldexp(200'000.0 / 1e14, kAccelerationBits));
  REQUIRE(core.set_up(setup));
  for (std::uint32_t id = 1; id <= 20; ++id) {
    Segment segment = x_segment(id, Cruise::kPiece, 100.0 * id, 100 / Cruise::kPiece);
    if (id == Cruise::kSwitching) segment.change = kFloodOn;
    REQUIRE(core.push(segment));
  }
  core.advance(ticks(begin));
  core.stop_along_path();
  core.advance(ticks(0.1));
  const Status status = core.status();
  REQUIRE(status.path_stop == PathStop::stopped);
  REQUIRE(status.faults == 0);
  const bool passed = status.counts[0] > 300;
  CHECK(passed == (begin > 0.02));
  CHECK(status.outputs.flood == passed);
  REQUIRE(board.switchings.size() == (passed ? 1U : 0U));
  if (passed) CHECK(board.switchings[0].counts[0] == 300);
}

TEST_CASE("What waits for the spindle's index switches when it begins", "[hal][LNK-9][ARC-4]") {
  WatchedBoard board;
  Core core(board);
  Inputs inputs;
  board.read_inputs = [&] { return inputs; };
  REQUIRE(core.set_up(kFastBoard));
  Segment thread = x_segment(1, 0.1, 100, 1000);
  thread.wait_for_index = true;
  thread.change = kFloodOn;
  REQUIRE(core.push(thread));
  REQUIRE(core.push(x_segment(2, 0.1, 150)));
  core.advance(ticks(0.5));
  CHECK(board.switchings.empty());
  const Ticks pulse = core.time();
  inputs.index_count = 1;
  inputs.index_time = pulse;
  core.advance(ticks(0.3));
  CHECK(core.status().counts[0] == 150);
  REQUIRE(board.switchings.size() == 1);
  CHECK(board.switchings[0].when - pulse <= 3 * kSliceTicks);

  SECTION("and not when the pulse fails to come") {
    Setup patient = kFastBoard;
    patient.index_timeout = ticks(0.1);
    REQUIRE(core.set_up(patient));
    REQUIRE(core.set_outputs({}));
    core.quick_stop();
    thread.position[0] = steps(200);
    REQUIRE(core.push(thread));
    core.advance(ticks(0.5));
    CHECK(core.status().faults == kIndexMissing);
    CHECK_FALSE(board.last_outputs.flood);
  }
}

TEST_CASE(
    "Segments that follow a slow spindle and switch one after the other lose no time and no "
    "change",
    "[hal][LNK-9][ARC-4]") {
  WatchedBoard board;
  Core core(board);
  Inputs inputs;
  constexpr Ticks kRevolution = kTicksPerSecond / 20;  // planned for 25 per second, turning with 20
  board.read_inputs = [&] {
    inputs.index_count = static_cast<std::uint32_t>(board.now / kRevolution);
    inputs.index_time = board.now / kRevolution * kRevolution;
    return inputs;
  };
  REQUIRE(core.set_up(kFastBoard));
  core.advance(ticks(1.0));
  board.keep_pulses = true;
  // How long it takes from the first step to the last; the wait for the index lies before.
  const auto push_path = [&](bool switching) {
    const double from = static_cast<double>(core.status().counts[0]);
    for (std::uint32_t i = 1; i <= 200; ++i) {
      Segment segment = x_segment(i, 0.00083, from + 2.0 * i, i == 200 ? 0.0 : 2 / 0.00083);
      segment.wait_for_index = i == 1;
      segment.spindle_period = static_cast<std::uint32_t>(kTicksPerSecond / 25);
      if (switching) {
        segment.change = {.changed = OutputChange::kSpindlePwm, .spindle_pwm = i};
      }
      REQUIRE(core.push(segment));
    }
    board.pulses.clear();
    while (core.status().moving) core.advance(1000);
    REQUIRE(board.pulses.size() == 400);
    return board.pulses.back().when - board.pulses.front().when;
  };
  const Ticks plain = push_path(false);
  core.quick_stop();
  core.advance(kRevolution - core.time() % kRevolution);
  const Ticks begin_phase = core.time() % kRevolution;
  CHECK(begin_phase == 0);
  board.switchings.clear();
  const Ticks switching = push_path(true);
  CHECK(core.status().faults == 0);
  CHECK(core.status().counts[0] == 800);
  // 199 segments of 0.83 ms, with 25 turns a second planned and 20 made, and what lies between the
  // first step and the last of a segment; each segment may be rounded by a tick.
  CHECK(static_cast<double>(plain) == Approx(199 * 0.00083 * 25 / 20 * 1e7).epsilon(0.01));
  CHECK(std::abs(switching - plain) <= 200);
  REQUIRE(board.switchings.size() == 200);
  for (std::uint32_t i = 0; i < 200; ++i) {
    CHECK(board.switchings[i].outputs.spindle_pwm == i + 1);
    CHECK(board.switchings[i].counts[0] == 400 + 2 * i);
  }
}

TEST_CASE("A segment that begins while the host switches loses neither the host's nor its own",
          "[hal][LNK-9]") {
  Cruise cruise;
  cruise.core.advance(Cruise::kBegin - 100);
  bool interrupted = false;
  cruise.board.on_switching = [&] {
    if (std::exchange(interrupted, true)) return;
    cruise.core.run_until(Cruise::kBegin +
                          100);  // the step timer's interrupt, within the host's call
  };
  REQUIRE(cruise.core.set_outputs({.drives_enabled = true, .mist = true}));
  REQUIRE(interrupted);
  CHECK(cruise.board.last_outputs == Outputs{.drives_enabled = true, .mist = true, .flood = true});
  cruise.core.advance(ticks(0.05));
  CHECK(cruise.core.status().faults == 0);
  CHECK(cruise.core.status().outputs.flood);
}

TEST_CASE("While a fault is pending no change of outputs is taken", "[hal][LNK-9][safety]") {
  Cruise cruise;
  CHECK_FALSE(cruise.core.push(x_segment(1, 0.1, 0)));
  REQUIRE(cruise.core.status().faults == kBadSegment);
  CHECK_FALSE(cruise.core.change_outputs(kFloodOn));
  CHECK_FALSE(cruise.board.last_outputs.flood);
}

TEST_CASE("Frames that were sent before a quick stop change no outputs", "[hal][LNK-9][safety]") {
  HostFrame frame;
  frame.change = kFloodOn;
  frame.drop_path_and_outputs();
  WatchedBoard board;
  Core core(board);
  execute(frame, core);
  CHECK_FALSE(board.last_outputs.flood);
  frame.change = kFloodOn;
  execute(frame, core);
  CHECK(board.last_outputs.flood);
}

TEST_CASE(
    "Through driver and wire a change stays with its segment, stretched ones before it or not",
    "[hal][LNK-9][LNK-1]") {
  using namespace cnc;
  using namespace cnc::hal;
  std::vector<double> places;
  const auto controller =
      sim::make_virtual_controller(sim::small_machine(), {.machine = {.start = Position{}}});
  REQUIRE(controller->connect());
  controller->set_outputs({.drives_enabled = true});
  controller->exchange(0.0);
  // Outputs go off once more when the controller ends: the places outlive it, it is not asked.
  sim::VirtualMachine& machine = controller->machine();
  machine.set_output_listener([&] { places.push_back(machine.physical_position(Axis::X)); });
  // 1 mm, 10 segments of a microsecond at rest, of which each takes 10, and 1 mm more.
  std::uint32_t id = 0;
  hal::Segment segment{.duration = 0.1};
  const auto push = [&] {
    segment.id = ++id;
    REQUIRE(controller->push({&segment, 1}) == 1);
  };
  segment.position[Axis::X] = 1.0;
  push();
  segment.duration = 1e-6;
  for (int i = 0; i < 10; ++i) push();
  segment.duration = 0.1;
  segment.position[Axis::X] = 2.0;
  segment.change = {.spindle_on = true,
                    .tool_direction = true,
                    .spindle_pwm = 0.5,
                    .mist = true,
                    .flood = true,
                    .port = hal::OutputChange::Port{17, true},
                    .pwm = hal::OutputChange::Pwm{4, 0.25}};
  push();
  segment.change = {};
  segment.position[Axis::X] = 3.0;
  push();
  double now = 0.0;
  while (controller->exchange(now += 0.01).executing_id < id) {
  }
  const ControllerStatus& end = controller->exchange(now + 0.2);
  CHECK(end.faults == 0);
  REQUIRE(places.size() == 1);
  CHECK(places[0] == Approx(1.0).margin(1e-9));
  hal::Outputs expected{.drives_enabled = true,
                        .spindle_on = true,
                        .tool_direction = true,
                        .spindle_pwm = 0.5,
                        .mist = true,
                        .flood = true};
  expected.ports.set(17);
  expected.pwm[4] = 0.25;
  CHECK(end.outputs == expected);
}

TEST_CASE("A change leads from outputs to others, where it can hold what differs", "[hal][LNK-9]") {
  using cnc::hal::change_between;
  const cnc::hal::Outputs off;
  CHECK(change_between(off, off)->empty());
  cnc::hal::Outputs on{.spindle_on = true, .spindle_pwm = 0.3, .flood = true};
  on.ports.set(3);
  on.pwm[1] = 0.7;
  const auto change = change_between(off, on);
  REQUIRE(change);
  CHECK(*change == cnc::hal::OutputChange{.spindle_on = true,
                                          .spindle_pwm = 0.3,
                                          .flood = true,
                                          .port = cnc::hal::OutputChange::Port{3, true},
                                          .pwm = cnc::hal::OutputChange::Pwm{1, 0.7}});
  cnc::hal::Outputs two = on;
  two.ports.set(4);
  CHECK_FALSE(change_between(off, two));
  two = on;
  two.pwm[2] = 0.1;
  CHECK_FALSE(change_between(off, two));
  CHECK_FALSE(change_between(off, {.drives_enabled = true}));
}

namespace cnc::hal::sim {

TEST_CASE("Changes of one exchange go out together where that switches nothing to and fro",
          "[hal][LNK-9]") {
  const auto controller = make_virtual_controller(small_machine());
  REQUIRE(controller->connect());
  const auto switched = [&] { return controller->exchange(0.1).outputs; };
  controller->exchange(0.0);
  SECTION("the newest of many values of PWM is the one") {
    for (int i = 1; i <= 100; ++i) {
      REQUIRE(controller->change_outputs({.spindle_on = true, .spindle_pwm = 0.005 * i}));
      REQUIRE(controller->change_outputs({.pwm = OutputChange::Pwm{3, 0.0025 * i}}));
    }
    const Outputs outputs = switched();
    CHECK(outputs.spindle_on);
    CHECK(outputs.spindle_pwm == 0.5);
    CHECK(outputs.pwm[3] == 0.25);
  }
  SECTION("different outputs") {
    REQUIRE(controller->change_outputs({.flood = true}));
    REQUIRE(controller->change_outputs({.mist = true, .port = OutputChange::Port{4, true}}));
    const Outputs outputs = switched();
    CHECK(outputs.flood);
    CHECK(outputs.mist);
    CHECK(outputs.ports[4]);
  }
  SECTION("a pulse is none") {
    const auto [on, off] = GENERATE(table<OutputChange, OutputChange>({
        {{.spindle_on = true}, {.spindle_on = false}},
        {{.tool_direction = true}, {.tool_direction = false}},
        {{.mist = true}, {.mist = false}},
        {{.flood = true}, {.flood = false}},
        {{.port = OutputChange::Port{4, true}}, {.port = OutputChange::Port{4, false}}},
    }));
    REQUIRE(controller->change_outputs(on));
    CHECK_FALSE(controller->change_outputs(off));
    Outputs expected;
    on.apply_to(expected);
    CHECK(switched() == expected);
    CHECK(controller->change_outputs(off));
    CHECK(switched() == Outputs{});
  }
  SECTION("there is room for one port and one PWM only") {
    REQUIRE(controller->change_outputs({.port = OutputChange::Port{4, true}}));
    CHECK_FALSE(controller->change_outputs({.port = OutputChange::Port{5, true}}));
    REQUIRE(controller->change_outputs({.pwm = OutputChange::Pwm{1, 0.5}}));
    CHECK_FALSE(controller->change_outputs({.pwm = OutputChange::Pwm{2, 0.5}}));
  }
}

}  // namespace cnc::hal::sim
