#include "server/machine/obstacle_watch.h"

#include <catch2/catch.hpp>

#include "server/machine/machine.h"
#include "tests/server/recording_controller.h"

using namespace cnc;
using namespace cnc::server;
using Kind = hal::LinkObstacle::Kind;

TEST_CASE("What keeps the board away is told once, when it lasts, and again after it was there",
          "[server][LNK-1][LNK-9]") {
  ObstacleWatch watch;
  double now = 10.0;
  // What is told within `time`.
  const auto told = [&](const hal::LinkObstacle& obstacle, double time) {
    std::vector<ErrorCode> codes;
    for (const double until = now + time; now < until; now += 0.005)
      if (const auto error = watch.look(obstacle, now)) codes.push_back(error->code);
    return codes;
  };
  using Codes = std::vector<ErrorCode>;
  const hal::LinkObstacle slow{Kind::too_slow, 0, 100'000, 125'000};
  CHECK(told({}, 10.0).empty());
  CHECK(told({Kind::busy}, 1.9).empty());  // a board that still brakes
  CHECK(told({}, 10.0).empty());
  CHECK(told(slow, 10.0) == Codes{ErrorCode::board_unsuitable});
  CHECK(told({Kind::silent}, 10.0) == Codes{ErrorCode::board_silent});
  CHECK(told({}, 0.1).empty());
  CHECK(told({Kind::silent}, 10.0) == Codes{ErrorCode::board_silent});
}

TEST_CASE("The machine's messages say why its board is not there", "[server][LNK-1][LNK-9]") {
  test::Recording recording;
  auto controller = std::make_unique<test::RecordingController>(recording);
  recording.status.connected = false;
  recording.status.obstacle = {Kind::other_version, 8, 9, 1};
  Link link(std::move(controller));
  MessageLog log;
  Machine machine({}, link, log);
  for (double now = 0.0; now < 5.0; now += 0.005) {
    link.cycle(now);
    machine.cycle(now);
  }
  CHECK(machine.state() == State::off);
  const auto messages = log.after(0);
  REQUIRE(messages.size() == 1);
  REQUIRE(messages[0].error);
  CHECK(messages[0].error->code == ErrorCode::board_version);
  CHECK_THAT(messages[0].text, Catch::Contains("speaks versions 8 to 9 of the protocol"));
}
