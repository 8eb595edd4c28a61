// A stop along the path: within the axes' acceleration, on the path, and exact where it ends.
#include "hal/cpu5/firmware/path_stop.h"

#include <catch2/catch.hpp>

#include "hal/cpu5/firmware/hermite.h"
#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

constexpr double kLimit = 1e6;  // steps/s^2
constexpr double kWindow = 0.005;
constexpr double kPiece = 0.005;

StepAcceleration steps_per_second2(double acceleration) {
  return std::llround(std::ldexp(acceleration / 1e14, kAccelerationBits));
}

Setup limited_board() {
  Setup setup = kFastBoard;
  setup.max_acceleration.fill(steps_per_second2(kLimit));
  return setup;
}

/// A path of time, fed to the board piece by piece.
struct Path {
  using Function = std::function<double(double)>;
  PerAxis<Function> position{};
  PerAxis<Function> velocity{};
};

class Rig {
 public:
  explicit Rig(const Path& path) : path_(path) { REQUIRE(core.set_up(limited_board())); }

  /// Runs one window, with the FIFO kept filled like a host does.
  void run_window() {
    while (core.status().path_stop != PathStop::stopped && core.status().fifo_count < 20) {
      REQUIRE(core.push(next_piece()));
    }
    core.advance(ticks(kWindow));
    REQUIRE(core.status().faults == 0);
    history.push_back(core.status().counts);
  }
  void run_until(double time) {
    while (static_cast<double>(core.status().time) < time * kTicksPerSecond) run_window();
  }
  /// The windows that it took.
  int run_to_standstill() {
    int windows = 0;
    while (core.status().path_stop != PathStop::stopped && windows < 1000) {
      run_window();
      ++windows;
    }
    REQUIRE(core.status().path_stop == PathStop::stopped);
    run_window();
    return windows;
  }

  /// From the second differences of the step counts; a count may be one step beside the mean.
  [[nodiscard]] double highest_acceleration(std::size_t axis) const {
    double highest = 0.0;
    for (std::size_t i = 2; i < history.size(); ++i) {
      const auto change =
          std::abs(history[i][axis] - 2 * history[i - 1][axis] + history[i - 2][axis]);
      highest = std::max(highest, (static_cast<double>(change) - 2) / (kWindow * kWindow));
    }
    return highest;
  }

  WatchedBoard board;
  Core core{board};
  std::vector<PerAxis<std::int64_t>> history{PerAxis<std::int64_t>{}};

 private:
  Segment next_piece() {
    Segment segment{.id = ++id_, .duration = static_cast<std::uint32_t>(ticks(kPiece))};
    const double time = id_ * kPiece;
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      if (!path_.position[axis]) continue;
      segment.position[axis] = steps(path_.position[axis](time));
      segment.velocity[axis] = steps_per_second(path_.velocity[axis](time));
    }
    return segment;
  }

  const Path& path_;
  std::uint32_t id_ = 0;
};

constexpr double kSpeed = 100'000;  // steps/s
constexpr double kRamp = kSpeed / kLimit;

/// 100 kHz on X after a run-up at the limit (0.1 s), Y a third of it; from `brake` on the plan
/// itself brakes at the limit.
Path straight(double brake) {
  const auto velocity = [brake](double t) {
    const double up = std::min(t / kRamp, 1.0);
    const double down = std::clamp((brake + kRamp - t) / kRamp, 0.0, 1.0);
    return kSpeed * std::min(up, down);
  };
  const auto position = [brake](double t) {
    const double up = std::min(t, kRamp);
    const double even = std::clamp(t - kRamp, 0.0, brake - kRamp);
    const double down = std::clamp(t - brake, 0.0, kRamp);
    return kSpeed * (up * up / (2 * kRamp) + even + down - down * down / (2 * kRamp));
  };
  return {.position = {position, [position](double t) { return position(t) / 3; }},
          .velocity = {velocity, [velocity](double t) { return velocity(t) / 3; }}};
}

constexpr double kRadius = 2000;
constexpr double kRunUp = 0.5;

/// Two axes in a circle of 2000 steps, the speed rising to that at which the centripetal
/// acceleration is `part` of the limit.
Path circle(double part) {
  const double full = std::sqrt(part * kLimit / kRadius);  // rad/s
  const auto angle = [full](double t) {
    const double up = std::min(t, kRunUp);
    return full * (up * up / (2 * kRunUp) + (t - up));
  };
  const auto rate = [full](double t) { return full * std::min(t / kRunUp, 1.0); };
  return {.position = {[=](double t) { return kRadius * std::sin(angle(t)); },
                       [=](double t) { return kRadius * (1 - std::cos(angle(t))); }},
          .velocity = {[=](double t) { return kRadius * rate(t) * std::cos(angle(t)); },
                       [=](double t) { return kRadius * rate(t) * std::sin(angle(t)); }}};
}

