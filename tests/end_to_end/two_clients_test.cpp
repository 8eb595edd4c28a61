// Several clients at once (ARC-1, ARC-2).
#include <catch2/catch.hpp>
#include <thread>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::api;
using namespace cnc::test;

TEST_CASE("Clients that call at once are all answered", "[ARC-2][e2e]") {
  const ServerFolder folder;
  const RunningServer server(folder);
  constexpr int kCalls = 200;
  std::array<int, 4> answered{};
  {
    std::vector<std::jthread> threads;
    for (int& count : answered) {
      threads.emplace_back([&folder, &count] {
        const auto client = Client::connect(folder.address());
        if (!client) return;
        for (int i = 0; i < kCalls; ++i) {
          const bool good =
              client->status() && client->set_overrides({.feed = 0.5}) && client->messages(0, 5);
          count += good;
        }
      });
    }
  }
  for (const int count : answered) CHECK(count == kCalls);
}

TEST_CASE("Of two clients that start the same job one is refused", "[ARC-2][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  const auto other = Client::connect(folder.address());
  REQUIRE(other);
  REQUIRE(server.client.load(folder.write_job("G91 G1 X50 F600\n")));
  std::array<bool, 2> started{};
  {
    const std::jthread first([&] { started[0] = server.client.run().has_value(); });
    const std::jthread second([&] { started[1] = other->run().has_value(); });
  }
  CHECK(started[0] != started[1]);
  REQUIRE(other->stop());
  CHECK(server.watcher.sees(MachineState::ready));
}

TEST_CASE("A client is refused a jog while a job runs", "[ARC-2][MAN-1][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  server.start_job("G53 G0 X0\nG91 G1 X60 F600\n");
  REQUIRE(server.watcher.sees(MachineState::running));
  const auto other = Client::connect(folder.address());
  REQUIRE(other);
  JogSession session = other->jog();
  static_cast<void>(session.set({{Axis::Y, 0.5}}));  // the answer comes with the next call
  const auto answer = session.finish();
  REQUIRE_FALSE(answer);
  CHECK(answer.error().kind == ErrorKind::refused);
  const auto step = other->jog_step(Axis::Y, 1.0);
  REQUIRE_FALSE(step);
  CHECK(step.error().name == "command_not_allowed");
  CHECK(server.watcher.newest().state == MachineState::running);
  REQUIRE(server.client.stop());
}
