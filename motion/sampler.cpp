#include "motion/sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cnc::motion {

namespace {

/// Acceleration of a cubic above its limit that is rounding: a part of the limit, and the
/// positions' own last digits seen over the square of the duration.
constexpr double kRelativeRounding = 1e-7;
constexpr double kPositionRounding = 4e-15;  // of a coordinate

/// Longest setpoint on a curve so that its cubic differs by no more than the tolerance in position
/// (p h⁴/384, with the fourth derivative p) and by no more than the reserve in acceleration
/// (p h²/12).
double longest_on(const Step& step, const Leg& leg) {
  if (step.straight) return std::numeric_limits<double>::infinity();
  const double fastest = std::max(leg.start_speed, leg.end_speed);
  const double p = fourth_derivative(step, fastest * fastest, std::abs(leg.w));
  if (p == 0.0) return std::numeric_limits<double>::infinity();
  const double by_acceleration = std::sqrt(12.0 * kCubicReserve * step.weakest / p);
  const double by_position = std::sqrt(std::sqrt(384.0 * kCubicTolerance / p));
  return std::max(kShortestSetpoint, std::min(by_acceleration, by_position));
}

/// Collects legs into one setpoint.
class Draft {
 public:
  Draft(const Track& track, double max_duration)
      : track_(track),
        longest_(max_duration),
        start_position_(track.position_at(track.place())),
        start_velocity_(track.velocity_at(track.place())),
        place_(track.place()),
        from_rest_(track.place().speed == 0.0) {}

  /// Takes in the next leg or a part of it; false when the setpoint ends where it ended before.
  bool add(const Leg& leg) {
    if (legs_ == kMostLegs) return false;
    const double longest = std::min(longest_, longest_on(track_.step(place_.step), leg));
    const double part = part_of(leg, longest - time_);
    if (part <= 0.0) return false;
    const bool whole = part >= leg.duration();
    const Place end = whole ? track_.behind(place_, leg) : track_.inside(place_, leg, part);
    Setpoint longer = setpoint_to(end, time_ + part);
    const bool rest_to_rest = from_rest_ && end.speed == 0.0 && time_ + part < kShortestSetpoint;
    if (legs_ > 0 && !rest_to_rest && !keeps_limits(longer)) return false;
    const Piece& piece = track_.piece_at(place_);
    longer.tag = piece.tag;
    longer.feed_limit = piece.kind == MoveKind::feed ? piece.feed : 0.0;
    setpoint_ = longer;
    passed_[legs_++] = {longer.duration, longer.position};
    longest_ = longest;
    place_ = end;
    time_ += part;
    return whole && end.speed > 0.0;
  }

  [[nodiscard]] bool empty() const { return legs_ == 0; }
  [[nodiscard]] const Place& place() const { return place_; }

  /// A whole motion from rest to rest may take its time: h is stretched to the shortest setpoint,
  /// or where that is less to what one cubic needs, 6 d/h² <= a, for the way d = a t²/4 that two
  /// ramps make in t.
  [[nodiscard]] Setpoint setpoint() const {
    Setpoint result = setpoint_;
    if (from_rest_ && place_.speed == 0.0 && result.duration < kShortestSetpoint) {
      result.duration = std::max(kShortestSetpoint, std::sqrt(1.5) * result.duration);
    }
    return result;
  }

 private:
  struct Passed {
    double time;
    Position position;
  };

  /// Seconds of the leg that fit into `room`, so that neither this setpoint nor the next one, which
  /// begins with the rest of the leg, becomes needlessly short.
  [[nodiscard]] double part_of(const Leg& leg, double room) const {
    const double whole = leg.duration();
    if (whole <= room * (1.0 + 1e-9)) return whole;
    if (time_ == 0.0) return whole / std::ceil(whole / room);
    if (room < kShortestSetpoint) return 0.0;
    return std::min(room, whole - kShortestSetpoint);
  }

  [[nodiscard]] Setpoint setpoint_to(const Place& end, double duration) const {
    Setpoint setpoint;
    setpoint.duration = duration;
    setpoint.position = track_.position_at(end);
    setpoint.velocity = track_.velocity_at(end);
    return setpoint;
  }

  /// Whether one cubic to the end of `longer` keeps the axes' limits and meets the planned motion
  /// where the legs collected so far end.
  [[nodiscard]] bool keeps_limits(const Setpoint& longer) const {
    const double seen = 6.0 * kPositionRounding / (longer.duration * longer.duration);
    for (const Axis axis : kAllAxes) {
      const double noise = seen * (1.0 + std::abs(longer.position[axis]));
      const AxisCubic cubic = cubic_of(axis, start_position_, start_velocity_, longer);
      const double allowed =
          track_.limits().max_acceleration[axis] * (1.0 + kRelativeRounding) + noise;
      if (std::abs(cubic.start_acceleration()) > allowed) return false;
      if (std::abs(cubic.end_acceleration()) > allowed) return false;
      const double fastest = track_.limits().max_velocity[axis] * (1.0 + kRelativeRounding);
      if (cubic.fastest() > fastest) return false;
      for (std::size_t i = 0; i < legs_; ++i) {
        const double there = cubic.position(passed_[i].time);
        if (std::abs(there - passed_[i].position[axis]) > kCubicTolerance) return false;
      }
    }
    return true;
  }

  const Track& track_;
  double longest_;
  Position start_position_;
  Position start_velocity_;
  Place place_;
  bool from_rest_;
  double time_ = 0.0;
  std::size_t legs_ = 0;
  std::array<Passed, kMostLegs> passed_{};
  Setpoint setpoint_;
};

}  // namespace

std::optional<Setpoint> Sampler::next(Track& track, bool braking) const {
  Draft draft(track, max_duration_);
  for (;;) {
    const auto leg = track.leg_from(draft.place(), braking);
    if (!leg || !draft.add(*leg)) break;
  }
  if (draft.empty()) return std::nullopt;
  track.advance(draft.place());
  return draft.setpoint();
}

}  // namespace cnc::motion
