#include "motion/track.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/junction.h"

namespace cnc::motion {

namespace {

/// Steps kept free so that a corner blend and the first steps behind it always find room.
constexpr std::size_t kSpareSteps = 256;
static_assert(kMostStepsOfCubic < kSpareSteps);

/// A blend leaves at least this share of a curve to the curve itself: no sliver between two blends.
constexpr double kLargestCutShare = 0.45;

/// Beyond the braking distance, this much time at full speed: setpoints are drawn in batches.
constexpr double kLookAheadTime = 0.1;

/// In units of the distance that planning needs to look ahead.
constexpr double kStock = 1.3;

/// skip() goes on for this long where more path may still change the plan behind it, s.
constexpr double kSkipTime = 0.005;

/// Of x; the same that a leg takes for standing still.
constexpr double kRounding = 1e-9;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of the axes that may move.
Position inverse(const Position& limit) {
  Position result;
  for (const Axis axis : kAllAxes) result[axis] = limit[axis] > 0.0 ? 1.0 / limit[axis] : 0.0;
  return result;
}

/// 1 / largest_along(), without a division for every axis.
double largest_share(const Position& direction, const Position& per_limit) {
  double share = 0.0;
  for (const Axis axis : kAllAxes) {
    share = std::max(share, std::abs(direction[axis] * per_limit[axis]));
  }
  return share;
}

bool is_further(const Place& a, const Place& b) {
  return a.step != b.step ? a.step > b.step : a.done > b.done;
}

/// The end of a step is reached when less than rounding is left. At rest a little earlier: speeding
/// up and slowing down over what is left must not end half-way, with the speed of its middle.
bool is_end_of(const Step& step, double done, double speed) {
  const double rounding = speed > 0.0 ? 1e-12 : 1e-11;
  return step.length - done <= rounding * (1.0 + step.length);
}

}  // namespace

Track::Track(const AxisLimits& limits, std::size_t steps_behind)
    : limits_(limits),
      per_velocity_(inverse(limits.max_velocity)),
      per_acceleration_(inverse(limits.max_acceleration)),
      pieces_(kMostStepsAhead + steps_behind),
      steps_(kMostStepsAhead + steps_behind) {}

// --- appending -----------------------------------------------------------------------------------

bool Track::sufficient() const {
  if (empty()) return false;
  return steps_are_many() || known_way() >= look_ahead_;
}

bool Track::well_stocked() const {
  return sufficient() && (steps_are_many() || known_way() >= kStock * look_ahead_);
}

bool Track::steps_are_many() const {
  return steps_.end() - place_.step > kMostStepsAhead - kSpareSteps;
}

/// From the present place to the end of the steps, mm.
double Track::known_way() const {
  const double end = steps_.back().distance + steps_.back().length;
  return end - steps_[place_.step].distance - place_.done;
}

bool Track::extend() {
  if (pieces_.empty()) return true;
  cut_into_steps(Until::well_stocked);
  return pieces_.back().stepped >= pieces_.back().end;
}

void Track::cut_into_steps(Until until) {
  Piece& last = pieces_.back();
  while (last.stepped < last.end && (until == Until::end || !well_stocked())) {
    const double left = last.end - last.stepped;
    const double count = std::max(1.0, std::ceil(left / last.grid - 1e-9));
    push_step(pieces_.end() - 1, left / count, false);
    if (count == 1.0) last.stepped = last.end;
  }
}

void Track::append(const Piece& piece) {
  if (empty()) return push(piece, true);
  const Piece& last = pieces_.back();
  const double length = piece.end;
  const BlendLimits limits{kExactPathTolerance, std::min(last.laf_angle, piece.laf_angle),
                           free_before_end(), kLargestCutShare * length};
  const Junction junction = last.stop_at_end
                                ? Junction{JunctionKind::corner}
                                : judge_junction(last.curve, last.end, piece.curve, limits);
  if (junction.kind == JunctionKind::blend && append_blended(piece, junction.cut)) return;
  push(piece, junction.kind != JunctionKind::smooth);
}

/// The present place may lie so close to the old end that the machine cannot slow down for the
/// blend any more; then nothing has changed and the answer is no.
bool Track::append_blended(const Piece& piece, double cut) {
  const Piece& last = pieces_.back();
  const double old_end = last.end;
  Piece blend = last;
  blend.curve = make_blend(last.curve, old_end, piece.curve, cut);
  blend.begin = 0.0;
  blend.end = 2.0 * cut;
  blend.stop_at_end = false;
  if (last.kind == MoveKind::rapid || piece.kind == MoveKind::feed) {
    blend.feed = last.kind == piece.kind ? std::min(last.feed, piece.feed) : piece.feed;
    blend.kind = piece.kind;
  }
  Piece rest = piece;
  rest.begin = cut;

  set_end_of_last(old_end - cut);
  push(blend, false);
  cut_into_steps(Until::end);
  push(rest, false);
  if (place_is_safe()) return true;
  pop_last_piece();
  pop_last_piece();
  set_end_of_last(old_end);
  return false;
}

void Track::append_span(const Piece& piece) {
  const bool stop_before = empty() || piece.entry == Entry::standstill;
  push_unplanned(piece, stop_before);
}

void Track::push(const Piece& piece, bool stop_before) {
  push_unplanned(piece, stop_before);
  extend();
  plan();
}

void Track::push_unplanned(const Piece& wanted, bool stop_before) {
  Piece& piece = pieces_.push_back();
  piece = wanted;
  const Position direction = tangent_of(piece.curve, piece.begin);
  const double feed = piece.kind == MoveKind::feed
                          ? piece.feed * std::max(1.0, overrides_.of(piece.override))
                          : kInfinity;
  const double speed = std::min(feed, 1.0 / largest_share(direction, per_velocity_));
  const double acceleration = 1.0 / largest_share(direction, per_acceleration_);
  look_ahead_ = std::max(look_ahead_, speed * speed / acceleration + speed * kLookAheadTime);

  piece.grid = grid_length(piece.curve, piece.begin, piece.end, speed, acceleration);
  piece.stepped = piece.begin;
  const double count = std::max(1.0, std::ceil((piece.end - piece.begin) / piece.grid - 1e-9));
  push_step(pieces_.end() - 1, (piece.end - piece.begin) / count, stop_before);
  if (count == 1.0) piece.stepped = piece.end;
}

void Track::push_step(std::uint64_t piece_index, double length, bool stop_before) {
  Piece& piece = pieces_[piece_index];
  const double distance = steps_.empty() ? 0.0 : steps_.back().distance + steps_.back().length;
  Step& step = steps_.push_back();
  set_step(step, piece.curve, piece.stepped, length, limits_);
  step.piece = piece_index;
  step.stop_before = stop_before;
  step.distance = distance;
  apply_feed(step, piece);
  piece.stepped += length;
}

void Track::pop_last_piece() {
  while (!steps_.empty() && steps_.back().piece == pieces_.end() - 1) steps_.pop_back();
  pieces_.pop_back();
}

/// Shortens or lengthens the last curve; never at what the machine is already driving.
void Track::set_end_of_last(double end) {
  Piece& last = pieces_.back();
  last.end = end;
  Step& step = steps_.back();
  if (step.straight) {
    step.length = end - step.start;
    step.machine_entry = -1.0;  // computed anew
    last.stepped = end;
  } else {
    // The step that comes to lie across the end goes too, and one that would leave a sliver.
    while (steps_.back().end() > end - 0.5 * last.grid && steps_.back().start > last.begin &&
           steps_.end() - 1 > furthest_.step) {
      steps_.pop_back();
    }
    last.stepped = steps_.back().end();
  }
  cut_into_steps(Until::end);
  plan();
}

/// How much of the last curve a blend may still take: nothing of what has been driven.
double Track::free_before_end() const {
  const Piece& last = pieces_.back();
  if (at_end(furthest_)) return 0.0;
  const double share = kLargestCutShare * length_of(last.curve);
  const Step& step = steps_[furthest_.step];
  if (step.piece != pieces_.end() - 1) return share;
  const double driven = step.straight ? step.start + furthest_.done : step.end();
  return std::min(share, 0.9 * (last.end - driven));
}

void Track::stop_at_end() {
  if (!pieces_.empty()) pieces_.back().stop_at_end = true;
}

// --- planning ------------------------------------------------------------------------------------

void Track::set_overrides(const Overrides& overrides) {
  if (overrides == overrides_) return;
  overrides_ = overrides;
  ++plan_;
  for (std::uint64_t i = steps_.first(); i != steps_.end(); ++i) {
    apply_feed(steps_[i], pieces_[steps_[i].piece]);
    steps_[i].wanted_entry = -1.0;
  }
  plan();
}

void Track::apply_feed(Step& step, const Piece& piece) const {
  if (piece.kind == MoveKind::rapid) {
    step.wanted_x = step.machine_x * overrides_.rapid * overrides_.rapid;
  } else {
    const double feed = piece.feed * overrides_.of(piece.override) / step.stretch;
    step.wanted_x = std::min(step.machine_x, feed * feed);
  }
}

/// Largest x that the two steps which meet at the begin of step `index` allow there.
double Track::entry_limit(std::uint64_t index, double Step::*limit) const {
  const Step& step = steps_[index];
  if (step.stop_before) return 0.0;
  if (index == steps_.first()) return step.*limit;
  return std::min(step.*limit, steps_[index - 1].*limit);
}

/// Plans the steps from number `end` − 1 back to the one behind the machine's own; those from `end`
/// on are planned.
void Track::plan_backward(std::uint64_t end) {
  Exit exit = end == steps_.end() ? Exit{0.0, 0.0}
                                  : Exit{steps_[end].machine_entry, steps_[end].wanted_entry};
  for (std::uint64_t i = end; i-- > place_.step + 1;) {
    Step& step = steps_[i];
    const double machine = largest_entry(step, exit.machine_x);
    const double wanted =
        exit.wanted_x == exit.machine_x ? machine : largest_entry(step, exit.wanted_x);
    const Exit entry{std::min(entry_limit(i, &Step::machine_x), machine),
                     std::min(entry_limit(i, &Step::wanted_x), wanted)};
    if (entry.machine_x == step.machine_entry && entry.wanted_x == step.wanted_entry) return;
    step.machine_entry = entry.machine_x;
    step.wanted_entry = entry.wanted_x;
    exit = entry;
  }
}

Exit Track::exit_of(std::uint64_t index) const {
  if (index + 1 == steps_.end()) return {0.0, 0.0};
  return {steps_[index + 1].machine_entry, steps_[index + 1].wanted_entry};
}

/// Whether the machine can keep its limits from where it is with the speed that it has. On the way
/// to a standstill its x is exactly what braking takes, so that rounding counts as a part of x.
bool Track::place_is_safe() const {
  const Step& step = steps_[place_.step];
  const double x = place_.speed * place_.speed;
  const double left = step.length - place_.done;
  const double braking = step.straight ? -step.along : allowed_w(step, place_.done, x).low;
  return x + 2.0 * left * braking <= exit_of(place_.step).machine_x + kRounding * x;
}

// --- moving along --------------------------------------------------------------------------------

void Track::advance(const Place& place) {
  place_ = place;
  if (!was_further()) furthest_ = place_;
}

bool Track::was_further() const { return is_further(furthest_, place_); }

void Track::forget_before(std::uint64_t step) {
  while (steps_.first() < step) steps_.pop_front();
  if (steps_.empty()) return clear();
  while (pieces_.first() < steps_.front().piece) pieces_.pop_front();
}

/// What was appended since, and overrides, may have changed the plan of the steps in between.
void Track::go_back(const Place& place) {
  const std::uint64_t planned = std::min(place_.step + 1, steps_.end());
  place_ = place;
  for (std::uint64_t i = place_.step + 1; i < planned; ++i) steps_[i].machine_entry = -1.0;
  plan_backward(planned);
}

double Track::skip() {
  if (empty()) return 0.0;
  double room = sufficient() ? known_way() - look_ahead_ : kInfinity;
  const std::uint64_t piece = steps_[place_.step].piece;
  double time = 0.0;
  Place place = place_;
  while (!at_end(place) && steps_[place.step].piece == piece) {
    const auto leg = leg_from(place, false);
    if (!leg) break;
    const double whole = leg->duration();
    if (leg->length > room) {
      if (time > 0.0) break;
      if (whole > kSkipTime) {
        place = inside(place, *leg, kSkipTime);
        time = kSkipTime;
        break;
      }
    }
    place = behind(place, *leg);
    time += whole;
    room -= leg->length;
  }
  advance(place);
  return time;
}

void Track::clear() {
  steps_.clear();
  pieces_.clear();
  place_ = {};
  place_.step = steps_.end();
  furthest_ = place_;
  look_ahead_ = 0.0;
}

const Piece& Track::piece_at(const Place& place) const { return pieces_[steps_[place.step].piece]; }

Position Track::position_at(const Place& place) const {
  if (at_end(place)) return point_of(pieces_.back().curve, pieces_.back().end);
  const Step& step = steps_[place.step];
  return point_of(pieces_[step.piece].curve, step.start + place.done);
}

Position Track::velocity_at(const Place& place) const {
  if (at_end(place) || place.speed == 0.0) return {};
  const Step& step = steps_[place.step];
  return tangent_of(pieces_[step.piece].curve, step.start + place.done) * place.speed;
}

std::optional<Leg> Track::leg_from(const Place& place, bool braking) const {
  if (at_end(place)) return std::nullopt;
  if (place.rest.length > 0.0 && place.plan == plan_ && !braking) return place.rest;
  return next_leg(steps_[place.step], place.done, place.speed, exit_of(place.step), braking);
}

Place Track::behind(const Place& place, const Leg& leg) const {
  const double done = place.done + leg.length;
  if (is_end_of(steps_[place.step], done, leg.end_speed))
    return {place.step + 1, 0.0, leg.end_speed, {}, plan_};
  return {place.step, done, leg.end_speed, {}, plan_};
}

Place Track::inside(const Place& place, const Leg& leg, double time) const {
  const double way = time * (leg.start_speed + 0.5 * leg.w * time);
  const double speed = std::max(0.0, leg.start_speed + leg.w * time);
  const Leg rest{leg.w, leg.length - way, speed, leg.end_speed};
  return {place.step, place.done + way, speed, steps_[place.step].straight ? Leg{} : rest, plan_};
}

double Track::time_to_end() const {
  double time = 0.0;
  for (Place place = place_; !at_end(place);) {
    const auto leg = leg_from(place, false);
    if (!leg) return kInfinity;
    time += leg->duration();
    place = behind(place, *leg);
  }
  return time;
}

double Track::unplanned_length() const {
  return pieces_.empty() ? 0.0 : pieces_.back().end - pieces_.back().stepped;
}

}  // namespace cnc::motion
