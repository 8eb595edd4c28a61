// A replay of what was recorded here does the same again, wherever the record begins (LNK-4).
#include "hal/trace/replay.h"

#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "config/ini_file.h"
#include "hal/trace/ring.h"
#include "hal/trace/traced_controller.h"
#include "tests/hal/machine_support.h"

namespace cnc::hal::trace {
namespace {

constexpr double kCycle = 0.002;  // s
constexpr auto kHomeSwitch = sim::VirtualMotor::Switch::home;
constexpr std::size_t kInput = kAuxCount;  // the first of card 1

/// A run-up to 10 mm/s takes half a second. Card 1 has two rules on its first input: one warns when
/// it goes on, the other when it goes off.
config::MachineConfig slow_machine() {
  config::MachineConfig machine = sim::small_machine();
  machine.axes[Axis::X].acceleration = 20.0;
  machine.guards[0] = {"on", 1, 1, config::GuardAction::warning};
  machine.guards[1] = {"off", 1, 0, config::GuardAction::warning};
  return machine;
}

/// A machine of which everything is recorded.
class Recording {
 public:
  explicit Recording(bool input_on = false)
      : Recording(sim::make_virtual_controller(
            slow_machine(),
            {.machine = {.start = Position{},
                         .ports_on = std::uint64_t{input_on ? 1U : 0U} << kInput}})) {}

  Controller& controller() { return controller_; }
  sim::VirtualMachine& machine() { return board_.machine(); }
  const ControllerStatus& exchange() { return controller_.exchange(now_ += kCycle); }
  void run_for(double time) {
    for (const double end = now_ + time; now_ < end;) exchange();
  }
  /// The board sees it, the host does not.
  void bounce(const std::vector<bool>& levels) {
    for (const bool on : levels) {
      board_.machine().set_port_input(kInput, on);
      board_.board().advance_to(board_.board().now() + 0.0002);  // two of its slices
    }
  }
  /// The board sees it a third of an exchange before the host does.
  template <typename Change>
  void meet(Change change) {
    board_.board().advance_to(board_.board().now() + kCycle * 2.0 / 3.0);
    change();
  }
  /// Along X at 10 mm/s, from standstill to standstill.
  void push_way(std::uint32_t first_id, std::uint32_t count, double duration) {
    Position place = controller_.exchange(now_).position;
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool is_end = i == 0 || i + 1 == count;
      place[Axis::X] += 10.0 * duration * (is_end ? 0.5 : 1.0);
      Segment segment{.id = first_id + i, .duration = duration, .position = place};
      segment.velocity[Axis::X] = i + 1 < count ? 10.0 : 0.0;
      REQUIRE(controller_.push({&segment, 1}) == 1);
    }
  }
  [[nodiscard]] Trace trace() const {
    About about;
    about.config = config::machine_config_text(slow_machine());
    auto parsed = parse_trace(trace_bytes(about, ring_.copy()), "trace");
    REQUIRE(parsed);
    return std::move(*parsed);
  }

 private:
  explicit Recording(std::unique_ptr<sim::VirtualController> board)
      : board_(*board), controller_(std::move(board), ring_) {
    REQUIRE(controller_.connect());
    run_for(0.02);
  }

