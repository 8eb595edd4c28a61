#include "motion/smoother.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace cnc::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Where the direction changes by more than 150°, the machine stops: a curve around such a corner
/// is no faster.
constexpr double kReversal = 1.9318516525781366;  // |u2 - u1| at 150°: 2 sin 75°

/// Each step is at most as much longer than its neighbour towards the vertex.
constexpr double kGrowth = 1.7;

/// Arcs of more turns are driven exactly: their nodes would be without number.
constexpr double kMostTurns = 2.0;

/// Part of the tolerance that arcs may use where the feed bounds their speed anyway: bending less
/// would gain nothing and cost accuracy.
constexpr double kFeedBoundShare = 0.1;

/// That is where the centripetal acceleration at the feed is below this part of what axes can do.
constexpr double kFeedBound = 0.7;

/// Fills `steps` with steps from both ends of a length towards its middle, two at least. They are
/// scaled to fill it by whoever uses them.
void grade(double length, double first, double last, double longest, std::vector<double>& steps) {
  // More than it takes to grow from a nanometre to a kilometre.
  constexpr std::size_t kMost = 96;
  std::array<double, kMost> from_end;
  std::size_t count = 0;
  double left = std::min(first, longest);
  double right = std::min(last, longest);
  double sum = 0.0;
  steps.clear();
  while (sum < length || steps.size() + count < 2) {
    if (left <= right || count == kMost) {
      steps.push_back(left);
      sum += left;
      left = std::min(left * kGrowth, longest);
    } else {
      from_end[count++] = right;
      sum += right;
      right = std::min(right * kGrowth, longest);
    }
  }
  while (count > 0) steps.push_back(from_end[--count]);
}

/// Of the axes that move at all.
double weakest(const AxisLimits& limits) {
  double least = kInfinity;
  for (const Axis axis : kLinearAxes) {
    if (limits.max_acceleration[axis] > 0.0) least = std::min(least, limits.max_acceleration[axis]);
  }
  return least;
}

}  // namespace

Smoother::Smoother(const AxisLimits& limits, double tolerance_use, double exact_path)
    : spline_(std::pow(10.0, -4.0 * std::clamp(tolerance_use, 0.0, 1.0))),
      weakest_acceleration_(weakest(limits)),
      exact_path_(exact_path) {}

void Smoother::clear() {
  spline_.clear();
  segments_.clear();
  sources_.clear();
  span_count_.clear();
  ready_.clear();
  in_run_ = false;
}

namespace {

double turns_of(const Curve& curve) {
  const auto* arc = std::get_if<Arc>(&curve);
  return arc ? std::abs(arc->sweep()) / (2.0 * std::numbers::pi) : 0.0;
}

Position direction(const Curve& curve, double s) {
  const Position tangent = tangent_of(curve, s);
  return tangent * (1.0 / norm(tangent));
}

}  // namespace

bool Smoother::can_be_smoothed(const Piece& piece) const {
  const bool has_tube = piece.kind == MoveKind::feed && piece.tolerance > 0.0;
  return (has_tube || exact_path_ > 0.0) && measure_of(piece.curve) == Measure::linear &&
         turns_of(piece.curve) <= kMostTurns;
}

/// Whether the machine has to stand before the segment.
bool Smoother::ends_run(const Segment& segment) const {
  const Piece& piece = segment.piece;
  const Piece& last = segments_.empty() ? last_placed_.piece : segments_.back().piece;
  if (piece.kind != last.kind) return true;
  const bool exact = std::min(piece.tolerance, last.tolerance) <= 0.0;
  // |u2 − u1| of the corner's angle.
  const double corner = 2.0 * std::sin(0.5 * piece.laf_angle * std::numbers::pi / 180.0);
  return segment.turn > (exact ? std::min(corner, kReversal) : kReversal);
}

void Smoother::add(const Piece& piece) {
  if (!can_be_smoothed(piece)) {
    finish();
    ready_.reserve(ready_.size() + 1);
    ready_.push_back(piece);
    return;
  }
  Segment segment{.piece = piece, .stretch = norm(tangent_of(piece.curve, 0.0))};
  segment.length = piece.end * segment.stretch;
  if (const auto* arc = std::get_if<Arc>(&piece.curve)) {
    segment.radius = segment.stretch * segment.stretch / norm(arc->bend(0.5 * piece.end));
  }
  segment.tolerance = tolerance_of(piece, segment.radius);
  segment.longest_step = longest_step(segment);
  if (in_run_) {
    const Segment& last = segments_.empty() ? last_placed_ : segments_.back();
    segment.turn = norm(direction(piece.curve, 0.0) - direction(last.piece.curve, last.piece.end));
    segment.kink = segment.turn / std::min(last.length, segment.length);
    if (ends_run(segment)) finish();
  }
  if (!in_run_) {
    segment.turn = segment.kink = 0.0;
    begin_run(segment);
  }
  segments_.push_back(segment);
  if (segments_.size() > 2) place_front();
  if (piece.stop_at_end) finish();
}

double Smoother::tolerance_of(const Piece& piece, double radius) const {
  const bool feed_bound =
      radius > 0.0 && piece.feed * piece.feed < kFeedBound * weakest_acceleration_ * radius;
  // Where jerk is limited the curve has to pass from straight to round.
  const bool has_use_for_more = exact_path_ > 0.0 || !feed_bound;
  return std::max(piece.tolerance, exact_path_) * (has_use_for_more ? 1.0 : kFeedBoundShare);
}

