#include "motion/acceleration_profile.h"

#include "motion/trapezoid.h"

namespace cnc::motion {

AccelerationProfile::AccelerationProfile(const AxisLimits& limits, double max_duration,
                                         bool goes_back)
    : track_(limits, goes_back ? kMostStepsBehind : 0), sampler_(max_duration) {}

void AccelerationProfile::append(const Piece& piece) {
  if (piece.entry != Entry::vertex) {
    track_.append_span(piece);
  } else {
    track_.plan();
    track_.append(piece);
  }
}

void AccelerationProfile::set_overrides(const Overrides& overrides) {
  overrides_ = overrides;
  track_.set_overrides(overrides);
}

std::optional<Setpoint> AccelerationProfile::next(bool held) { return sampler_.next(track_, held); }

std::optional<Stretch> AccelerationProfile::skip() {
  if (track_.empty()) return std::nullopt;
  const MoveTag tag = track_.piece_at(track_.place()).tag;
  const double duration = track_.skip();
  return duration > 0.0 ? std::optional(Stretch{duration, tag}) : std::nullopt;
}

double AccelerationProfile::time_to_end() const {
  const double rest = track_.unplanned_length();
  const double planned = track_.time_to_end();
  if (rest <= 0.0) return planned;
  return planned + time_alone(track_.last_piece(), rest, track_.limits(), overrides_);
}

void AccelerationProfile::forget_before(const ProfilePlace& place) {
  track_.forget_before(std::get<Place>(place).step);
}

std::uint64_t AccelerationProfile::steps_since(const ProfilePlace& place) const {
  return track_.place().step - std::get<Place>(place).step;
}

bool AccelerationProfile::keeps_too_much(const ProfilePlace& oldest) const {
  return steps_since(oldest) > kMostStepsBehind;
}

bool AccelerationProfile::can_keep_more(const ProfilePlace& oldest) const {
  return steps_since(oldest) + kMostLegs <= kMostStepsBehind;
}

bool AccelerationProfile::can_go_on_alone() const {
  return track_.was_further() || track_.sufficient();
}

}  // namespace cnc::motion