constexpr double kNever = 1e9;

}  // namespace

TEST_CASE("A stop from constant speed brakes with the axis's acceleration, along the line",
          "[hal][LNK-8]") {
  const Path path = straight(kNever);
  Rig rig(path);
  rig.run_until(0.2);
  const auto begin = rig.core.status().counts[0];
  rig.core.stop_along_path();
  CHECK(rig.core.status().path_stop == PathStop::stopping);
  const int windows = rig.run_to_standstill();
  // v / a = 100e3 / 1e6 = 0.1 s and v^2 / 2a = 5000 steps, and the three slices planned before.
  CHECK(windows * kWindow == Approx(0.105));
  const auto way = rig.core.status().counts[0] - begin;
  CHECK(way >= 4999);
  CHECK(way <= 5031);
  CHECK(rig.highest_acceleration(0) <= kLimit * 1.001);
  CHECK(std::abs(3 * rig.core.status().counts[1] - rig.core.status().counts[0]) <= 3);
}

TEST_CASE("A stop keeps within the acceleration wherever in the plan it begins", "[hal][LNK-8]") {
  // Running up until 0.1 s, braking from 0.3 to 0.4 s.
  const double begin = GENERATE(0.005, 0.05, 0.095, 0.1, 0.2, 0.25, 0.295, 0.3, 0.35, 0.395);
  const Path path = straight(0.3);
  Rig rig(path);
  rig.run_until(begin);
  const auto before = rig.core.status().counts[0];
  rig.core.stop_along_path();
  const int windows = rig.run_to_standstill();
  CHECK(rig.highest_acceleration(0) <= kLimit * 1.001);
  // No later than the fastest stop from full speed, and no longer.
  CHECK(windows * kWindow < 0.1101);
  CHECK(rig.core.status().counts[0] - before <= 5031);
}

TEST_CASE("A stop in a circle keeps each axis within its acceleration and stays on the circle",
          "[hal][LNK-8]") {
  const double part = GENERATE(0.3, 0.7, 0.95);
  const double begin = GENERATE(range(0.6, 0.9, 0.03));
  const Path path = circle(part);
  Rig rig(path);
  rig.run_until(begin);
  rig.core.stop_along_path();
  const int windows = rig.run_to_standstill();
  CHECK(windows * kWindow < 0.5);
  const PerAxis<std::int64_t> end = rig.core.status().counts;
  CHECK(std::hypot(static_cast<double>(end[0]), static_cast<double>(end[1] - 2000)) ==
        Approx(2000).margin(1.5));
  for (const std::size_t axis : {0U, 1U}) CHECK(rig.highest_acceleration(axis) <= kLimit * 1.01);
}

TEST_CASE("After a stop the FIFO is empty, there is no fault and the outputs stay",
          "[hal][LNK-8]") {
  const Path path = straight(kNever);
  Rig rig(path);
  const Outputs on{.drives_enabled = true, .spindle_on = true, .spindle_pwm = 1};
  rig.core.set_outputs(on);
  rig.run_until(0.2);
  rig.core.stop_along_path();
  rig.run_to_standstill();
  const Status status = rig.core.status();
  CHECK(status.faults == 0);
  CHECK(status.fifo_count == 0);
  CHECK(status.queued_time == 0);
  CHECK_FALSE(status.moving);
  CHECK(status.counts == rig.board.counts);
  CHECK(rig.board.last_outputs == on);
}

