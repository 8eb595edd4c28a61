// A server that is killed or told to end in the middle of a job (STA-9).
#include <catch2/catch.hpp>
#include <csignal>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::api;
using namespace cnc::test;
using namespace std::chrono_literals;

namespace {

constexpr const char* kLongJob = "G53 G0 X0\nG10 L2 P3 Y-4\nG91 G1 X70 F300\nM30\n";

void wait_for_the_cut(RunningServer& server) {
  REQUIRE(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::running && status.machine_position[Axis::X] > 1.0 &&
           status.programmed_feed > 0.0;
  }));
}

}  // namespace

TEST_CASE("A server that was killed starts again with what was saved, and nothing moves",
          "[STA-9][safety][e2e]") {
  const ServerFolder folder;
  {
    RunningServer server(folder);
    server.make_ready();
    REQUIRE(server.client.mdi("G10 L2 P2 X7"));
    server.start_job(kLongJob);
    wait_for_the_cut(server);
    server.process.signal(SIGKILL);
    REQUIRE(server.process.exit_code(kPatience) == 128 + SIGKILL);
  }
  RunningServer again(folder);  // on the dead server's lock and socket
  const MachineStatus begin = again.watcher.newest();
  CHECK(begin.homed == AxisFlags{});
  CHECK(begin.job.path.empty());
  REQUIRE(again.watcher.sees(
      [&](const MachineStatus& status) { return status.time > begin.time + 1.0; }));
  CHECK(again.watcher.newest().machine_position == begin.machine_position);
  CHECK(again.watcher.newest().state == MachineState::needs_reset);

  again.make_ready();
  REQUIRE(again.client.mdi("G55"));
  const auto status = again.client.status();
  REQUIRE(status);
  CHECK(status->machine_position[Axis::X] - status->work_position[Axis::X] == Approx(7.0));
}

TEST_CASE("A server that is told to end in the middle of a job stops, saves and ends well",
          "[STA-9][e2e]") {
  const ServerFolder folder;
  {
    RunningServer server(folder);
    server.make_ready();
    server.start_job(kLongJob);
    wait_for_the_cut(server);
    server.process.signal(SIGTERM);
    CHECK(server.process.exit_code(6s) == 0);
    CHECK_FALSE(std::filesystem::exists(folder.socket()));
  }
  CHECK_THAT(config::test::content_of(folder.data() + "/parameters.txt"),
             Catch::Contains("5262 -4"));  // Y of system 3: 5221 + 2 · 20 + 1
}
