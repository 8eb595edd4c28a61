// The trace of the link: whatever stops a job, the recorded requests make a virtual board do the
// same again (LNK-4). In virtual time; and the keeper that writes traces to files.
#include <catch2/catch.hpp>
#include <filesystem>
#include <future>

#include "hal/fault_names.h"
#include "hal/trace/replay.h"
#include "server/daemon/trace_keeper.h"
#include "server/link/link_trace.h"
#include "tests/config/temporary_directory.h"
#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using namespace cnc::hal::trace;
using Catch::Contains;

namespace {

SimulationOptions traced(Ring& ring) {
  SimulationOptions options = at_zero();
  options.trace = &ring;
  options.period = 0.002;
  return options;
}

/// Ready, and everything recorded.
struct TracedRig {
  explicit TracedRig(const std::vector<std::string>& settings = {})
      : rig(free_machine(settings), traced(ring)) {}

  [[nodiscard]] Trace trace(double seconds = 30.0) {
    const About about = about_machine(rig.machine.config(), "virtual board");
    auto parsed = parse_trace(trace_bytes(about, ring.copy(), seconds), "trace");
    REQUIRE(parsed);
    return std::move(*parsed);
  }
  void start_cut() {
    rig.start("M3 S12000\nG1 X100 F1200\nX0\nX100\nX0\n");
    REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 30.0; }));
  }
  [[nodiscard]] hal::sim::VirtualController& board() { return rig.simulation.virtual_controller(); }

  Ring ring;
  ReadyRig rig;
};

ReplayReport replayed(const Trace& trace) {
  const auto report = replay(trace);
  REQUIRE(report);
  if (report->difference) UNSCOPED_INFO(report->difference->what);
  return *report;
}

/// What faults became, in their order: "estop", "none".
std::vector<std::string> faults_of(const ReplayReport& report) {
  std::vector<std::string> names;
  for (const FaultChange& change : report.faults) names.push_back(hal::fault_names(change.faults));
  return names;
}

struct FaultRow {
  const char* name;
  void (*happens)(TracedRig&);
  std::vector<std::string> faults;
};

