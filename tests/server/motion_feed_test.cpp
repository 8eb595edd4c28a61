// A cut that is late on a path of so many short segments that the board holds only the beginning
// (LNK-8): what the link had dropped is planned anew, and no cut asks for a place that the board
// never had. Numbers of segments that go round; commands for which the link has no room.
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

/// 900 segments are sent, the board has the first 256 and executes the third of them. They are
/// numbered on behind the one that it has executed for another host.
struct DensePath {
  explicit DensePath(std::uint32_t executed_before = 0) : numbered_before(executed_before) {
    recording.status.executing_id = executed_before;
    cycle();
    feed.join_session();
    cycle();
    recording.room = kBoardHolds;
    for (std::uint32_t i = 0; i < kSent; ++i) emit();
    recording.status.moving = true;
    recording.status.executing_id = number(kExecuting);
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
    feed.hand_over();
    link.cycle(now += 0.002);
    feed.update();
  }
  /// Of the n-th that is sent.
  [[nodiscard]] std::uint32_t number(std::uint32_t n) const {
    const std::uint32_t plain = numbered_before + n;
    return plain < n ? plain + 1 : plain;  // 0 is left out
  }
  /// By its number how many have been sent with it.
  [[nodiscard]] MotionFeed::Id id(std::uint32_t n) const {
    const MotionFeed::Id plain = MotionFeed::Id{numbered_before} + n;
    return plain >> 32U != 0 ? plain + 1 : plain;
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

  std::uint32_t numbered_before;
  config::MachineConfig config = hal::sim::small_machine();
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};
  double clock = 0.0;     // s
  double planning = 0.0;  // s that it goes on while a cut is made
  MotionFeed feed{link, config, [this] { return clock; }};
  double now = 0.0;
  MotionFeed::Id behind = 0;  // the last cut
};

}  // namespace

TEST_CASE("However often a cut is late, none is made behind what the board has",
          "[LNK-8][JOB-8][safety]") {
  // The numbers go round nowhere, among what the board has, and among what it never had.
  DensePath path(GENERATE(0U, 0xFFFF'FFFFU - 100U, 0xFFFF'FFFFU - 400U));
  path.recording.status.cut_late = true;
  // 2 x 2 ms + 1 ms, and after each late one twice that: from 80 ms on it is more than the 63 ms
  // that the board has.
  MotionFeed::Id before = 0;
  for (int times = 0; times < 7; ++times) {
    CAPTURE(times);
    REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::late);
    CHECK(path.feed.last_id() == path.id(kSent));
    CHECK(path.behind > path.id(kExecuting));
    CHECK(path.behind <= path.id(kBoardHolds));
    CHECK(path.behind >= before);
    CHECK(path.recording.calls.back() ==
          fmt::format("cut behind {}", static_cast<std::uint32_t>(path.behind)));
    before = path.behind;
  }
  CHECK(path.behind == path.id(kBoardHolds));
  // One that is taken ends it: the link has all of the new path.
  path.recording.status.cut_late = false;
  path.recording.room = 1000;
  REQUIRE(path.cut(path.feed.replaceable()) == CutAnswer::taken);
  CHECK(path.behind == path.id(kBoardHolds));
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
  const MotionFeed::Id settled = feed.last_id();
  const motion::Setpoint rest = motors.back();
  const auto board_has = static_cast<std::uint32_t>(settled - 1);
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

TEST_CASE("Segments are numbered on where the numbers go round, and 0 is left out", "[LNK-2]") {
  DensePath path(0xFFFF'FFFFU - 100U);
  const auto& calls = path.recording.calls;
  REQUIRE(calls.size() == kBoardHolds);
  CHECK(calls[0] == "segment 4294967196");
  CHECK(calls[99] == "segment 4294967295");
  CHECK(calls[100] == "segment 1");
  CHECK(calls.back() == fmt::format("segment {}", kBoardHolds - 100));

  for (const std::uint32_t n : {99U, 100U, 101U, 102U, 150U}) {
    CAPTURE(n);
    path.recording.status.executing_id = path.number(n);
    path.cycle();
    CHECK(path.feed.executed(path.id(n - 1)));
    CHECK(path.feed.begun(path.id(n)));
    CHECK_FALSE(path.feed.executed(path.id(n)));
    CHECK_FALSE(path.feed.begun(path.id(n + 1)));
    CHECK(path.feed.under_way() == kSent - n);
    CHECK(path.feed.executing().velocity[Axis::X] == Approx(kSpeed));
    CHECK(path.feed.axes_in_motion()[Axis::X]);
  }
  CHECK(path.feed.axes_under_way()[Axis::X]);
}

TEST_CASE("A motion that begins goes to the board as a whole, or as far as it was planned",
          "[LNK-2][MOT-1][safety]") {
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};
  const config::MachineConfig config = hal::sim::small_machine();
  MotionFeed feed{link, config};
  // 0.2 mm/s more with each of them, which no axis minds.
  const auto go_on = [&](double velocity) {
    motion::Setpoint setpoint;
    setpoint.duration = 0.001;
    setpoint.position = feed.commanded();
    setpoint.position[Axis::X] += 0.5 * (feed.end_velocity()[Axis::X] + velocity) * 0.001;
    setpoint.velocity[Axis::X] = velocity;
    REQUIRE(feed.emit(setpoint));
  };
  const auto given = [&] {
    link.cycle(0.0);
    return recording.calls.size();
  };
  go_on(0.2);
  go_on(0.4);
  CHECK(given() == 0);
  SECTION("as far as it was planned, and then on") {
    feed.hand_over();
    CHECK(given() == 2);
    go_on(0.2);
    CHECK(given() == 3);
    go_on(0.0);
    CHECK(given() == 4);
  }
  SECTION("to its end") {
    go_on(0.2);
    CHECK(given() == 0);
    go_on(0.0);
    CHECK(given() == 4);
    go_on(0.0);  // a dwell
    CHECK(given() == 5);
    go_on(0.2);
    CHECK(given() == 5);
  }
}