/// On arcs a quarter of a radian, and so short that a cubic spline through the arc's points leaves
/// it by no more than a quarter of the tolerance: h⁴ q''''/384.
double Smoother::longest_step(const Segment& segment) const {
  const auto* arc = std::get_if<Arc>(&segment.piece.curve);
  if (arc == nullptr) return segment.length;
  const double turning = std::abs(arc->sweep()) / segment.length;
  const double accurate =
      std::pow(0.25 * 384.0 * segment.tolerance * segment.radius / (turning * turning), 0.25);
  return std::min({0.25 / turning, 0.25 * segment.length, accurate});
}

void Smoother::begin_run(const Segment& first) {
  spline_.begin(point_of(first.piece.curve, 0.0), first.tolerance);
  last_placed_ = {};
  next_entry_ = Entry::standstill;
  in_run_ = true;
}

void Smoother::finish() {
  if (!in_run_) return;
  in_run_ = false;
  if (is_one_line()) return pass_front();
  while (!segments_.empty()) place_front();
  spline_.finish();
  collect();
}

bool Smoother::is_one_line() const {
  const bool nothing_placed = last_placed_.length == 0.0;
  return nothing_placed && segments_.size() == 1 && is_straight(segments_.front().piece.curve);
}

/// There is nothing to be smoothed, and a line that goes on in the direction of the rapid before it
/// (drilling) needs no standstill.
void Smoother::pass_front() {
  ready_.reserve(ready_.size() + 1);
  ready_.push_back(segments_.front().piece);
  segments_.pop_front();
  spline_.clear();
}

bool Smoother::stop_at_end() {
  finish();
  if (ready_.empty()) return false;
  ready_.back().stop_at_end = true;
  return true;
}

/// Length beside the vertex between two segments on which the path can turn within the tolerance.
/// `kink`: the largest of this and the neighbouring vertices.
double Smoother::first_step(const Segment& before, const Segment& after, double kink) const {
  const double p = std::min(before.tolerance, after.tolerance);
  const double shorter = std::min(before.length, after.length);
  double step = std::max(p, 0.5 * shorter);
  if (after.turn > 0.0) step = std::min(step, std::max(p, 2.0 * p / after.turn));
  if (kink > 0.0) step = std::min(step, std::max(p, 0.35 * std::sqrt(8.0 * p / kink)));
  for (const Segment* side : {&before, &after}) {
    if (side->radius > 0.0) step = std::min(step, 0.35 * std::sqrt(8.0 * p * side->radius));
  }
  return step;
}

/// Puts the nodes of the foremost segment; the two behind it are known, or the run ends with fewer.
void Smoother::place_front() {
  Segment none;
  none.length = none.tolerance = kInfinity;
  const Segment& segment = segments_.front();
  const std::uint64_t first = segments_.first();
  const std::size_t known = segments_.size();
  const Segment& next = known > 1 ? segments_[first + 1] : none;
  const Segment& after_next = known > 2 ? segments_[first + 2] : none;
  const bool begins = last_placed_.length == 0.0;
  const Segment& before = begins ? none : last_placed_;

  const double first_kink = std::max({before.kink, segment.kink, next.kink});
  const double last_kink = std::max({segment.kink, next.kink, after_next.kink});
  grade(segment.length, first_step(before, segment, first_kink),
        first_step(segment, next, last_kink), segment.longest_step, steps_);
  const double scale = segment.length / std::accumulate(steps_.begin(), steps_.end(), 0.0);

  sources_.reserve(sources_.size() + 1);
  span_count_.reserve(span_count_.size() + 1);
  sources_.push_back(segment.piece);
  span_count_.push_back(steps_.size());
  double from = 0.0;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const bool last = i + 1 == steps_.size();
    const double to = last ? segment.length : from + steps_[i] * scale;
    add_span(segment, from, to,
             last ? std::min(segment.tolerance, next.tolerance) : segment.tolerance);
    from = to;
  }
  last_placed_ = segment;
  segments_.pop_front();
  collect();
}

void Smoother::add_span(const Segment& segment, double from, double to, double end_tolerance) {
  const Curve& curve = segment.piece.curve;
  const double middle = 0.5 * (from + to) / segment.stretch;
  spline_.add({.length = to - from,
               .middle = point_of(curve, middle),
               .middle_tangent = direction(curve, middle),
               .end = to == segment.length ? point_of(curve, segment.piece.end)
                                           : point_of(curve, to / segment.stretch),
               .end_tolerance = end_tolerance});
}

void Smoother::collect() {
  ready_.reserve(ready_.size() + spline_.ready());
  for (; spline_.ready() > 0; spline_.pop()) {
    const TubeSpline::Ready& span = spline_.front();
    Piece& piece = ready_.push_back();
    static_cast<Wishes&>(piece) = sources_.front();
    piece.curve = span.curve;
    piece.begin = piece.stepped = 0.0;
    piece.end = span.curve.length();
    piece.stop_at_end = span.stop_at_end;
    piece.entry = std::exchange(next_entry_, span.stop_at_end ? Entry::standstill : Entry::smooth);
    if (--span_count_.front() == 0) {
      span_count_.pop_front();
      sources_.pop_front();
    }
  }
}

}  // namespace cnc::motion
