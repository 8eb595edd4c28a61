// A job from the start of the server to its end, as an operator runs it and an observer sees it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::api;
using namespace cnc::test;
using namespace std::chrono_literals;

namespace {

/// The states that stay for long enough to be seen at 100 statuses per second.
std::vector<MachineState> lasting(const std::vector<MachineState>& states) {
  std::vector<MachineState> result;
  for (const MachineState state : states) {
    const bool passing = state == MachineState::pausing || state == MachineState::stopping;
    if (!passing && (result.empty() || result.back() != state)) result.push_back(state);
  }
  return result;
}

bool stands(const MachineStatus& status) { return status.velocity == AxisValues{}; }

}  // namespace

TEST_CASE("A job with tool change and pause, seen alike by operator and observer",
          "[ARC-1][ARC-2][JOB-1][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  const auto observer = Client::connect(folder.address());
  REQUIRE(observer);
  Watcher observed(*observer);
  REQUIRE(observed.sees(MachineState::needs_reset));
  server.make_ready();
  REQUIRE(server.client.mdi("G10 L2 P1 X0 Y0 Z0"));

  server.start_job("M3 S6000\nG0 X10 Y10\nT2 M6\nG1 X50 F1200\nG1 Y30\nM5\nM30\n");
  REQUIRE(server.watcher.sees(MachineState::tool_change));
  CHECK(server.watcher.newest().tool == 2);
  CHECK(server.watcher.newest().spindle == SpindleDirection::off);
  CHECK(server.watcher.newest().availability(Command::resume).allowed);
  CHECK_FALSE(server.watcher.newest().availability(Command::load).allowed);
  REQUIRE(observed.sees(MachineState::tool_change));
  REQUIRE(server.client.resume());

  REQUIRE(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::running && status.machine_position[Axis::X] > 15.0;
  }));
  REQUIRE(server.client.pause());
  REQUIRE(server.watcher.sees(
      [](const MachineStatus& status) { return status.state == MachineState::paused; }));
  const MachineStatus paused = server.watcher.newest();
  CHECK(stands(paused));
  REQUIRE(server.watcher.sees(
      [&](const MachineStatus& status) { return status.time > paused.time + 0.3; }));
  CHECK(server.watcher.newest().machine_position == paused.machine_position);
  REQUIRE(server.client.resume());

  REQUIRE(server.watcher.sees([](const MachineStatus& status) { return status.job.runs == 1; }));
  REQUIRE(server.watcher.sees(MachineState::ready));
  const MachineStatus end = server.watcher.newest();
  CHECK(end.job.ended_well);
  // The board can only stand on a step: 1/200 mm.
  CHECK(end.machine_position[Axis::X] == Approx(50.0).margin(0.005));
  CHECK(end.machine_position[Axis::Y] == Approx(30.0).margin(0.005));
  CHECK(end.spindle == SpindleDirection::off);

  REQUIRE(observed.sees([](const MachineStatus& status) {
    return status.job.runs == 1 && status.state == MachineState::ready;
  }));
  const std::vector<MachineState> job{MachineState::running, MachineState::tool_change,
                                      MachineState::running, MachineState::paused,
                                      MachineState::running, MachineState::ready};
  for (const Watcher* watcher : {&observed, &server.watcher}) {
    const auto seen = lasting(watcher->states());
    REQUIRE(seen.size() > job.size());
    CHECK(std::vector(seen.end() - static_cast<std::ptrdiff_t>(job.size()), seen.end()) == job);
  }
}

TEST_CASE("At 200 % feed a cut takes half the time", "[MAN-8][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.load(folder.write_job("G91 G1 X30 F900\nG1 X-30\nM30\n")));
  const auto time_of_a_run = [&] {
    const auto runs = server.watcher.newest().job.runs;
    REQUIRE(server.client.run());
    REQUIRE(server.watcher.sees(
        [&](const MachineStatus& status) { return status.job.runs == runs + 1; }));
    return server.watcher.newest().job.elapsed;
  };
  const double normal = time_of_a_run();
  const auto set = server.client.set_overrides({.feed = 2.0});
  REQUIRE(set);
  CHECK(set->feed == 2.0);
  const double fast = time_of_a_run();
  // 30 mm there and back at v: 60/v and a stop at the turning point: 2 v/a, a = 500 mm/s²; a cycle
  // or two of 5 ms on either side, more on a busy computer.
  CHECK(normal == Approx(60.0 / 15.0 + 2.0 * 15.0 / 500.0).margin(0.5));
  CHECK(fast == Approx(60.0 / 30.0 + 2.0 * 30.0 / 500.0).margin(0.5));
}

TEST_CASE("A wrong line is shown before the run and named when the run gets there",
          "[JOB-2][LNG-10][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  const auto loaded = server.client.load(folder.write_job("G91 G0 X1\nG0 X1\nG77\nM30\n"));
  REQUIRE(loaded);
  CHECK(loaded->lines == 4);
  REQUIRE(
      server.watcher.sees([](const MachineStatus& status) { return status.job.problems == 1; }));
  const auto problems = server.client.problems();
  REQUIRE(problems);
  REQUIRE(problems->problems.size() == 1);
  CHECK(problems->problems[0].error.place->line == 3);
  CHECK(problems->problems[0].line_text == "G77");

  const double before = server.watcher.newest().machine_position[Axis::X];
  REQUIRE(server.client.run());
  REQUIRE(server.watcher.sees([](const MachineStatus& status) { return status.job.runs == 1; }));
  CHECK_FALSE(server.watcher.newest().job.ended_well);
  CHECK(server.watcher.newest().machine_position[Axis::X] == Approx(before + 2.0).margin(0.005));
  const auto messages = server.client.messages();
  REQUIRE(messages);
  REQUIRE(messages->back().error);
  CHECK(messages->back().error->name == "unknown_g_code");
  CHECK(messages->back().error->place->line == 3);
  CHECK(messages->back().error->place->file == folder.file("job.nc"));
}

TEST_CASE("An emergency stop leaves a trace of the link, and one is written when asked for",
          "[LNK-4][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.simulate_estop(true));
  REQUIRE(server.watcher.sees(MachineState::estop));
  const auto asked = server.client.save_link_trace();
  REQUIRE(asked);
  CHECK_THAT(*asked, Catch::StartsWith(folder.data() + "/traces/"));
  CHECK(std::filesystem::file_size(*asked) > 1000);
  // The keeper does one thing after another: the fault's came first.
  const auto messages = server.client.messages();
  REQUIRE(messages);
  CHECK(std::ranges::any_of(*messages, [](const Message& message) {
    return message.text.find("_estop.trace") != std::string::npos;
  }));
}

TEST_CASE("Emergency stop, refused reset, reset", "[STA-4][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.simulate_estop(true));
  REQUIRE(server.watcher.sees(MachineState::estop));
  const auto refused = server.client.reset();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().name == "estop_pressed");
  const auto not_now = server.client.run();
  REQUIRE_FALSE(not_now);
  CHECK(not_now.error().kind == ErrorKind::refused);
  REQUIRE(server.client.simulate_estop(false));
  REQUIRE(server.client.reset());
  // The drives were off: the operator homes, or has looked where the axes stand.
  REQUIRE(server.watcher.sees(MachineState::needs_homing));
  REQUIRE(server.client.accept_position());
  CHECK(server.watcher.sees(MachineState::ready));
}
