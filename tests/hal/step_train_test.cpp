// Segments in, steps out: exact counts, no drift in way or time, steps in the order of time.
#include <catch2/catch.hpp>
#include <random>

#include "hal/cpu5/firmware/slice_steps.h"
#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

/// Random segments on all axes, each at a constant acceleration between random velocities (so that
/// no speed exceeds the larger of both ends), with standstill after the last.
class RandomTrain {
 public:
  explicit RandomTrain(std::uint64_t seed) : random_(seed) {}

  Segment next(bool last) {
    std::uniform_int_distribution<std::uint32_t> any_duration(kMinSegmentTicks, 60'000);
    end_.id += 1;
    end_.duration = any_duration(random_);
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      const StepVelocity v1 = last ? 0 : random_velocity();
      end_.position[axis] += (end_.velocity[axis] + v1) / 2 * end_.duration;
      end_.velocity[axis] = v1;
    }
    return end_;
  }

 private:
  StepVelocity random_velocity() {
    const StepVelocity top = velocity_of_frequency(390'000);
    return std::uniform_int_distribution<StepVelocity>(-top, top)(random_);
  }

  std::mt19937_64 random_;
  Segment end_{};
};

std::vector<Segment> random_train(std::uint64_t seed, int count) {
  RandomTrain train(seed);
  std::vector<Segment> segments;
  for (int i = 1; i <= count; ++i) segments.push_back(train.next(i == count));
  return segments;
}

Ticks duration_of(const std::vector<Segment>& segments) {
  Ticks sum = 0;
  for (const Segment& segment : segments) sum += segment.duration;
  return sum;
}

}  // namespace

TEST_CASE("After any train of segments each motor stands on the step nearest to the stated end",
          "[hal][LNK-2]") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const std::vector<Segment> train = random_train(seed, 200);
    WatchedBoard board;
    Core core(board);
    REQUIRE(core.set_up(kFastBoard));
    for (const Segment& segment : train) REQUIRE(core.push(segment));
    core.advance(duration_of(train));

    const Status status = core.status();
    CHECK(status.faults == 0);
    CHECK_FALSE(status.moving);
    CHECK(status.executing_id == 200);
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      const double end = std::ldexp(static_cast<double>(train.back().position[axis]), -32);
      CHECK(static_cast<double>(status.counts[axis]) == std::floor(end + 0.5));
      CHECK(board.counts[axis] == status.counts[axis]);
    }
  }
}

TEST_CASE("The last tick of a train is needed, and no more than that", "[hal][LNK-2]") {
  const std::vector<Segment> train = random_train(7, 100);
  WatchedBoard board;
  Core core(board);
  core.set_up(kFastBoard);
  for (const Segment& segment : train) core.push(segment);
  core.advance(duration_of(train) - 1);
  CHECK(core.status().moving);
  core.advance(1);
  CHECK_FALSE(core.status().moving);
  CHECK(core.status().time == duration_of(train));
}

