// A cut that is late on a path of so many short segments that the board holds only the beginning
// (LNK-8): what the link had dropped is planned anew, and no cut asks for a place that the board
// never had.
#include "server/machine/motion_feed.h"

#include <catch2/catch.hpp>
#include <fmt/core.h>

#include "tests/hal/machine_support.h"
#include "tests/server/recording_controller.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr std::uint32_t kBoardHolds = 256;
constexpr std::uint32_t kSent = 900;
constexpr double kShort = 0.00025;  // s
constexpr double kSpeed = 0.001;    // mm/s: no axis minds beginning with it
constexpr std::uint32_t kExecuting = 3;

/// 900 segments are sent, the board has the first 256 and executes the third of them.
struct DensePath {
  DensePath() {
    recording.room = kBoardHolds;
    for (std::uint32_t i = 0; i < kSent; ++i) emit();
    recording.status.moving = true;
    recording.status.executing_id = kExecuting;
    recording.status.executing_phase = 0.5;
    cycle();
  }
  void emit() {
    motion::Setpoint setpoint;
    setpoint.duration = kShort;
    setpoint.position = feed.commanded();
    setpoint.position[Axis::X] += kSpeed * kShort;
    setpoint.velocity[Axis::X] = kSpeed;
    REQUIRE(feed.emit(setpoint));
  }
  void cycle() {
    link.cycle(now += 0.002);
    feed.update();
  }
  /// Is answered as the board is told to; 20 segments of the new path go with it.
  CutAnswer cut(std::size_t count) {
    feed.begin_cut(count);
    behind = feed.last_id();
    for (int i = 0; i < 20; ++i) emit();
    clock += planning;
    feed.commit_cut();
    cycle();
    cycle();
    return feed.cut_answer();
  }

  config::MachineConfig config = hal::sim::small_machine();
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};
  double clock = 0.0;     // s
  double planning = 0.0;  // s that it goes on while a cut is made
  MotionFeed feed{link, config, [this] { return clock; }};
  double now = 0.0;
  std::uint32_t behind = 0;  // the last cut
};

}  // namespace

TEST_CASE("However often a cut is late, none is made behind what the board has",
          "[LNK-8][JOB-8][safety]") {
  DensePath path;
  path.recording.status.cut_late = true;
  // 2 x 2 ms + 1 ms, and after each late one twice that: from 80 ms on it is more than the 63 ms
  // that the board has.
  std::uint32_t before = 0;
  for (int times = 0; times < 7; ++times) {
    CAPTURE(times);
    REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::late);
    CHECK(path.feed.last_id() == kSent);
    CHECK(path.behind > kExecuting);
    CHECK(path.behind <= kBoardHolds);
    CHECK(path.behind >= before);
    CHECK(path.recording.calls.back() == fmt::format("cut behind {}", path.behind));
    before = path.behind;
  }
  CHECK(path.behind == kBoardHolds);
  // One that is taken ends it: the link has all of the new path.
  path.recording.status.cut_late = false;
  path.recording.room = 1000;
  REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::taken);
  CHECK(path.behind == kBoardHolds);
  path.recording.status.path_stop = hal::PathStop::stopping;
  path.cycle();
  CHECK(path.feed.replaceable() == 0);
}

TEST_CASE("Behind a late cut the path that the board brakes along goes on where the board has it",
          "[LNK-8][CFG-16][safety]") {
  DensePath path;
  const std::size_t count = path.feed.replaceable();
  path.recording.status.cut_late = true;
  path.recording.status.path_stop = hal::PathStop::stopping;
  REQUIRE(path.cut(count) == CutAnswer::late);
  REQUIRE(path.behind < kBoardHolds);
  CHECK(path.feed.replaceable() == kSent - kBoardHolds);
  path.recording.status.cut_late = false;
  path.recording.room = 0;  // the link's queue begins with what it sent with the late cut
  const std::size_t calls = path.recording.calls.size();
  REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::taken);
  CHECK(path.behind == kBoardHolds);
  CHECK(path.recording.calls[calls] == fmt::format("cut behind {}", kBoardHolds));
  path.recording.room = 5;
  path.cycle();
  CHECK(path.recording.calls.size() == calls + 1 + 5);
}

TEST_CASE("A cut leaves the time that planning anew took the last time", "[LNK-8][MOT-3][safety]") {
  DensePath path;
  path.recording.room = 10 * kSent;
  const std::size_t before = path.feed.replaceable();
  path.planning = 0.008;
  REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::taken);
  for (std::size_t i = 20; i < before; ++i) path.emit();
  path.planning = 0.0;
  // 8 ms of segments of 0.25 ms more are kept; next time half as many.
  const std::size_t sent = path.feed.under_way();
  const std::size_t kept_at_first = kSent - kExecuting - before;
  CHECK(sent - path.feed.replaceable() == kept_at_first + 32);
  REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::taken);
  CHECK(path.feed.under_way() - path.feed.replaceable() == kept_at_first + 16);
}

TEST_CASE("A quick stop forgets what the board had of a path", "[LNK-8][safety]") {
  DensePath path;
  path.recording.status.cut_late = true;
  REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::late);
  path.recording.status.path_stop = hal::PathStop::stopping;
  path.cycle();
  REQUIRE(path.feed.replaceable() == kSent - kBoardHolds);
  path.feed.quick_stop();
  CHECK(path.feed.replaceable() == 0);
}

TEST_CASE("Where the board has only a part of what brings the motors to rest, the rest begins anew",
          "[LNK-8][MOT-5][safety]") {
  config::MachineConfig config = hal::sim::small_machine();
  config.axes[Axis::X].backlash = 0.1;
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};
  MotionFeed feed{link, config};
  std::vector<motion::Setpoint> motors;
  feed.set_motor_listener([&](const motion::Setpoint& setpoint) { motors.push_back(setpoint); });
  const auto go = [&](double x) {
    motion::Setpoint setpoint;
    setpoint.duration = 0.005;
    setpoint.position = feed.commanded();
    setpoint.position[Axis::X] = x;
    REQUIRE(feed.emit(setpoint));
  };
  const auto cut = [&](bool late) {
    recording.status.cut_late = late;
    feed.begin_cut(feed.replaceable());
    feed.commit_cut();
    for (int i = 0; i < 2; ++i) {
      link.cycle(0.0);
      feed.update();
    }
    return feed.cut_answer();
  };
  // Up and back again: the play of 0.1 mm takes longer than the way.
  go(0.001);
  go(0.0);
  const std::uint32_t settled = feed.last_id();
  const motion::Setpoint rest = motors.back();
  const std::uint32_t board_has = settled - 1;
  REQUIRE(board_has > 2);
  REQUIRE(motors[board_has - 1].velocity[Axis::X] != 0.0);
  go(-0.001);
  recording.room = board_has;
  recording.status.moving = true;
  recording.status.executing_id = 1;
  link.cycle(0.0);
  feed.update();
  REQUIRE(cut(true) == CutAnswer::late);
  recording.status.path_stop = hal::PathStop::stopping;
  link.cycle(0.0);
  recording.room = 10;
  motors.clear();
  const std::size_t calls = recording.calls.size();
  REQUIRE(cut(false) == CutAnswer::taken);
  CHECK(recording.calls[calls] == fmt::format("cut behind {}", board_has));
  REQUIRE(motors.size() == 1);
  CHECK(motors.back().position == rest.position);
  CHECK(motors.back().velocity == rest.velocity);
  CHECK(recording.calls.size() == calls + 1 + 1);
}
