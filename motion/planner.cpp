#include "motion/planner.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <utility>

#include "motion/extents.h"
#include "motion/move_checks.h"
#include "motion/ring.h"
#include "motion/sampler.h"
#include "motion/simplifier.h"
#include "motion/smoother.h"
#include "motion/track.h"

namespace cnc::motion {

namespace {

/// Moves that may wait behind what is planned; a caller that asks full() never has more than a
/// batch.
constexpr std::size_t kMostWaiting = 65'536;

/// So many moves go to the track at once: every time, the speed plan changes over a whole braking
/// distance before its end.
constexpr std::size_t kBatch = 64;

/// Time of a curve from standstill to standstill, at no more than `speed`: a trapezoid.
double time_alone(double length, double speed, double acceleration) {
  if (speed <= 0.0) return std::numeric_limits<double>::infinity();
  if (length * acceleration < speed * speed) return 2.0 * std::sqrt(length / acceleration);
  return length / speed + speed / acceleration;
}

/// Where the machine was before a setpoint was drawn.
struct Mark {
  Place place;
  Position position;
};

/// Setpoints that were taken back without it being known yet whether they are executed after all.
struct TakenBack {
  Mark before;              ///< where the machine was
  std::uint64_t first = 0;  ///< index of their marks
  Ring<Mark> marks;
};

}  // namespace

struct Planner::Impl {
  Impl(const PlannerSettings& wanted, const Position& start)
      : settings(wanted),
        smoother(wanted.limits, wanted.tolerance_use),
        track(wanted.limits, wanted.most_taken_back > 0 ? kMostStepsBehind : 0),
        sampler(std::clamp(wanted.max_setpoint_duration, 0.0005, 0.1)),
        position(start),
        queue_end(start),
        marks(std::max<std::size_t>(wanted.most_taken_back, 1)) {
    taken_back.marks.reserve(marks.free());
  }

  /// Moves waiting curves through the smoother onto the track, as far as planning looks ahead.
  void feed_track() {
    while (track.extend() && !track.well_stocked()) {
      if (smoother.ready()) {
        append(smoother.front());
        smoother.pop();
      } else if (!waiting.empty()) {
        simplify(waiting.front());
        waiting.pop_front();
      } else {
        break;
      }
    }
    track.plan();
  }

  void simplify(const Piece& piece) {
    if (simplifier.add(piece)) return;
    if (auto line = simplifier.take()) smoother.add(*line);
    if (!simplifier.add(piece)) smoother.add(piece);
  }

  [[nodiscard]] bool full() const { return waiting.size() >= kBatch && track.sufficient(); }

  /// A supply that has ended before there is enough closes what is still open.
  void take_in(Supply supply) {
    const bool dry = supply == Supply::ended && !full();
    if (!track.sufficient()) feed_track();
    if (!dry || track.sufficient()) return;
    if (auto line = simplifier.take()) smoother.add(*line);
    smoother.finish();
    feed_track();
  }

  void append(const Piece& piece) {
    if (piece.entry != Entry::vertex) {
      track.append_span(piece);
    } else {
      track.plan();
      track.append(piece);
    }
  }

  Result<void> add(const Curve& curve, const Extents& extents, const Position& end,
                   const MoveOptions& options) {
    if (auto good = check_axes(extents, settings.limits); !good) return good;
    if (waiting.size() >= kMostWaiting) {
      return fail(
          ErrorCode::motion_queue_full,
          fmt::format("{} moves are waiting; draw setpoints before adding more.", waiting.size()));
    }
    Piece piece;
    piece.curve = curve;
    piece.end = length_of(curve);
    piece.kind = options.kind;
    piece.feed = options.kind == MoveKind::feed ? options.feed : 0.0;
    piece.follows_override = options.follows_override;
    piece.laf_angle = options.laf_angle.value_or(settings.laf_angle);
    piece.stop_at_end = options.stop_at_end;
    piece.tolerance = options.tolerance;
    piece.simplify = options.simplify;
    piece.tag = options.tag;
    waiting.reserve(waiting.size() + 1);
    waiting.push_back(std::move(piece));
    queue_end = end;
    if (!unconfirmed && waiting.size() >= kBatch) feed_track();
    return {};
  }