TEST_CASE("A million segments of a third of a step end where they should, in the time they should",
          "[hal][LNK-2]") {
  // Each segment makes 1/3 step in 10 us: 33.3 kHz. 2^32/3 is not whole, so every end is rounded.
  constexpr std::uint32_t kSegments = 1'000'000;
  const StepVelocity velocity = velocity_of_frequency(100'000) / 3;
  WatchedBoard board;
  Core core(board);
  core.set_up(kFastBoard);
  for (std::uint32_t id = 1; id <= kSegments; ++id) {
    Segment segment{.id = id, .duration = 100};
    segment.position[0] = std::int64_t{id} * kOneStep / 3;
    segment.velocity[0] = id == kSegments ? 0 : velocity;
    REQUIRE(core.push(segment));
    if (core.status().fifo_free == 0 || id == kSegments) {
      core.advance(core.status().queued_time - (id == kSegments ? 0 : 100));
    }
  }
  CHECK(core.status().faults == 0);
  CHECK_FALSE(core.status().moving);
  CHECK(core.status().counts[0] == 333'333);
  CHECK(core.status().time == Ticks{100} * kSegments);
  // Constant speed after the first segment: not one step was taken back.
  CHECK(board.pulse_count == 333'333);
}

TEST_CASE("The steps do not depend on how the time is cut into calls", "[hal]") {
  const std::vector<Segment> train = random_train(11, 150);
  const auto pulses_with = [&](auto next_call) {
    WatchedBoard board;
    board.keep_pulses = true;
    Core core(board);
    core.set_up(kFastBoard);
    for (const Segment& segment : train) core.push(segment);
    for (Ticks left = duration_of(train); left > 0;) {
      const Ticks now = std::min<Ticks>(left, next_call());
      core.advance(now);
      left -= now;
    }
    return board.pulses;
  };
  std::mt19937 random(5);
  const auto at_once = pulses_with([] { return kTicksPerSecond * 100; });
  const auto in_pieces = pulses_with([&] { return static_cast<Ticks>(random() % 5000); });
  CHECK(at_once.size() > 10'000);
  CHECK(at_once == in_pieces);
}

TEST_CASE("Steps of several axes come in the order of time", "[hal]") {
  // In 600 ticks: three steps of X are due at 100, 300, 500, two of Z, backwards, at 150 and 450.
  const auto even = [](double way) {
    const StepVelocity velocity = steps(way) / 600;
    return Cubic({.distance = 600 * velocity,
                  .start_velocity = velocity,
                  .end_velocity = velocity,
                  .duration = 600});
  };
  const Cubic x = even(3);
  const Cubic z = even(-2);
  SliceSteps slice;
  slice.add(0, {x, 0, 0, steps(3), 0, path_time(600)});
  slice.add(2, {z, steps(10), steps(10), steps(8), 0, path_time(600)});
  std::vector<Pulse> order;
  while (!slice.empty()) {
    const SliceSteps::Step step = slice.take();
    order.push_back({step.axis, step.direction, std::lround(std::ldexp(step.moment, -20))});
  }
  CHECK(order ==
        std::vector<Pulse>{{0, 1, 100}, {2, -1, 150}, {0, 1, 300}, {2, -1, 450}, {0, 1, 500}});
}

TEST_CASE("A motor half-way between two steps stands on the upper one", "[hal]") {
  CHECK(nearest_step(steps(2.5)) == 3);
  CHECK(nearest_step(steps(2.5) - 1) == 2);
  CHECK(nearest_step(steps(-2.5)) == -2);
  CHECK(nearest_step(steps(-2.5) - 1) == -3);

  // From 2.5 downwards the first step is due at once.
  const Cubic down({.distance = -steps(0.5),
                    .start_velocity = -steps(0.001),
                    .end_velocity = 0,
                    .duration = 500});
  SliceSteps slice;
  slice.add(0, {down, steps(2.5), steps(2.5), steps(2.0), 0, path_time(500)});
  REQUIRE_FALSE(slice.empty());
  CHECK(slice.take().moment == 0);
}

TEST_CASE("Status tells where in which segment the board is and how much motion it holds",
          "[hal][LNK-2]") {
  WatchedBoard board;
  Core core(board);
  core.set_up(kFastBoard);
  // 10 kHz for 20 ms after a run-up of 10 ms, then a run-out of 10 ms: 50 + 200 + 50 steps.
  core.push(x_segment(1, 0.010, 50, 10'000));
  core.push(x_segment(2, 0.020, 250, 10'000));
  core.push(x_segment(3, 0.010, 300));
  core.advance(ticks(0.015));
  const Status status = core.status();
  CHECK(status.executing_id == 2);
  CHECK(status.executing_elapsed == ticks(0.005));
  CHECK(status.executing_duration == ticks(0.020));
  CHECK(status.fifo_count == 1);
  CHECK(status.fifo_free == kFifoCapacity - 1);
  CHECK(status.queued_time == ticks(0.025));
  CHECK(status.counts[0] == 100);
}

TEST_CASE("Played by an interrupt and planned by another, a train makes the same steps",
          "[hal][LNK-2]") {
  // As a board does it: run_until() at each moment that next_due() tells, plan() when it says so.
  const std::vector<Segment> train = random_train(13, 100);
  const auto pulses_with = [&](const auto& play) {
    WatchedBoard board;
    board.keep_pulses = true;
    Core core(board);
    REQUIRE(core.set_up(kFastBoard));
    for (const Segment& segment : train) REQUIRE(core.push(segment));
    play(core);
    CHECK(core.status().faults == 0);
    CHECK(core.status().time == duration_of(train));
    CHECK_FALSE(core.status().moving);
    return board.pulses;
  };
  const auto advanced = pulses_with([&](Core& core) { core.advance(duration_of(train)); });
  const auto interrupted = pulses_with([&](Core& core) {
    core.plan();
    for (Ticks now = 0; now < duration_of(train);) {
      now = std::min(std::max(now, core.next_due()), duration_of(train));
      if (core.run_until(now)) core.plan();
    }
  });
  CHECK(advanced == interrupted);
}

TEST_CASE("Planning that comes into the middle of a host's call is put off to its end", "[hal]") {
  WatchedBoard board;
  Core core(board);
  REQUIRE(core.set_up(kFastBoard));
  REQUIRE(core.push(x_segment(1, 0.010, 50)));
  const auto slice_is_there = [&] { return core.next_due() == core.time(); };
  bool there_inside = true;
  board.read_inputs = [&] {  // as if the interrupt came while the probe is being armed
    core.plan();
    there_inside = slice_is_there();
    return Inputs{};
  };
  CHECK_FALSE(slice_is_there());
  core.arm_probe();
  CHECK_FALSE(there_inside);
  CHECK(slice_is_there());
}