const FaultRow kFaults[] = {
    {"the estop is pressed",
     [](TracedRig& f) {
       f.rig.simulation.virtual_machine().press_estop(true);
       f.rig.run_for(0.1);
     },
     {"estop"}},
    {"the estop is pressed and released again, shorter than an exchange",
     [](TracedRig& f) {
       auto& board = f.board().board();
       board.machine().press_estop(true);
       board.advance_to(board.now() + 0.0005);
       board.machine().press_estop(false);
       f.rig.run_for(0.1);
     },
     {"estop"}},
    {"a drive raises its alarm",
     [](TracedRig& f) {
       f.rig.simulation.virtual_machine().raise_drive_alarm(Axis::Y, true);
       f.rig.run_for(0.1);
     },
     {"step_loss"}},
    {"the computer is too busy to fill the FIFO",
     [](TracedRig& f) {
       f.rig.simulation.starve_machine(0.6);
       f.rig.run_for(0.1);
     },
     {"fifo_underrun"}},
    {"a segment that cannot be executed",
     [](TracedRig& f) {
       f.rig.simulation.link().push(hal::Segment{.id = 123'456, .duration = 0.005});
       f.rig.run_for(0.5);
     },
     {"bad_segment"}},
    {"the cable is out for a second",
     [](TracedRig& f) {
       f.board().trouble().cable_out = true;
       f.rig.run_for(1.0);
       f.board().trouble().cable_out = false;
       f.rig.run_for(0.5);
     },
     {"link_lost"}},
    {"the board is reset",
     [](TracedRig& f) {
       f.board().board().reset();
       f.rig.run_for(0.5);
     },
     {}},
};

}  // namespace

TEST_CASE("The replay of a trace does what the board did, faults included",
          "[server][trace][LNK-4]") {
  const FaultRow& row = kFaults[GENERATE(range(0, 7))];
  CAPTURE(row.name);
  TracedRig f;
  f.start_cut();
  row.happens(f);
  const Trace trace = f.trace();
  const ReplayReport report = replayed(trace);
  CHECK_FALSE(report.difference);
  CHECK_FALSE(report.in_motion);  // the ring goes back to where the machine stood
  CHECK(faults_of(report) == row.faults);
  CHECK(report.compared > 500);
  CHECK(report.following_spindle == 0);
  // A fault stops the path where it stopped it then: to two steps of 1/200 mm.
  if (!row.faults.empty()) CHECK(report.largest_deviation < 2.0 / 200.0 + 20.0 * 0.0021);
}

TEST_CASE("A trace that begins in motion is taken over at the end of a segment",
          "[server][trace][LNK-4]") {
  TracedRig f;
  f.start_cut();
  f.rig.run_for(3.0);
  f.rig.simulation.virtual_machine().press_estop(true);
  f.rig.run_for(0.1);
  const Trace trace = f.trace(2.0);
  REQUIRE(trace.steps.front().exchange.status.moving);
  const ReplayReport report = replayed(trace);
  CHECK(report.in_motion);
  CHECK_FALSE(report.difference);
  CHECK(faults_of(report) == std::vector<std::string>{"estop"});
  // Only a FIFO (0.25 s) and a segment had to pass before all was known.
  CHECK(report.begin < 160);
  CHECK(report.compared > 800);
}

TEST_CASE("Holds, resumes and overrides are replayed", "[server][trace][LNK-8]") {
  TracedRig f;
  f.start_cut();
  REQUIRE(f.rig.pause());
  REQUIRE(f.rig.machine.resume());
  f.rig.run_for(0.3);
  REQUIRE(f.rig.machine.set_overrides({.feed = 0.5}));
  f.rig.run_for(0.5);
  REQUIRE(f.rig.stop());
  REQUIRE(f.rig.mdi("G0 X0 Y0"));
  const ReplayReport report = replayed(f.trace());
  CHECK_FALSE(report.difference);
  CHECK(report.faults.empty());
}

TEST_CASE("Probing and homing are replayed with the recorded touch and switches",
          "[server][trace][GCO-8][HOM-2]") {
  Ring ring;
  SimulationOptions options = traced(ring);
  options.machine.touch.stock = [](double, double) { return -20.0; };
  ReadyRig rig(shipped_machine({"SAFETY.homingMandatory=0"}), options);
  REQUIRE(rig.mdi("G38.2 Z-30 F600"));
  REQUIRE(rig.position()[Axis::Z] < -19.9);
  REQUIRE(rig.mdi("G0 Z0"));
  REQUIRE(rig.home({Axis::Z}));
  REQUIRE(rig.homed(Axis::Z));
  const auto trace = parse_trace(
      trace_bytes(about_machine(rig.machine.config(), "virtual board"), ring.copy()), "trace");
  REQUIRE(trace);
  const ReplayReport report = replayed(*trace);
  CHECK_FALSE(report.difference);
  CHECK(report.faults.empty());
}

TEST_CASE("Motion that follows the spindle is left out, what comes behind it is not",
          "[server][trace][ARC-6]") {
  TracedRig f;
  REQUIRE(f.rig.mdi("M3 S1000"));
  REQUIRE(f.rig.mdi("G33 Z-20 K1"));
  REQUIRE(f.rig.mdi("M5"));
  REQUIRE(f.rig.mdi("G0 X20"));
  const ReplayReport report = replayed(f.trace());
  CHECK_FALSE(report.difference);
  CHECK(report.following_spindle > 500);  // 20 revolutions at 1000 rpm: 1.2 s
  CHECK(report.compared > 300);
}

TEST_CASE("What the virtual board does otherwise is found, at its exchange", "[server][trace]") {
  TracedRig f;
  f.start_cut();
  f.rig.run_for(1.0);
  f.rig.simulation.virtual_machine().press_estop(true);
  f.rig.run_for(0.1);
  const Trace sound = f.trace();
  const std::size_t middle = sound.steps.size() / 2;

  SECTION("a position") {
    Trace trace = sound;
    trace.steps[middle].exchange.status.position[Axis::Y] += 0.1;
    const ReplayReport report = replayed(trace);
    REQUIRE(report.difference);
    CHECK(report.difference->step == middle);
    CHECK_THAT(report.difference->what, Contains("Y is at 0.1000, replayed 0.0000"));
  }
  SECTION("a segment that was lost on the way") {
    Trace trace = sound;
    const auto feeding =
        std::find_if(trace.steps.begin() + static_cast<std::ptrdiff_t>(middle), trace.steps.end(),
                     [](const Step& step) { return !step.requests.empty(); });
    REQUIRE(feeding != trace.steps.end());
    feeding->requests.erase(feeding->requests.begin());
    const ReplayReport report = replayed(trace);
    REQUIRE(report.difference);
    CHECK(report.difference->step >= middle);
    CHECK_THAT(report.difference->what, Contains("bad_segment"));
  }
  SECTION("a fault that did not come from what was recorded") {
    Trace trace = sound;
    for (Step& step : trace.steps) {
      hal::ControllerStatus& status = step.exchange.status;
      if (status.faults != 0) status.faults = static_cast<hal::Faults>(hal::Fault::fifo_underrun);
      status.inputs.estop1 = false;
    }
    const ReplayReport report = replayed(trace);
    REQUIRE(report.difference);
    CHECK_THAT(report.difference->what, Contains("faults are fifo_underrun, replayed none"));
  }
}

namespace {

/// A card's input 3 (port 103), and a rule on it.
struct GuardedTrace {
  static constexpr std::size_t kInput = hal::kAuxCount + 2;

  GuardedTrace(std::int32_t compare, config::GuardAction action, bool on)
      : rig(guarded(compare, action), with_card(ring, on)) {}

  static MachineData guarded(std::int32_t compare, config::GuardAction action) {
    MachineData data = free_machine();
    data.config.guards[4] = {"A door", 4, compare, action};
    return data;
  }
  static SimulationOptions with_card(Ring& ring, bool on) {
    SimulationOptions options = traced(ring);
    options.machine.io_cards[0] = true;
    options.machine.ports_on = on ? std::uint64_t{1} << kInput : 0;
    return options;
  }
  void set_input(bool on) { rig.simulation.virtual_machine().set_port_input(kInput, on); }
  void start_cut() {
    REQUIRE(rig.reset());
    rig.start("M3 S12000\nM8\nG1 X100 F1200\nX0\n");
    REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 5.0; }));
  }
  [[nodiscard]] Trace trace() const {
    auto parsed = parse_trace(
        trace_bytes(about_machine(rig.machine.config(), "virtual board"), ring.copy()), "trace");
    REQUIRE(parsed);
    return std::move(*parsed);
  }

  Ring ring;
  Rig rig;
};

}  // namespace