TEST_CASE("After a stop segments are dropped until it is released, then go on from the stop",
          "[hal][LNK-8]") {
  const Path path = straight(kNever);
  Rig rig(path);
  rig.run_until(0.2);
  rig.core.stop_along_path();
  rig.core.release_stop();  // too early: no effect
  rig.run_to_standstill();
  const std::int64_t end = rig.core.status().counts[0];
  Segment next{.id = 7, .duration = 100'000};
  next.position[0] = position_of_step(end + 10);
  next.position[1] = position_of_step(rig.core.status().counts[1]);
  CHECK_FALSE(rig.core.push(next));
  CHECK(rig.core.status().faults == 0);
  rig.core.advance(ticks(0.1));
  CHECK(rig.core.status().counts[0] == end);

  rig.core.release_stop();
  CHECK(rig.core.status().path_stop == PathStop::none);
  REQUIRE(rig.core.push(next));
  rig.core.advance(ticks(0.01));
  CHECK(rig.core.status().counts[0] == end + 10);
  CHECK(rig.core.status().time_scale == kFullScale);
}

TEST_CASE("A machine that stands is stopped at once", "[hal][LNK-8]") {
  WatchedBoard board;
  Core core(board);
  core.set_up(limited_board());
  core.stop_along_path();
  CHECK(core.status().path_stop == PathStop::stopped);
  core.release_stop();
  REQUIRE(core.push(x_segment(1, 0.01, 10)));
  core.stop_along_path();  // taken, but not begun
  CHECK(core.status().path_stop == PathStop::stopped);
  core.advance(ticks(0.1));
  CHECK(board.pulse_count == 0);
}

TEST_CASE(
    "A path that ends during the stop ends it, and one that runs dry in motion is an underrun",
    "[hal][LNK-8][LNK-2]") {
  WatchedBoard board;
  Core core(board);
  core.set_up(limited_board());
  // 10 kHz after 50 steps; the limit would need 50 steps more.
  core.push(x_segment(1, 0.010, 50, 10'000));
  core.push(x_segment(2, 0.001, 60, 10'000));
  SECTION("runs dry") {
    core.advance(ticks(0.010));
    core.stop_along_path();
    core.advance(ticks(0.1));
    CHECK(core.status().faults == kFifoUnderrun);
    CHECK(core.status().path_stop == PathStop::none);
  }
  SECTION("ends") {
    core.push(x_segment(3, 0.010, 110));  // the plan brakes at the limit: nothing is left to add
    core.advance(ticks(0.0111));
    core.stop_along_path();
    core.advance(ticks(0.1));
    CHECK(core.status().faults == 0);
    CHECK(core.status().path_stop == PathStop::stopped);
    CHECK(core.status().counts[0] == 110);
  }
}

TEST_CASE("Quick stop and fault end a stop along the path", "[hal][LNK-8]") {
  const Path path = straight(kNever);
  Rig rig(path);
  rig.run_until(0.2);
  rig.core.stop_along_path();
  rig.core.advance(ticks(0.05));
  rig.core.quick_stop();
  CHECK(rig.core.status().path_stop == PathStop::none);
  CHECK(rig.core.status().time_scale == kFullScale);
  Segment next{.id = 7, .duration = 100'000};
  for (const std::size_t axis : {0U, 1U}) {
    next.position[axis] = position_of_step(rig.core.status().counts[axis]);
  }
  CHECK(rig.core.push(next));
}

TEST_CASE("What an axis leaves for slowing down", "[hal][LNK-8]") {
  // At v = 0.01 step/tick, A = 2^-20 step/tick^2 and 100 ticks the scale may fall by
  // 2^-20 / 0.01 * 100 = 0.009537, without a plan's own acceleration.
  constexpr StepAcceleration kA = StepAcceleration{1} << (kAccelerationBits - 20);
  const StepVelocity v = steps_per_second(100'000);
  const auto loss = [&](const PathDerivatives& axis, TimeScale scale) {
    return static_cast<double>(allowed_loss(axis, kA, scale, 100)) / kFullScale;
  };
  const double unit = std::ldexp(100.0, -20) / 0.01;
  CHECK(loss({v, 0}, kFullScale) == Approx(unit));
  CHECK(loss({-v, 0}, kFullScale) == Approx(unit));
  CHECK(loss({v, kA}, kFullScale) == Approx(2 * unit));  // still running up
  CHECK(loss({-v, -kA}, kFullScale) == Approx(2 * unit));
  CHECK(loss({v, -kA / 2}, kFullScale) == Approx(unit / 2));
  CHECK(loss({v, -kA}, kFullScale) == 0.0);  // brakes as hard as it can
  CHECK(loss({v, -2 * kA}, kFullScale) == 0.0);
  CHECK(loss({v, -kA}, kFullScale / 2) == Approx(0.75 * unit));  // s^2 = 1/4 of it is left
  CHECK(loss({0, kA}, kFullScale) == 1.0);
  CHECK(loss({1, 0}, kFullScale) == 1.0);
  CHECK(allowed_loss({v, 0}, 0, kFullScale, 100) == kFullScale);
}

TEST_CASE("A cubic tells its velocity and acceleration", "[hal]") {
  // 0.5 a t^2 with a = 1e6 steps/s^2 from 20 kHz: after 30 of 50 ms 50 kHz.
  const AxisMotion motion{.distance = steps(20'000 * 0.05 + 0.5e6 * 0.05 * 0.05),
                          .start_velocity = steps_per_second(20'000),
                          .end_velocity = steps_per_second(70'000),
                          .duration = ticks(0.05)};
  const Cubic cubic(motion);
  const auto velocity = static_cast<double>(cubic.velocity_after(ticks(0.03)));
  CHECK(velocity == Approx(static_cast<double>(steps_per_second(50'000))).epsilon(1e-5));
  for (const double time : {0.0, 0.03, 0.05}) {
    const auto acceleration = static_cast<double>(cubic.acceleration_after(ticks(time)));
    CHECK(acceleration == Approx(static_cast<double>(steps_per_second2(1e6))).epsilon(1e-4));
  }
  // Half a tick on, half of the way to the next tick.
  const PathTime at = path_time(1000) + path_time(1) / 2;
  CHECK(cubic.distance_at(at) == (cubic.distance_after(1000) + cubic.distance_after(1001)) / 2);
}