  /// A vanished move leaves nothing but its wish to stop.
  void add_nothing(const MoveOptions& options) {
    if (!options.stop_at_end) return;
    if (!waiting.empty()) {
      waiting.back().stop_at_end = true;
    } else if (simplifier.stop_at_end()) {
      return;
    } else if (!smoother.stop_at_end()) {
      track.stop_at_end();
    }
  }

  /// Keeps where the machine was before the setpoint that has just been drawn, and forgets what
  /// would be too much.
  void keep(const Mark& mark) {
    if (settings.most_taken_back > 0) {
      if (marks.size() == settings.most_taken_back) marks.pop_front();
      marks.push_back(mark);
      while (steps_since(marks.front()) > kMostStepsBehind) marks.pop_front();
    }
    forget_path();
  }
  [[nodiscard]] std::uint64_t steps_since(const Mark& mark) const {
    return track.place().step - mark.place.step;
  }
  /// Whether another setpoint can be drawn without one before it being forgotten for want of room.
  [[nodiscard]] bool can_keep_more() const {
    if (marks.empty()) return true;
    return marks.size() < settings.most_taken_back &&
           steps_since(marks.front()) + kMostLegs <= kMostStepsBehind;
  }
  /// Until it is known which setpoints are executed, both ways on must stay possible.
  [[nodiscard]] bool may_draw_unconfirmed() const {
    return can_keep_more() && (track.was_further() || track.sufficient());
  }
  void forget_path() {
    track.forget_before(marks.empty() ? track.place().step : marks.front().place.step);
  }
  /// Leaves the marks before index `end`.
  void cut_marks(std::uint64_t end) {
    while (marks.end() > end && !marks.empty()) marks.pop_back();
  }
  void go_back(const Mark& mark) {
    track.go_back(mark.place);
    position = mark.position;
  }
  void forget_marks() {
    marks.clear();
    unconfirmed = false;
  }

  [[nodiscard]] bool standing() const { return track.place().speed == 0.0; }

  [[nodiscard]] double time_of_waiting(const Piece& piece, double length) const {
    const Position direction = direction_bound(piece.curve);
    const double machine = largest_along(direction, settings.limits.max_velocity);
    const double speed = piece.kind == MoveKind::rapid
                             ? machine * overrides.rapid
                             : std::min(machine, piece.feed * overrides.feed_of(piece));
    return time_alone(length, speed, largest_along(direction, settings.limits.max_acceleration));
  }

  /// Along an arc the direction takes every value: |q'_i| <= 1 for the axes of its plane bounds it,
  /// and half of each limit is left to the curvature.
  [[nodiscard]] static Position direction_bound(const Curve& curve) {
    Position bound = tangent_of(curve, 0.0);
    if (is_straight(curve)) return bound;
    for (const Axis axis : kLinearAxes) {
      const bool moves = bound[axis] != 0.0 || bend_of(curve, 0.0)[axis] != 0.0;
      bound[axis] = moves ? 2.0 : 0.0;
    }
    return bound;
  }