TEST_CASE("Guard rules do in a replay what they did, and nothing at its beginning",
          "[server][trace][CFG-16]") {
  struct Row {
    const char* name;
    std::int32_t compare;
    config::GuardAction action;
    bool on_before;
    std::vector<std::string> faults;
  };
  using enum config::GuardAction;
  const Row rows[] = {
      {"a quick stop when the input goes on", 4, quick_stop, false, {"guard_stop"}},
      {"a quick stop when the input goes off", 0, quick_stop, true, {"guard_stop"}},
      {"a warning when the input goes off", 0, warning, true, {}},
      {"a smooth stop when the input goes off", 0, smooth_stop, true, {}},
      {"a warning that was true before it all began", 4, warning, true, {}},
  };
  const Row& row = rows[GENERATE(range(0, 5))];
  CAPTURE(row.name);
  GuardedTrace f(row.compare, row.action, row.on_before);
  f.start_cut();
  f.set_input(!row.on_before);
  f.rig.run_for(1.0);
  const Trace trace = f.trace();
  const ReplayReport report = replayed(trace);
  CHECK_FALSE(report.difference);
  CHECK(faults_of(report) == row.faults);
  CHECK(report.compared > 500);
}

TEST_CASE("A card's input that flickers shorter than an exchange makes its rule act again",
          "[server][trace][CFG-16]") {
  GuardedTrace f(4, config::GuardAction::quick_stop, false);
  f.start_cut();
  f.set_input(true);
  auto& board = f.rig.simulation.virtual_controller().board();
  board.advance_to(board.now() + 0.0005);
  f.set_input(false);
  f.rig.run_for(0.5);
  const ReplayReport report = replayed(f.trace());
  CHECK_FALSE(report.difference);
  CHECK(faults_of(report) == std::vector<std::string>{"guard_stop"});
}

