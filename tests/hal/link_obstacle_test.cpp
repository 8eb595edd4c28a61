// Why there is no link to a board: told by connect(), and in the status as long as it lasts.
#include <catch2/catch.hpp>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/wire_port.h"
#include "tests/hal/machine_support.h"
#include "tests/hal/pretend_board.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;
using Catch::Contains;
using Kind = LinkObstacle::Kind;
using cpu5::wire::RefusalReason;

namespace {

/// A driver that wants 400 kHz, in virtual time.
struct Rig {
  Pretence pretence;
  cpu5::Cpu5Driver driver{small_machine(), cpu5::DriverSettings{},
                          std::make_unique<cpu5::WirePort>(std::make_unique<PretendBoard>(pretence),
                                                           cpu5::WireSettings{})};
  double now = 0.0;

  const ControllerStatus& pass(double time) {
    for (const double until = now + time; now < until; now += 0.002) driver.exchange(now);
    return driver.exchange(now);
  }
};

/// A change that a board may have, what comes of it, and what the error says.
struct Row {
  const char* rule;
  void (*change)(Pretence&);
  LinkObstacle obstacle;
  ErrorCode code;
  const char* text;
};

const Row kRows[]{
    {"another version",
     [](Pretence& board) {
       board.refusal = {
           .reason = RefusalReason::other_version, .lowest_version = 8, .highest_version = 9};
     },
     {Kind::other_version, 8, 9, cpu5::wire::kVersion},
     ErrorCode::board_version,
     "speaks versions 8 to 9 of the protocol"},
    {"busy",
     [](Pretence& board) { board.refusal = {.reason = RefusalReason::busy}; },
     {Kind::busy},
     ErrorCode::board_busy,
     "has another host"},
    {"a setup out of range",
     [](Pretence& board) { board.refusal = {.reason = RefusalReason::bad_setup}; },
     {Kind::bad_setup},
     ErrorCode::board_setup_refused,
     "refused its setup"},
    {"a greeting that is not understood",
     [](Pretence& board) { board.refusal = {.reason = RefusalReason::not_understood}; },
     {Kind::not_understood},
     ErrorCode::board_version,
     "does not understand the greeting"},
    {"four axes",
     [](Pretence& board) { board.identity.axes = 4; },
     {Kind::other_axes, 4, 4, 6},
     ErrorCode::board_unsuitable,
     "has 4 axes; this program drives boards with 6"},
    {"no window",
     [](Pretence& board) { board.identity.window = 0; },
     {Kind::not_understood},
     ErrorCode::board_version,
     "different versions"},
    {"fewer steps per second",
     [](Pretence& board) { board.identity.max_step_frequency = 100'000; },
     {Kind::too_slow, 0, 100'000, 400'000},
     ErrorCode::board_unsuitable,
     "makes 100000 steps per second at most; 400000 are set up"},
    {"silence behind the greeting",
     [](Pretence& board) { board.is_mute_behind_greeting = true; },
     {Kind::no_status},
     ErrorCode::board_version,
     "takes the greeting, but gives no status"},
    {"silence",
     [](Pretence& board) { board.is_mute = true; },
     {Kind::silent},
     ErrorCode::board_silent,
     "does not answer"},
};

}  // namespace

TEST_CASE("A board that is of no use is refused with the reason, and awaited",
          "[hal][LNK-1][LNK-3][LNK-9]") {
  const Row& row = kRows[GENERATE(range(std::size_t{0}, std::size(kRows)))];
  INFO(row.rule);
  Rig rig;
  row.change(rig.pretence);
  const auto refused = rig.driver.connect();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == row.code);
  CHECK_THAT(refused.error().message, Contains(row.text));
  CHECK_FALSE(rig.pass(1.5).connected);
  CHECK(rig.pass(0.0).obstacle == row.obstacle);
  CHECK(rig.driver.free_segments() == 0);

  // It is mended, which takes its power: it does not know the session any more.
  rig.pretence = {.refusal = cpu5::wire::Refusal{.reason = RefusalReason::no_session}};
  rig.pass(0.2);
  rig.pretence = {};
  CHECK(rig.pass(0.5).connected);
  CHECK(rig.pass(0.0).obstacle == LinkObstacle{});
}

TEST_CASE("A board that takes the place of another one is looked at as closely",
          "[hal][LNK-3][LNK-9][safety]") {
  const Row& row = kRows[GENERATE(range(std::size_t{0}, std::size(kRows)))];
  INFO(row.rule);
  Rig rig;
  REQUIRE(rig.driver.connect());
  REQUIRE(rig.pass(0.1).connected);
  const std::uint64_t frames = rig.driver.next_frame();
  rig.pretence.refusal = {.reason = RefusalReason::no_session};
  rig.pass(0.01);
  rig.pretence.refusal.reset();
  row.change(rig.pretence);
  const ControllerStatus& status = rig.pass(1.5);
  CHECK_FALSE(status.connected);
  CHECK(status.obstacle == row.obstacle);
  CHECK(status.sessions == 1);
  // Nothing that was meant for the first one reaches it.
  rig.driver.set_outputs({.drives_enabled = true, .spindle_on = true});
  rig.pass(0.1);
  CHECK(rig.driver.next_frame() == frames);
}

TEST_CASE("A channel whose greetings nobody answers is asked to look elsewhere", "[hal][LNK-1]") {
  Rig rig;
  REQUIRE(rig.driver.connect());
  rig.pass(1.0);
  CHECK(rig.pretence.looks_elsewhere == 0);
  rig.pretence.is_mute = true;
  rig.pass(0.25 + 1.9);  // the link is lost, then 20 greetings, 0.1 s apart
  CHECK(rig.pretence.looks_elsewhere == 0);
  rig.pass(0.3);
  CHECK(rig.pretence.looks_elsewhere == 1);
  // One that refuses is there.
  rig.pretence = {.refusal = cpu5::wire::Refusal{.reason = RefusalReason::busy}};
  rig.pass(5.0);
  CHECK(rig.pretence.looks_elsewhere == 0);
}
