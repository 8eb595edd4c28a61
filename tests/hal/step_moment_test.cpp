// When each step leaves, against the cubics of the segments in long double.
#include <catch2/catch.hpp>

#include "tests/hal/firmware_support.h"
#include "tests/hal/pulse_strokes.h"

using namespace cnc::hal::cpu5::firmware;

namespace {

long double in_steps(std::int64_t fixed) {
  return std::ldexp(static_cast<long double>(fixed), -kFractionBits);
}

/// The segments as the board gets them, and the exact place on them at any tick.
class Train {
 public:
  void append(Ticks duration, const PerAxis<double>& end, const PerAxis<double>& frequency) {
    Segment segment{.id = static_cast<std::uint32_t>(segments_.size()) + 1,
                    .duration = static_cast<std::uint32_t>(duration)};
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      segment.position[axis] = steps(end[axis]);
      segment.velocity[axis] = steps_per_second(frequency[axis]);
    }
    begins_.push_back(duration_);
    duration_ += duration;
    segments_.push_back(segment);
  }

  [[nodiscard]] const std::vector<Segment>& segments() const { return segments_; }
  [[nodiscard]] Ticks duration() const { return duration_; }

  [[nodiscard]] long double place(std::size_t axis, Ticks time) const {
    if (time <= 0) return 0;
    if (time >= duration_) return in_steps(segments_.back().position[axis]);
    const auto next = std::upper_bound(begins_.begin(), begins_.end(), time);
    const auto index = static_cast<std::size_t>(next - begins_.begin()) - 1;
    const Segment& end = segments_[index];
    const Segment start = index == 0 ? Segment{} : segments_[index - 1];
    const long double t = end.duration;
    const long double u = static_cast<long double>(time - begins_[index]) / t;
    const long double way = in_steps(end.position[axis] - start.position[axis]);
    const long double a = t * in_steps(start.velocity[axis]);
    const long double b = t * in_steps(end.velocity[axis]);
    return in_steps(start.position[axis]) + a * u + (3 * way - 2 * a - b) * u * u +
           (a + b - 2 * way) * u * u * u;
  }

 private:
  std::vector<Segment> segments_;
  std::vector<Ticks> begins_;
  Ticks duration_ = 0;
};

std::vector<Pulse> pulses_of(const Train& train) {
  WatchedBoard board;
  board.keep_pulses = true;
  Core core(board);
  REQUIRE(core.set_up(kFastBoard));
  for (const Segment& segment : train.segments()) {
    while (core.status().fifo_free == 0) core.advance(segment.duration);
    REQUIRE(core.push(segment));
  }
  core.advance(core.status().queued_time);
  REQUIRE(core.status().faults == 0);
  REQUIRE_FALSE(core.status().moving);
  return board.pulses;
}

/// The largest distance, in ticks, of a step from the moment at which the axis is half-way between
/// two steps; at most 2, for larger ones are not looked for. Every step in its turn.
long double worst_error(const Train& train, const std::vector<Pulse>& pulses) {
  long double worst = 0;
  PerAxis<std::int64_t> counts{};
  Ticks last = 0;
  for (const Pulse& pulse : pulses) {
    REQUIRE(pulse.when >= last);
    last = pulse.when;
    const long double sense = pulse.direction;
    const long double middle = static_cast<long double>(counts[pulse.axis]) + sense / 2;
    counts[pulse.axis] += pulse.direction;
    const auto missing = [&](Ticks when) {
      return sense * (middle - train.place(pulse.axis, when));
    };
    const auto error_between = [&](Ticks from) {  // the moment lies within that tick
      const long double before = missing(from);
      const long double after = missing(from + 1);
      if (before < 0 || after > 0) return 2.0L;
      const long double part = before == after ? 0 : before / (before - after);
      return std::fabs(static_cast<long double>(from - pulse.when) + part);
    };
    const long double error =
        std::min({error_between(pulse.when - 2), error_between(pulse.when - 1),
                  error_between(pulse.when), error_between(pulse.when + 1)});
    worst = std::max(worst, error);
  }
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    CHECK(counts[axis] == nearest_step(train.segments().back().position[axis]));
  }
  return worst;
}

/// `frequency` on each axis times `part`, for `pieces` segments; one to run up and one to run out.
Train even(double frequency, const PerAxis<double>& part, Ticks piece, int pieces) {
  const double way = frequency * static_cast<double>(piece) / double{kTicksPerSecond};
  Train train;
  PerAxis<double> end{};
  const auto append = [&](double mean, double last) {
    PerAxis<double> velocity{};
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      end[axis] += part[axis] * mean * way;
      velocity[axis] = part[axis] * last * frequency;
    }
    train.append(piece, end, velocity);
  };
  append(0.5, 1.0);
  for (int i = 0; i < pieces; ++i) append(1.0, 1.0);
  append(0.5, 0.0);
  return train;
}

