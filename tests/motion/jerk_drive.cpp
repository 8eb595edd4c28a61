#include "tests/motion/jerk_drive.h"

#include <algorithm>
#include <cmath>

#include "motion/curve.h"

namespace cnc::motion::test {

namespace {

constexpr int kSamplesPerCell = 8;

double largest_part(const Position& values, const Position& limits) {
  double part = 0.0;
  for (const Axis axis : kAllAxes) part = std::max(part, std::abs(values[axis]) / limits[axis]);
  return part;
}

}  // namespace

JerkLimits jerk_limits(double jerk) {
  return {Position::filled(100.0), Position::filled(500.0), Position::filled(jerk)};
}

std::vector<Position> random_vertices(std::mt19937& random, int count) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double turn = std::exp(between(std::log(0.02), std::log(2.0)));
  const double step = std::exp(between(std::log(0.05), std::log(2.0)));
  const double slope = between(0.0, 1.0) < 0.5 ? 0.0 : between(0.0, 1.0);
  const double rotary = between(0.0, 1.0) < 0.7 ? 0.0 : between(0.0, 5.0);
  double heading = between(-3.0, 3.0);
  std::vector<Position> vertices{{}};
  for (int i = 0; i < count; ++i) {
    heading += between(-turn, turn);
    const double length =
        between(0.0, 1.0) < 0.05 ? between(1.0, 30.0) : step * std::exp(between(-1.0, 1.0));
    Position next = vertices.back();
    next[Axis::X] += length * std::cos(heading);
    next[Axis::Y] += length * std::sin(heading);
    next[Axis::Z] += length * slope * between(-1.0, 1.0);
    next[Axis::A] += length * rotary * between(-1.0, 1.0);
    vertices.push_back(next);
  }
  return vertices;
}

double JerkUsage::worst() const { return std::max({velocity, acceleration, jerk}); }

double JerkDrive::length() const {
  double sum = 0.0;
  for (const PathInterval& interval : path_) sum += interval.length;
  return sum;
}

void JerkDrive::feed() {
  while (next_ < path_.size() && plan.wants_path()) plan.append(path_[next_++]);
  if (next_ == path_.size()) plan.stop_at_end();
  while (plan.due()) {
    if (plan.plan()) continue;
    ++failed_plans_;
    break;
  }
}

Position JerkDrive::acceleration(const PathMotion& motion) const {
  const PathInterval& q = plan.intervals()[motion.place.interval];
  const double u = motion.place.start;
  return motion.w * q.first_at(u) + (motion.v * motion.v) * q.second_at(u);
}

void JerkDrive::sample() {
  const PathMotion motion = plan.motion();
  const PathInterval& q = plan.intervals()[motion.place.interval];
  const double u = motion.place.start;
  const double x = motion.v * motion.v;
  const Position first = q.first_at(u);
  const Position velocity = motion.v * first;
  usage_.velocity = std::max(usage_.velocity, largest_part(velocity, limits_.velocity));
  const double speed =
      linear_length(first) > 0.0 ? linear_length(velocity) : rotary_length(velocity);
  usage_.feed = std::max(usage_.feed, speed / q.feed);
  usage_.acceleration =
      std::max(usage_.acceleration, largest_part(acceleration(motion), limits_.acceleration));
  if (motion.v == 0.0) return;
  const Position jerk =
      motion.v * (motion.dw * first + 3.0 * motion.w * q.second_at(u) + x * q.third);
  usage_.jerk = std::max(usage_.jerk, largest_part(jerk, limits_.jerk));
}

void JerkDrive::sample_leap(const PathMotion& before) {
  const Position leap = acceleration(plan.motion()) - acceleration(before);
  usage_.leap = std::max(usage_.leap, largest_part(leap, limits_.acceleration));
}

void JerkDrive::step(double time) {
  const double whole = plan.time_in_cell();
  const double part = std::min(time, whole) / kSamplesPerCell;
  for (int i = 0; i + 1 < kSamplesPerCell; ++i) {
    sample();
    plan.advance(part);
  }
  sample();
  const bool to_end = time >= whole;
  plan.advance(to_end ? plan.time_in_cell() - std::min(1e-9, 0.5 * part) : part);
  sample();
  if (to_end) {
    const PathMotion before = plan.motion();
    plan.advance_to(plan.behind_cell(plan.place()));
    if (!plan.standing()) sample_leap(before);
  }
  time_ += std::min(time, whole);
  if (plan.standing()) ++stops_;
  plan.forget_before(plan.place());
}

void JerkDrive::run() {
  for (;;) {
    feed();
    if (plan.standing()) return;
    step();
  }
}

}  // namespace cnc::motion::test