  PlannerSettings settings;
  Simplifier simplifier;
  Smoother smoother;
  Track track;
  Sampler sampler;
  Ring<Piece> waiting;
  Overrides overrides;
  bool held = false;
  Position position;
  Position queue_end;
  Ring<Mark> marks;  // one for each setpoint that may be taken back
  TakenBack taken_back;
  bool unconfirmed = false;  // it is not known yet whether taken_back are executed
};

Planner::Planner(const PlannerSettings& settings, const Position& start)
    : impl_(std::make_unique<Impl>(settings, start)) {}
Planner::~Planner() = default;
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

Result<void> Planner::add_line(const Position& end, const MoveOptions& options) {
  if (auto good = check_end(end); !good) return good;
  if (auto good = check_options(options); !good) return good;
  const Line line(impl_->queue_end, end);
  if (line.length() < kShortest) {
    impl_->add_nothing(options);
    return {};
  }
  return impl_->add(line, extents_of_line(impl_->queue_end, end), end, options);
}

Result<void> Planner::add_arc(const ArcShape& shape, const MoveOptions& options) {
  if (auto good = check_end(shape.end); !good) return good;
  if (auto good = check_options(options); !good) return good;
  if (auto good = check_arc(shape); !good) return good;
  auto arc = make_arc(impl_->queue_end, shape);
  if (!arc) return std::unexpected(std::move(arc.error()));
  return impl_->add(*arc, extents_of_arc(*arc), shape.end, options);
}

bool Planner::full() const { return impl_->full(); }

bool Planner::idle() const {
  return impl_->waiting.empty() && impl_->simplifier.empty() && impl_->smoother.empty() &&
         impl_->track.empty();
}

std::optional<Setpoint> Planner::next(Supply supply) {
  Track& track = impl_->track;
  if (!impl_->unconfirmed) {
    impl_->take_in(supply);
  } else if (!impl_->may_draw_unconfirmed()) {
    return std::nullopt;
  }
  const Mark mark{track.place(), impl_->position};
  auto setpoint = impl_->sampler.next(track, impl_->held);
  if (!setpoint) return std::nullopt;
  impl_->position = setpoint->position;
  impl_->keep(mark);
  return setpoint;
}

std::optional<Planner::Stretch> Planner::skip(Supply supply) {
  impl_->forget_marks();
  impl_->take_in(supply);
  Track& track = impl_->track;
  if (impl_->held || track.empty()) return std::nullopt;
  const MoveTag tag = track.piece_at(track.place()).tag;
  const double duration = track.skip();
  impl_->position = track.position_at(track.place());
  impl_->forget_path();
  return duration > 0.0 ? std::optional(Stretch{duration, tag}) : std::nullopt;
}

bool Planner::keeps_setpoints() const { return impl_->settings.most_taken_back > 0; }

bool Planner::can_keep_more() const { return impl_->can_keep_more(); }

std::size_t Planner::known() const { return impl_->marks.size(); }

void Planner::forget_all_but(std::size_t count) {
  if (impl_->unconfirmed) return;
  while (impl_->marks.size() > count) impl_->marks.pop_front();
  impl_->forget_path();
}

bool Planner::take_back(std::size_t count) {
  Ring<Mark>& marks = impl_->marks;
  if (impl_->unconfirmed || count > marks.size()) return false;
  TakenBack& taken = impl_->taken_back;
  taken.before = {impl_->track.place(), impl_->position};
  taken.first = marks.end() - count;
  taken.marks.clear();
  for (std::uint64_t i = taken.first; i != marks.end(); ++i) taken.marks.push_back(marks[i]);
  impl_->unconfirmed = true;
  impl_->cut_marks(taken.first);
  if (count > 0) impl_->go_back(taken.marks.front());
  return true;
}

void Planner::confirm_take_back() { impl_->unconfirmed = false; }

void Planner::revoke_take_back() {
  if (!impl_->unconfirmed) return;
  impl_->unconfirmed = false;
  TakenBack& taken = impl_->taken_back;
  impl_->cut_marks(taken.first);
  for (std::uint64_t i = taken.marks.first(); i != taken.marks.end(); ++i)
    impl_->marks.push_back(taken.marks[i]);
  impl_->go_back(taken.before);
}

void Planner::set_overrides(double feed, double rapid) {
  // A NaN fails both comparisons of clamp and would pass: it means 0, the safe side.
  impl_->overrides = {std::isnan(feed) ? 0.0 : std::clamp(feed, 0.0, 3.0),
                      std::isnan(rapid) ? 0.0 : std::clamp(rapid, 0.0, 1.0)};
  impl_->track.set_overrides(impl_->overrides);
}

void Planner::hold() { impl_->held = true; }
void Planner::resume() { impl_->held = false; }
bool Planner::held() const { return impl_->held; }

bool Planner::clear() {
  if (!impl_->standing()) return false;
  impl_->forget_marks();
  impl_->track.clear();
  impl_->simplifier.clear();
  impl_->smoother.clear();
  impl_->waiting.clear();
  impl_->queue_end = impl_->position;
  return true;
}

const Position& Planner::queue_end() const { return impl_->queue_end; }
const Position& Planner::position() const { return impl_->position; }

double Planner::queued_time() const {
  double time = impl_->track.time_to_end();
  if (const double rest = impl_->track.unplanned_length(); rest > 0.0) {
    time += impl_->time_of_waiting(impl_->track.last_piece(), rest);
  }
  for (std::uint64_t i = impl_->waiting.first(); i != impl_->waiting.end(); ++i) {
    time += impl_->time_of_waiting(impl_->waiting[i], impl_->waiting[i].end);
  }
  return time;
}

bool Planner::set_position(const Position& position) {
  if (!idle() || !check_end(position)) return false;
  impl_->forget_marks();
  impl_->forget_path();
  impl_->position = position;
  impl_->queue_end = position;
  return true;
}

}  // namespace cnc::motion
