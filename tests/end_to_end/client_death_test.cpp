// A client that dies or hangs: what it held stops, what it started goes on (ARC-1, MAN-1, STA-9).
#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::api;
using namespace cnc::test;

namespace {

Process start_client(const ServerFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {E2E_CLIENT, folder.address()});
  return {arguments, folder.file("client")};
}

}  // namespace

TEST_CASE("A jog stops when its client is killed or hangs", "[MAN-1][STA-9][safety][e2e]") {
  const int blow = GENERATE(SIGKILL, SIGSTOP);
  INFO("signal " << blow);
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.mdi("G53 G0 X0"));
  const Process client = start_client(folder, {"jog"});
  const bool jogs = server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::jogging && status.velocity[Axis::X] > 19.9;
  });
  INFO(client.err());
  REQUIRE(jogs);
  client.signal(blow);
  const double struck = server.watcher.newest().time;
  REQUIRE(server.watcher.sees(MachineState::ready));
  // The lease 0.25 s, what the link has 0.06 s, the ramp 20 / 500 s; the rest is for a computer
  // that is busy with other tests.
  CHECK(server.watcher.newest().time - struck < 0.25 + 0.06 + 0.04 + 0.5);
  CHECK(server.watcher.newest().machine_position[Axis::X] < 60.0);  // the limit is at 80
}

TEST_CASE("A job goes on when the client that started it is killed", "[ARC-1][STA-9][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  const std::string job = folder.write_job("G53 G0 X0\nG91 G1 X40 F1200\nM30\n");
  const Process client = start_client(folder, {"run", job});
  REQUIRE(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::running && status.machine_position[Axis::X] > 5.0;
  }));
  client.signal(SIGKILL);
  REQUIRE(server.watcher.sees([](const MachineStatus& status) { return status.job.runs == 1; }));
  CHECK(server.watcher.newest().job.ended_well);
  CHECK(server.watcher.newest().machine_position[Axis::X] == Approx(40.0).margin(1e-6));
}

TEST_CASE("A single line stops when the client that waits for it gives it up", "[MAN-5][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.mdi("G53 G0 X0"));
  std::stop_source give_up;
  Result<void> answer;
  std::jthread caller([&] { answer = server.client.mdi("G91 G1 X70 F600", give_up.get_token()); });
  REQUIRE(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::mdi && status.machine_position[Axis::X] > 2.0;
  }));
  give_up.request_stop();
  caller.join();
  REQUIRE_FALSE(answer);
  CHECK(answer.error().kind == ErrorKind::cancelled);
  REQUIRE(server.watcher.sees(MachineState::ready));
  CHECK(server.watcher.newest().machine_position[Axis::X] < 69.0);
}