TEST_CASE("Outputs, guard rules and late cuts that the replay does not show are differences",
          "[server][trace]") {
  struct Row {
    const char* says;
    void (*spoil)(hal::ControllerStatus&);
  };
  const Row rows[] = {
      {"flood is off, replayed on", [](auto& status) { status.outputs.flood = false; }},
      {"mist is on, replayed off", [](auto& status) { status.outputs.mist = true; }},
      {"the output for the drives is off, replayed on",
       [](auto& status) { status.outputs.drives_enabled = false; }},
      {"output 1 is on, replayed off", [](auto& status) { status.outputs.ports[0] = true; }},
      {"output 101 is on, replayed off", [](auto& status) { status.outputs.ports[16] = true; }},
      {"output 308 is on, replayed off", [](auto& status) { status.outputs.ports[39] = true; }},
      {"guard rule 6 of card 1 has acted 1 times since the beginning, replayed 0",
       [](auto& status) { ++status.guard_counts[5]; }},
      {"the last cut was late, replayed in time", [](auto& status) { status.cut_late = true; }},
  };
  GuardedTrace f(4, config::GuardAction::warning, false);
  f.start_cut();
  f.rig.run_for(0.5);
  const Trace sound = f.trace();
  CHECK_FALSE(replayed(sound).difference);
  for (const Row& row : rows) {
    CAPTURE(row.says);
    Trace trace = sound;
    const std::size_t step = trace.steps.size() - 50;  // a job is running
    row.spoil(trace.steps[step].exchange.status);
    const ReplayReport report = replayed(trace);
    REQUIRE(report.difference);
    CHECK(report.difference->step == step);
    CHECK(report.difference->what == row.says);
    CHECK(report.late_cuts == (trace.steps[step].exchange.status.cut_late ? 1U : 0U));
  }
}

TEST_CASE("A trace in which nothing can begin says so", "[server][trace]") {
  TracedRig f;
  f.start_cut();
  Trace trace = f.trace(0.1);  // less than a FIFO
  const auto report = replay(trace);
  REQUIRE_FALSE(report);
  CHECK(report.error().code == ErrorCode::trace_cannot_begin);
}

TEST_CASE("Exchanges carry the machine's state and line", "[server][trace]") {
  TracedRig f;
  f.start_cut();
  const Exchange last = f.trace().steps.back().exchange;
  CHECK(last.machine_state == static_cast<std::uint32_t>(State::running));
  CHECK(last.line == 2);
}

TEST_CASE("The machine tells its listener why the board stopped", "[server][trace][LNK-4]") {
  struct Row {
    void (*happens)(TracedRig&);
    std::vector<std::string> told;
  };
  const Row rows[] = {
      {[](TracedRig& f) { f.rig.simulation.virtual_machine().press_estop(true); }, {"estop"}},
      {[](TracedRig& f) { f.board().trouble().cable_out = true; }, {"link_lost"}},
      {[](TracedRig& f) { f.board().board().reset(); }, {"link_lost", "board_reset"}},
  };
  const Row& row = rows[GENERATE(range(0, 3))];
  TracedRig f;
  std::vector<std::string> told;
  f.rig.machine.set_fault_listener([&](std::string_view name) { told.emplace_back(name); });
  f.start_cut();
  row.happens(f);
  f.rig.run_for(0.5);
  CHECK(told == row.told);
}

namespace {

/// Files of a ring with one exchange.
struct KeeperFixture {
  KeeperFixture() { ring.write(Exchange{}); }

  [[nodiscard]] TraceKeeperSettings settings(std::filesystem::path in) const {
    return {.folder = std::move(in),
            .aftermath = std::chrono::milliseconds(0),
            .pause = std::chrono::milliseconds(0),
            .rest = std::chrono::milliseconds(0)};
  }
  /// Behind everything that was asked for before.
  static Result<std::filesystem::path> save(TraceKeeper& keeper) {
    std::promise<Result<std::filesystem::path>> saved;
    keeper.save_now([&](const auto& result) { saved.set_value(result); });
    return saved.get_future().get();
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "traces"))
      found.push_back(entry.path().filename().string());
    std::ranges::sort(found);
    return found;
  }

  cnc::config::test::TemporaryDirectory folder;
  Ring ring{1024};
  MessageLog log;
};

}  // namespace