  Ring ring_;
  sim::VirtualController& board_;
  TracedController controller_;
  double now_ = 1000.0;
};

ReplayReport reproduced(const Trace& trace) {
  const auto report = replay(trace);
  if (!report) UNSCOPED_INFO(report.error().message);
  REQUIRE(report);
  if (report->difference) UNSCOPED_INFO(report->difference->what);
  CHECK_FALSE(report->difference);
  CHECK(report->compared > 20);
  return *report;
}

TEST_CASE("A card's contact that bounces between two statuses does so in the replay",
          "[hal][trace][CFG-16]") {
  struct Row {
    const char* name;
    bool on_before;
    std::vector<bool> levels;
    int on_acts;
    int off_acts;
  };
  const Row rows[] = {
      {"goes on", false, {true}, 1, 0},
      {"goes on and bounces", false, {true, false, true}, 2, 1},
      {"goes off and bounces", true, {false, true, false}, 1, 2},
      {"is touched once", false, {true, false}, 1, 1},
      {"is touched twice", false, {true, false, true, false}, 2, 2},
      {"lets go three times", true, {false, true, false, true, false, true}, 3, 3},
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    Recording recording(row.on_before);
    const auto before = recording.exchange().guard_counts;
    recording.bounce(row.levels);
    const auto after = recording.exchange().guard_counts;
    CHECK(after[0] - before[0] == row.on_acts);
    CHECK(after[1] - before[1] == row.off_acts);
    recording.run_for(0.05);
    reproduced(recording.trace());
  }
}

TEST_CASE("Where the last cut was late no replay begins", "[hal][trace]") {
  Recording recording;
  Controller& controller = recording.controller();
  recording.push_way(1, 3, 0.01);
  recording.run_for(0.016);
  controller.cut_behind(1);  // the second is in execution
  recording.run_for(0.05);
  REQUIRE(recording.exchange().cut_late);
  REQUIRE_FALSE(recording.exchange().moving);
  controller.quick_stop();  // forgets the path, and with it the cut
  recording.run_for(0.02);
  recording.push_way(4, 3, 0.01);
  recording.run_for(0.1);

  Trace trace = recording.trace();
  const auto is_late = [](const Step& step) { return step.exchange.status.cut_late; };
  const auto first = std::ranges::find_if(
      trace.steps, [&](const Step& step) { return is_late(step) && !step.exchange.status.moving; });
  trace.steps.erase(trace.steps.begin(), first);
  REQUIRE(is_late(trace.steps.front()));
  const ReplayReport report = reproduced(trace);
  CHECK_FALSE(is_late(trace.steps[report.begin]));
  CHECK(report.late_cuts == 0);
}

TEST_CASE("A run-up needs numbers for its segments, above 0", "[hal][trace]") {
  Recording recording;
  recording.push_way(1, 20, 0.1);
  recording.run_for(2.2);

  Trace trace = recording.trace();
  const auto feeding =
      std::ranges::find_if(trace.steps, [](const Step& step) { return !step.requests.empty(); });
  const auto moving = std::ranges::find_if(
      trace.steps, [](const Step& step) { return step.exchange.status.moving; });
  REQUIRE(moving != trace.steps.end());
  REQUIRE(feeding <= moving);
  if (feeding != moving) moving->requests.swap(feeding->requests);
  trace.steps.erase(trace.steps.begin(), moving);
  const ReplayReport report = reproduced(trace);
  CHECK(report.in_motion);
  // Half a second is five pieces of 0.1 s: up to the fifth segment there are not as many numbers.
  CHECK(trace.steps[report.begin].exchange.status.executing_id == 5);
  CHECK(report.compared > 700);  // from 0.5 s to 2.2 s: 850 exchanges
}

/// The home switch of X and the probe are met on the way, at a moment between two statuses.
Trace trace_with_latches() {
  Recording recording;
  Controller& controller = recording.controller();
  controller.arm_home_latch(Axis::X, LatchEdge::activate);
  recording.push_way(1, 20, 0.1);
  recording.run_for(0.5);
  recording.meet([&] { recording.machine().stick_switch(Axis::X, kHomeSwitch, true); });
  recording.run_for(0.1);
  controller.arm_probe_latch();
  recording.run_for(0.1);
  recording.meet([&] { recording.machine().stick_probe(true); });
  recording.run_for(1.0);
  REQUIRE(recording.exchange().home_latch[Axis::X].caught);
  REQUIRE(recording.exchange().probe_latch.caught);
  REQUIRE(recording.exchange().path_stop == PathStop::stopped);
  return recording.trace();
}

TEST_CASE("What latches caught they catch in the replay", "[hal][trace][LNK-6]") {
  reproduced(trace_with_latches());
}

TEST_CASE("A latch that caught elsewhere, or nothing, differs", "[hal][trace][LNK-6]") {
  struct Row {
    std::string_view what;
    void (*change)(ControllerStatus&);
  };
  // 10 mm/s for 2 ms and two steps of 0.005 mm are tolerated.
  const Row row = GENERATE(values<Row>({
      {"the home latch of X has caught nothing, replayed something",
       [](ControllerStatus& status) { status.home_latch[Axis::X].caught = false; }},
      {"the home latch of X has caught X at",
       [](ControllerStatus& status) { status.home_latch[Axis::X].position += 0.05; }},
      {"the probe latch has caught nothing, replayed something",
       [](ControllerStatus& status) { status.probe_latch.caught = false; }},
      {"the probe latch has caught X at",
       [](ControllerStatus& status) { status.probe_latch.position[Axis::X] -= 0.05; }},
      {"the probe latch has caught Y at",
       [](ControllerStatus& status) { status.probe_latch.position[Axis::Y] = 1.0; }},
  }));
  CAPTURE(row.what);
  Trace trace = trace_with_latches();
  for (Step& step : trace.steps) row.change(step.exchange.status);
  const auto report = replay(trace);
  REQUIRE(report);
  REQUIRE(report->difference);
  CHECK_THAT(report->difference->what, Catch::StartsWith(std::string(row.what)));
}

}  // namespace
}  // namespace cnc::hal::trace