TEST_CASE("What another host made the board execute is none of the server's segments", "[LNK-4]") {
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};
  const config::MachineConfig config = hal::sim::small_machine();
  MotionFeed feed{link, config};
  recording.status.executing_id = 500;
  recording.status.executing_phase = 1.0;
  link.cycle(0.0);
  feed.update();
  feed.join_session();
  feed.accept_board_position();
  CHECK(feed.next_id() == 501);
  CHECK_FALSE(feed.executed(501));
  CHECK(feed.under_way() == 0);
}

namespace {

/// The link's queue is as full as setpoints make it, and the board takes none.
struct Jam : DensePath {
  Jam() {
    recording.room = 0;
    while (feed.wants_more(1e9)) emit();
    cycle();
    recording.calls.clear();
  }
  /// So many arrived, behind all segments and one after the other.
  void check_flickers(int count) {
    std::vector<std::string> switched;
    for (const std::string& call : recording.calls)
      if (call.starts_with("spindle")) switched.push_back(call);
    REQUIRE(switched.size() == static_cast<std::size_t>(2 * count));
    for (std::size_t i = 0; i < switched.size(); ++i)
      CHECK(switched[i] == (i % 2 == 0 ? "spindle on" : "spindle off"));
    CHECK(recording.calls.back() == "spindle off");
  }
  void flicker(int count) {
    for (int i = 0; i < count; ++i) {
      feed.send(SetOutputs{{.spindle_on = true}});
      feed.send(SetOutputs{{.spindle_on = false}});
    }
  }
};

}  // namespace

TEST_CASE("Commands for which the link has no room come later, all of them, in their order",
          "[LNK-2][safety]") {
  Jam jam;
  jam.flicker(200);
  jam.cycle();
  CHECK_FALSE(jam.feed.all_told());
  CHECK_FALSE(jam.feed.wants_more(1e9));
  CHECK(jam.recording.calls.empty());
  jam.recording.room = 100'000;
  for (int i = 0; i < 4 && !jam.feed.all_told(); ++i) jam.cycle();
  CHECK(jam.feed.all_told());
  jam.check_flickers(200);
  CHECK(jam.feed.wants_more(1e9));
}

TEST_CASE("Where the link has no room for a new path, the old one is not cut", "[LNK-8][safety]") {
  Jam jam;
  CHECK(jam.feed.replaceable() == 0);
  jam.flicker(200);
  CHECK(jam.feed.replaceable() == 0);
  // A cut behind all of it finds room, however many commands wait.
  jam.feed.begin_cut(0);
  jam.feed.commit_cut();
  jam.recording.room = 100'000;
  for (int i = 0; i < 4 && !jam.feed.all_told(); ++i) jam.cycle();
  jam.check_flickers(200);
  CHECK(jam.feed.cut_answer() == CutAnswer::taken);
  CHECK(jam.feed.replaceable() > 0);
}

TEST_CASE("A quick stop drops the commands that wait, but for the way out of a fault",
          "[LNK-8][safety]") {
  Jam jam;
  jam.flicker(200);
  jam.feed.send(ClearFaults{});
  jam.feed.quick_stop();
  jam.feed.send(SetOutputs{{.spindle_on = false}});
  for (int i = 0; i < 4; ++i) jam.cycle();
  CHECK(jam.recording.calls ==
        std::vector<std::string>{"quick stop", "clear faults", "spindle off"});
  CHECK(jam.feed.all_told());
}
