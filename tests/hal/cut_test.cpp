// The end of the path is replaced while the board drives towards it.
#include <catch2/catch.hpp>
#include <cmath>

#include "hal/cpu5/firmware/host_frame.h"
#include "tests/hal/firmware_support.h"
#include "tests/hal/machine_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

/// Set up, on the way: 10 ms segments of 100 steps at 10 kHz, numbered from 1.
struct Cruise {
  Cruise() {
    REQUIRE(core.set_up(kFastBoard));
    board.keep_pulses = true;
    push(1, 20);
  }

  void push(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t id = first; id <= last; ++id) {
      REQUIRE(core.push(x_segment(id, 0.01, 100.0 * id, 10'000)));
    }
  }
  /// Brakes from step `from` to a standstill in 20 ms: on average half of 10 kHz, 100 steps.
  Segment stop_from(std::uint32_t id, double from) { return x_segment(id, 0.02, from + 100); }

  WatchedBoard board;
  Core core{board};
};

}  // namespace

TEST_CASE("What is pushed behind a cut goes on from the end of the segment that is kept",
          "[hal][LNK-8]") {
  // Behind the segment in execution, and behind one that waits.
  const std::uint32_t kept = GENERATE(3U, 4U, 10U);
  Cruise cruise;
  Core& core = cruise.core;
  core.advance(ticks(0.025));
  REQUIRE(core.status().executing_id == 3);
  core.cut_behind(kept);
  CHECK_FALSE(core.status().cut_late);
  CHECK(core.status().fifo_count == kept - 3);
  CHECK(core.status().queued_time == ticks(0.01 * kept - 0.025));
  REQUIRE(core.push(cruise.stop_from(1000, 100.0 * kept)));
  core.advance(ticks(0.01 * kept + 0.02 - 0.025));
  const Status status = core.status();
  CHECK(status.faults == 0);
  CHECK_FALSE(status.moving);
  CHECK(status.executing_id == 1000);
  CHECK(status.counts[0] == 100 * kept + 100);
  CHECK(cruise.board.pulses.size() == 100 * kept + 100);
}

TEST_CASE("A cut makes the same steps as a path that was pushed like this from the beginning",
          "[hal][LNK-8]") {
  Cruise cut;
  cut.core.advance(ticks(0.0333));
  cut.core.cut_behind(5);
  REQUIRE(cut.core.push(cut.stop_from(6, 500)));
  Cruise straight;
  straight.core.cut_behind(5);  // before anything has begun
  REQUIRE(straight.core.push(straight.stop_from(6, 500)));
  straight.core.advance(ticks(0.0333));
  for (int i = 0; i < 100; ++i) {
    CHECK(cut.core.status().counts == straight.core.status().counts);
    cut.core.advance(ticks(0.0005));
    straight.core.advance(ticks(0.0005));
  }
  CHECK(cut.core.status().counts[0] == 600);
}

TEST_CASE("A late cut changes nothing: the path goes on and the new one is dropped",
          "[hal][LNK-8][safety]") {
  Cruise cruise;
  Core& core = cruise.core;
  core.advance(ticks(0.025));
  core.cut_behind(2);
  CHECK(core.status().cut_late);
  CHECK(core.status().fifo_count == 17);
  CHECK_FALSE(core.push(cruise.stop_from(1000, 200)));
  CHECK(core.status().faults == 0);
  // The next cut is in time; numbers begin anew.
  core.cut_behind(6);
  CHECK_FALSE(core.status().cut_late);
  REQUIRE(core.push(cruise.stop_from(2000, 600)));
  core.advance(ticks(0.2));
  CHECK(core.status().faults == 0);
  CHECK(core.status().counts[0] == 700);
}

TEST_CASE("Behind a cut the new path has to be there in time", "[hal][LNK-8][LNK-2]") {
  Cruise cruise;
  cruise.core.advance(ticks(0.025));
  cruise.core.cut_behind(4);
  cruise.core.advance(ticks(0.0149));
  CHECK(cruise.core.status().faults == 0);
  cruise.core.advance(ticks(0.0002));
  CHECK(cruise.core.status().faults == kFifoUnderrun);
}

TEST_CASE("A cut behind the very last segment drops nothing, standing or not", "[hal][LNK-8]") {
  Cruise cruise;
  Core& core = cruise.core;
  REQUIRE(core.push(cruise.stop_from(21, 2000)));
  core.advance(ticks(0.05));
  core.cut_behind(21);
  CHECK_FALSE(core.status().cut_late);
  core.advance(ticks(1.0));
  CHECK(core.status().counts[0] == 2100);
  core.cut_behind(21);
  CHECK_FALSE(core.status().cut_late);
  REQUIRE(core.push(x_segment(500, 0.1, 2000)));
  core.advance(ticks(0.1));
  CHECK(core.status().counts[0] == 2000);
  core.cut_behind(21);  // before the last one by now
  CHECK(core.status().cut_late);
}

TEST_CASE("Any stop and cleared faults end the dropping behind a late cut", "[hal][LNK-8]") {
  Cruise cruise;
  Core& core = cruise.core;
  core.advance(ticks(0.025));
  core.cut_behind(2);
  REQUIRE(core.status().cut_late);
  core.quick_stop();
  CHECK_FALSE(core.status().cut_late);
  const double here = static_cast<double>(core.status().counts[0]);
  REQUIRE(core.push(x_segment(7, 0.01, here + 10)));
  core.advance(ticks(0.01));
  CHECK(static_cast<double>(core.status().counts[0]) == here + 10);
}

TEST_CASE("While the board stops along the path a cut that drops something is late",
          "[hal][LNK-8]") {
  Cruise cruise;
  cruise.core.advance(ticks(0.025));
  cruise.core.stop_along_path();
  cruise.core.cut_behind(10);
  CHECK(cruise.core.status().cut_late);
  CHECK(cruise.core.status().fifo_count == 17);
}

TEST_CASE("Behind a late cut the path that the board brakes along can be fed on", "[hal][LNK-8]") {
  WatchedBoard board;
  Core core(board);
  Setup slow = kFastBoard;
  // From 10000 steps/s at 20000 steps/s^2 braking takes 0.5 s and half as much path time, 25
  // segments of which the board has 17.
  slow.max_acceleration[0] =
      static_cast<StepAcceleration>(std::ldexp(20'000.0 / 1e14, kAccelerationBits));
  REQUIRE(core.set_up(slow));
  const auto push = [&](std::uint32_t id) {
    return core.push(x_segment(id, 0.01, 100.0 * id, 1e4));
  };
  for (std::uint32_t id = 1; id <= 20; ++id) REQUIRE(push(id));
  core.advance(ticks(0.025));
  core.stop_along_path();
  core.cut_behind(10);
  REQUIRE(core.status().cut_late);
  push(21);
  CHECK(core.status().fifo_count == 17);  // dropped
  core.cut_behind(20);
  CHECK_FALSE(core.status().cut_late);
  for (std::uint32_t id = 21; id <= 40; ++id) REQUIRE(push(id));
  core.advance(ticks(1.0));
  CHECK(core.status().faults == 0);
  CHECK(core.status().path_stop == PathStop::stopped);
  CHECK(static_cast<double>(core.status().counts[0]) == Approx(250 + 2500).epsilon(0.02));
}

TEST_CASE("A path near the highest speed is fed on while the board brakes along it",
          "[hal][LNK-8][safety]") {
  // 95 % of 400 kHz: above the 80 % to which a path is held that may still pass faster than
  // planned.
  constexpr double kFrequency = 0.95 * 400'000;
  constexpr double kSteps = 0.01 * kFrequency;  // of a segment
  const bool cuts = GENERATE(false, true);
  CAPTURE(cuts);
  WatchedBoard board;
  Core core(board);
  Setup slow = kFastBoard;
  // At 760000 steps/s^2 braking takes 0.5 s and 0.25 s of path time, 25 segments.
  slow.max_acceleration[0] =
      static_cast<StepAcceleration>(std::ldexp(2.0 * kFrequency / 1e14, kAccelerationBits));
  REQUIRE(core.set_up(slow));
  // The first one speeds up from a standstill: on average half of the frequency.
  const auto push = [&](std::uint32_t id) {
    return core.push(x_segment(id, 0.01, kSteps * (id - 0.5), kFrequency));
  };
  for (std::uint32_t id = 1; id <= 20; ++id) REQUIRE(push(id));
  core.advance(ticks(0.025));
  core.stop_along_path();
  core.advance(ticks(0.01));
  REQUIRE(core.status().time_scale < kFullScale);
  if (cuts) {
    core.cut_behind(10);
    REQUIRE(core.status().cut_late);
    core.cut_behind(20);
    REQUIRE_FALSE(core.status().cut_late);
  }
  for (std::uint32_t id = 21; id <= 40; ++id) {
    CAPTURE(id);
    REQUIRE(push(id));
  }
  core.advance(ticks(1.0));
  CHECK(core.status().faults == 0);
  CHECK(core.status().path_stop == PathStop::stopped);
  // 2 segments at full speed, less the half that speeding up has cost, and 25 of braking.
  CHECK(static_cast<double>(core.status().counts[0]) == Approx(27 * kSteps).epsilon(0.02));
}

TEST_CASE("Stopped along the path every cut is late, and the release of the stop ends that",
          "[hal][LNK-8]") {
  Cruise cruise;
  Core& core = cruise.core;
  core.advance(ticks(0.025));
  core.stop_along_path();
  core.advance(ticks(1.0));
  REQUIRE(core.status().path_stop == PathStop::stopped);
  const std::uint32_t id = GENERATE(3U, 20U);  // in which it stands, and the last of all
  core.cut_behind(id);
  CHECK(core.status().cut_late);
  core.release_stop();
  CHECK_FALSE(core.status().cut_late);
  const double here = static_cast<double>(core.status().counts[0]);
  REQUIRE(core.push(x_segment(7, 0.01, here + 10)));
  core.advance(ticks(0.01));
  CHECK(static_cast<double>(core.status().counts[0]) == here + 10);
}

TEST_CASE("Behind a cut in a thread the room for a faster spindle is still kept",
          "[hal][LNK-8][LNK-3]") {
  WatchedBoard board;
  Core core(board);
  REQUIRE(core.set_up(kFastBoard));
  Segment thread = x_segment(1, 0.1, 100, 1000);
  thread.spindle_period = static_cast<std::uint32_t>(ticks(0.1));
  REQUIRE(core.push(thread));
  REQUIRE(core.push(x_segment(2, 0.1, 200, 1000)));
  core.cut_behind(1);
  // 350 kHz is below the board's 400, but not 1.25 times of it.
  CHECK_FALSE(core.push(x_segment(2, 0.1, 100 + 17'550, 350'000)));
  CHECK(core.status().faults == kBadSegment);
}

TEST_CASE("In one exchange come the rest of the old path, the cut and a whole FIFO of the new one",
          "[hal][LNK-8]") {
  using namespace cnc;
  using namespace cnc::hal;
  const auto controller =
      sim::make_virtual_controller(sim::small_machine(), {.machine = {.start = Position{}}});
  REQUIRE(controller->connect());
  controller->set_outputs({.drives_enabled = true});
  controller->exchange(0.0);
  // 1 mm per 0.1 s, from rest to rest.
  hal::Segment segment{.duration = 0.1};
  const auto push = [&](std::uint32_t id, double x) {
    segment.id = id;
    segment.position[Axis::X] = x;
    return controller->push({&segment, 1}) == 1;
  };
  std::uint32_t id = 0;
  for (; controller->free_segments() > 0; ++id) REQUIRE(push(id + 1, id + 1));
  CHECK(id == cpu5::firmware::kFifoCapacity);
  controller->exchange(0.0);
  controller->exchange(0.05);  // the first is begun: room for one
  REQUIRE(push(id + 1, id + 1));
  controller->cut_behind(id + 1);
  CHECK(controller->free_segments() == 0);
  controller->cut_behind(3);  // 2 and 3 stay waiting, the last goes
  CHECK(controller->free_segments() == id - 2);
  std::uint32_t taken = 0;
  for (; push(id + 2 + taken, 3.0 - 0.005 * (taken + 1)); ++taken) {
  }
  CHECK(taken == id - 2);
  CHECK(controller->exchange(0.05).faults == 0);
  const auto& status = controller->exchange(0.05);
  CHECK_FALSE(status.cut_late);
  CHECK(status.fifo_count == id);
  double now = 0.05;
  while (controller->exchange(now += 0.2).moving) {
  }
  CHECK(controller->exchange(now).faults == 0);
  CHECK(controller->exchange(now).position[Axis::X] == Approx(3.0 - 0.005 * (id - 2)).margin(1e-9));
}