/// From rest to `frequency` at `acceleration` (steps/s^2), back to rest, and the same way back to
/// the start: cubics of constant acceleration, `piece` ticks long but for the last of each ramp.
Train to_and_fro(double frequency, double acceleration, Ticks piece, const PerAxis<double>& part) {
  Train train;
  PerAxis<double> at{};
  double speed = 0.0;
  const auto ramp = [&](double to) {
    const double whole = std::abs(to - speed) / acceleration;
    const double sign = to > speed ? acceleration : -acceleration;
    const double from = speed;
    const PerAxis<double> begin = at;
    const Ticks length = ticks(whole);
    for (Ticks done = 0; done < length;) {
      const Ticks rest = length - done;
      const Ticks duration = rest < piece + kMinSegmentTicks ? rest : piece;
      done += duration;
      const double time = static_cast<double>(done) / kTicksPerSecond;
      PerAxis<double> velocity{};
      for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
        at[axis] = begin[axis] + part[axis] * (from * time + sign * time * time / 2);
        velocity[axis] = done == length ? part[axis] * to : part[axis] * (from + sign * time);
      }
      train.append(duration, at, velocity);
    }
    speed = to;
  };
  for (const double to : {frequency, 0.0, -frequency, 0.0}) ramp(to);
  return train;
}

constexpr PerAxis<double> kXAlone{1.0};
constexpr PerAxis<double> kAllAxes{1.0, -0.999, 0.7071, -0.5, 0.31416, 1.0};

}  // namespace

TEST_CASE("At constant speed every step leaves within a tick of its moment, from 1 Hz to 400 kHz",
          "[hal][LNK-2]") {
  const double frequency = GENERATE(1.0, 3.0, 10.0, 47.0, 333.3, 1e3, 7777.7, 33'333.0, 100e3,
                                    123'456.7, 250e3, 399'990.0);
  const Ticks piece = GENERATE(as<Ticks>{}, 1 << 20, 50'000, 12'345, 250);
  const double seconds = std::clamp(20.0 / frequency, 0.02, 3.0);
  const int pieces = static_cast<int>(seconds * kTicksPerSecond / static_cast<double>(piece)) + 1;
  const Train train = even(frequency, kXAlone, piece, pieces);
  INFO(frequency << " Hz in segments of " << piece << " ticks");
  CHECK(worst_error(train, pulses_of(train)) <= 1.0L);
}

TEST_CASE("Six axes at up to 100 kHz each: every step within a tick, in the order of time",
          "[hal][LNK-2]") {
  const Train train = even(100e3, kAllAxes, 50'000, 100);
  CHECK(worst_error(train, pulses_of(train)) <= 1.0L);
}

TEST_CASE("On ramps too every step leaves within a tick of its moment", "[hal][LNK-2]") {
  // 200 steps/mm at 0.5 m/s^2 … 1000 steps/mm at 10 m/s^2.
  const double acceleration = GENERATE(1e5, 4e5, 1e6, 3e6, 1e7);
  const double frequency = GENERATE(100.0, 5e3, 100e3, 390e3);
  const Ticks piece = GENERATE(as<Ticks>{}, 1'000'000, 50'000, 3'333);
  INFO(acceleration << " steps/s^2 to " << frequency << " Hz in segments of " << piece);
  const bool alone = frequency > 100e3;
  const Train train = to_and_fro(frequency, acceleration, piece, alone ? kXAlone : kAllAxes);
  CHECK(worst_error(train, pulses_of(train)) <= 1.0L);
}

TEST_CASE("While the board itself slows the path down, a step is early or late by 1/800 step",
          "[hal][LNK-8]") {
  // Within a slice (L = 100 us) the board takes path time to pass evenly: a L^2 / 8 = 0.00125 step
  // at a = 1e6 steps/s^2. At 100 kHz (10 us a step) braking takes 5000 steps; the n-th step before
  // the end is due sqrt(2 (n - 1/2) / a) before it.
  WatchedBoard board;
  board.keep_pulses = true;
  Core core(board);
  Setup setup = kFastBoard;
  setup.max_acceleration.fill(std::llround(std::ldexp(1e6 / 1e14, kAccelerationBits)));
  REQUIRE(core.set_up(setup));
  for (std::uint32_t id = 1; id <= 30; ++id)
    REQUIRE(core.push(x_segment(id, 0.01, id * 1000, 100e3)));
  core.advance(ticks(0.1));
  core.stop_along_path();
  core.advance(ticks(0.15));
  REQUIRE(core.status().path_stop == PathStop::stopped);
  // From the second half of the braking: the place at each step against the parabola through three
  // steps far apart, in steps.
  const auto last = static_cast<double>(board.pulses.back().when);
  const auto time = [&](std::size_t back) {
    return (static_cast<double>(board.pulses[board.pulses.size() - 1 - back].when) - last) / 1e7;
  };
  const double t1 = time(600);
  const double t2 = time(2400);
  const double a = 2 * (2400 / t2 - 600 / t1) / (t2 - t1);
  const double v = 600 / t1 - a * t1 / 2;
  CHECK(a == Approx(1e6).epsilon(0.01));
  for (std::size_t back = 100; back <= 2400; back += 7) {
    const double t = time(back);
    CHECK(static_cast<double>(back) == Approx(v * t + a * t * t / 2).margin(3 * 0.00125));
  }
}

TEST_CASE("Of 15 million pulses to and fro none is lost, doubled or out of its time",
          "[hal][LNK-2]") {
  // The whole day is tests/bench/pulse_soak.
  PulseStrokes strokes;
  for (int i = 0; i < 5; ++i) REQUIRE(strokes.stroke(30));
  CHECK(strokes.pulses() == 5 * 3'010'000);
}