TEST_CASE("A fault leaves a file that tells what it is, and the log says where",
          "[server][trace][threads]") {
  KeeperFixture f;
  TraceKeeper keeper(f.ring, f.log, {.server = "1.2.3", .board = "a board"},
                     f.settings(f.folder.path() / "traces"));
  keeper.save_after_fault("estop, link_lost");
  const auto asked = f.save(keeper);
  REQUIRE(asked);
  const auto names = f.names();
  REQUIRE(names.size() == 2);
  CHECK_THAT(names[0], Catch::EndsWith("Z_estop.trace"));
  CHECK(asked->filename() == names[1]);
  CHECK_THAT(names[1], Catch::EndsWith("Z_asked_for.trace"));
  const auto trace = read_trace(f.folder.path() / "traces" / names[0]);
  REQUIRE(trace);
  CHECK(trace->about.reason == "estop, link_lost");
  CHECK(trace->about.server == "1.2.3");
  CHECK(trace->about.board == "a board");
  REQUIRE(f.log.newest() == 1);
  CHECK_THAT(f.log.after(0)[0].text, Contains(names[0]));
}

TEST_CASE("The newest ten traces stay, and other files are left alone",
          "[server][trace][threads]") {
  KeeperFixture f;
  const auto traces = f.folder.path() / "traces";
  std::filesystem::create_directories(traces);
  cnc::config::test::put(traces / "notes.txt", "mine");
  TraceKeeper keeper(f.ring, f.log, {}, f.settings(traces));
  std::vector<std::string> written;
  for (int i = 0; i < 13; ++i) {
    written.push_back(f.save(keeper)->filename().string());
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // names have milliseconds
  }
  std::vector<std::string> expected(written.end() - 10, written.end());
  expected.emplace_back("notes.txt");
  CHECK(f.names() == expected);
}

TEST_CASE("Traces that were asked for do not push out one of a fault", "[server][trace][threads]") {
  KeeperFixture f;
  TraceKeeper keeper(f.ring, f.log, {}, f.settings(f.folder.path() / "traces"));
  keeper.save_after_fault("estop");
  for (int i = 0; i < 12; ++i) {
    REQUIRE(f.save(keeper));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // names have milliseconds
  }
  const auto names = f.names();
  CHECK(names.size() == 11);
  CHECK_THAT(names[0], Catch::EndsWith("_estop.trace"));
}

TEST_CASE("A folder that cannot be written is one warning", "[server][trace][threads]") {
  KeeperFixture f;
  const auto file = f.folder.path() / "traces";
  cnc::config::test::put(file, "a file in the folder's place");
  TraceKeeper keeper(f.ring, f.log, {}, f.settings(file));
  for (int i = 0; i < 3; ++i) {
    keeper.save_after_fault("estop");
    const auto asked = f.save(keeper);
    REQUIRE_FALSE(asked);
    CHECK(asked.error().code == ErrorCode::file_not_writable);
  }
  REQUIRE(f.log.newest() == 1);
  CHECK(f.log.after(0)[0].severity == Severity::warning);
  CHECK_THAT(f.log.after(0)[0].text, Contains(file.string()));
}

TEST_CASE("A contact that flickers writes one trace", "[server][trace][threads]") {
  KeeperFixture f;
  auto settings = f.settings(f.folder.path() / "traces");
  settings.pause = std::chrono::hours(1);
  TraceKeeper keeper(f.ring, f.log, {}, settings);
  for (int i = 0; i < 5; ++i) {
    keeper.save_after_fault("estop");
    REQUIRE(f.save(keeper));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(std::ranges::count_if(f.names(), [](const std::string& name) {
          return name.ends_with("_estop.trace");
        }) == 1);
}

TEST_CASE("Who asks for traces in a loop gets the same file, and faults still get theirs",
          "[server][trace][threads]") {
  KeeperFixture f;
  auto settings = f.settings(f.folder.path() / "traces");
  settings.rest = std::chrono::hours(1);
  TraceKeeper keeper(f.ring, f.log, {}, settings);
  const auto first = f.save(keeper);
  REQUIRE(first);
  for (int i = 0; i < 5; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const auto again = f.save(keeper);
    REQUIRE(again);
    CHECK(*again == *first);
  }
  // One that was asked for before a fault does not show it.
  keeper.save_after_fault("estop");
  CHECK(f.save(keeper).value() != *first);
  CHECK(f.names().size() == 3);
}

TEST_CASE("A trace that could not be written is tried again at once", "[server][trace][threads]") {
  KeeperFixture f;
  const auto folder = f.folder.path() / "traces";
  cnc::config::test::put(folder, "a file in the folder's place");
  auto settings = f.settings(folder);
  settings.rest = std::chrono::hours(1);
  TraceKeeper keeper(f.ring, f.log, {}, settings);
  REQUIRE_FALSE(f.save(keeper));
  std::filesystem::remove(folder);
  CHECK(f.save(keeper));
}
