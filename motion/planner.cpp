#include "motion/planner.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <utility>

#include "motion/extents.h"
#include "motion/move_checks.h"
#include "motion/profile.h"
#include "motion/ring.h"
#include "motion/simplifier.h"
#include "motion/smoother.h"
#include "motion/trapezoid.h"

namespace cnc::motion {

namespace {

/// Moves that may wait behind what is planned; a caller that asks full() never has more than a
/// batch.
constexpr std::size_t kMostWaiting = 65'536;

/// So many moves go to the track at once: every time, the speed plan changes over a whole braking
/// distance before its end.
constexpr std::size_t kBatch = 64;

/// With limits of jerk a corner of an exact path can only be passed on a curve without leaps of
/// curvature; that may leave the program by so much, mm.
constexpr double kExactPath = 1e-3;

/// So much is drawn in any case while it is not known whether setpoints count that were taken back,
/// s: what the controller still has, with the answer on its way, must not end in motion.
constexpr double kBridge = 0.1;

/// Where the machine was before a setpoint was drawn.
struct Mark {
  ProfilePlace place;
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
  Impl(const PlannerSettings& wanted, const Position& start, std::unique_ptr<Profile> driven)
      : settings(wanted),
        smoother(wanted.limits, wanted.tolerance_use,
                 wanted.limits.limit_jerk() ? kExactPath : 0.0),
        profile(std::move(driven)),
        position(start),
        queue_end(start),
        marks(std::max<std::size_t>(wanted.most_taken_back, 1)) {
    taken_back.marks.reserve(marks.free());
  }

  /// Moves waiting curves through the smoother to the profile, as far as planning looks ahead.
  /// Whether there were any.
  bool feed_profile() {
    bool appended = false;
    while (profile->extend() && !profile->well_stocked()) {
      if (smoother.ready()) {
        profile->append(smoother.front());
        smoother.pop();
        appended = true;
      } else if (!waiting.empty()) {
        simplify(waiting.front());
        waiting.pop_front();
      } else {
        break;
      }
    }
    profile->plan();
    return appended;
  }

  void simplify(const Piece& piece) {
    if (simplifier.add(piece)) return;
    if (auto line = simplifier.take()) smoother.add(*line);
    if (!simplifier.add(piece)) smoother.add(piece);
  }

  [[nodiscard]] bool full() const { return waiting.size() >= kBatch && profile->sufficient(); }

  /// A supply that has ended before there is enough closes what is still open.
  bool take_in(Supply supply) {
    const bool dry = supply == Supply::ended && !full();
    bool appended = !profile->sufficient() && feed_profile();
    if (!dry || profile->sufficient()) return appended;
    if (auto line = simplifier.take()) smoother.add(*line);
    smoother.finish();
    return feed_profile() || appended;
  }

  /// Plans as far as what is known allows, so that the plan does not depend on how it is sampled.
  void prepare(Supply supply, bool to_be_held) {
    do {
      profile->prepare(to_be_held);
    } while (!profile->sufficient() && take_in(supply));
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
    const bool is_feed = options.kind == MoveKind::feed;
    piece.kind = options.kind;
    piece.feed = is_feed ? options.feed : 0.0;
    piece.override = is_feed ? options.override : Override::rapid;
    piece.laf_angle = options.laf_angle.value_or(settings.laf_angle);
    piece.stop_at_end = options.stop_at_end;
    piece.tolerance = is_feed ? options.tolerance : 0.0;  // rapids reach their ends
    piece.simplify = options.simplify;
    piece.tag = options.tag;
    waiting.reserve(waiting.size() + 1);
    waiting.push_back(std::move(piece));
    queue_end = end;
    if (!unconfirmed && waiting.size() >= kBatch) (void)feed_profile();
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
      profile->stop_at_end();
    }
  }

  /// Keeps where the machine was before the setpoint that has just been drawn, and forgets what
  /// would be too much.
  void keep(const Mark& mark) {
    if (settings.most_taken_back > 0) {
      if (marks.size() == settings.most_taken_back) marks.pop_front();
      marks.push_back(mark);
      while (profile->keeps_too_much(marks.front().place)) marks.pop_front();
    }
    forget_path();
  }
  /// Whether another setpoint can be drawn without one before it being forgotten for want of room.
  [[nodiscard]] bool can_keep_more() const {
    if (marks.empty()) return true;
    return marks.size() < settings.most_taken_back && profile->can_keep_more(marks.front().place);
  }
  /// Until it is known which setpoints are executed, both ways on must stay possible. What is known
  /// of the path suffices for a hold; for anything else the plan slows down towards its end, which
  /// is far away.
  [[nodiscard]] bool may_draw_unconfirmed() const {
    return can_keep_more() && (held || profile->can_go_on_alone() || drawn_unconfirmed < kBridge);
  }
  void forget_path() {
    // Those that were taken back may count again.
    const bool may_return = unconfirmed && !taken_back.marks.empty();
    const Mark* oldest = !marks.empty() ? &marks.front() : nullptr;
    if (may_return && (oldest == nullptr || marks.first() >= taken_back.first)) {
      oldest = &taken_back.marks.front();
    }
    profile->forget_before(oldest != nullptr ? oldest->place : profile->place());
  }
  /// Leaves the marks before index `end`.
  void cut_marks(std::uint64_t end) {
    while (marks.end() > end && !marks.empty()) marks.pop_back();
  }
  void go_back(const Mark& mark) {
    profile->go_back(mark.place);
    position = mark.position;
  }
  void forget_marks() {
    marks.clear();
    unconfirmed = false;
  }

  PlannerSettings settings;
  Simplifier simplifier;
  Smoother smoother;
  std::unique_ptr<Profile> profile;
  Ring<Piece> waiting;
  Overrides overrides;
  bool held = false;
  Position position;
  Position queue_end;
  Ring<Mark> marks;  // one for each setpoint that may be taken back
  TakenBack taken_back;
  bool unconfirmed = false;        // it is not known yet whether taken_back are executed
  double drawn_unconfirmed = 0.0;  // s, since then
};

Planner::Planner(const PlannerSettings& settings, const Position& start)
    : Planner(settings, start, make_profile(settings)) {}
Planner::Planner(const PlannerSettings& settings, const Position& start,
                 std::unique_ptr<Profile> profile)
    : impl_(std::make_unique<Impl>(settings, start, std::move(profile))) {}
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
         impl_->profile->empty();
}

std::optional<Setpoint> Planner::next(Supply supply) {
  Profile& profile = *impl_->profile;
  if (!impl_->unconfirmed) {
    (void)impl_->take_in(supply);
    impl_->prepare(supply, impl_->held);
  } else if (impl_->may_draw_unconfirmed()) {
    profile.prepare(impl_->held);
  } else {
    return std::nullopt;
  }
  const Mark mark{profile.place(), impl_->position};
  auto setpoint = profile.next(impl_->held);
  if (!setpoint) return std::nullopt;
  impl_->position = setpoint->position;
  impl_->drawn_unconfirmed += setpoint->duration;
  impl_->keep(mark);
  return setpoint;
}

std::optional<Stretch> Planner::skip(Supply supply) {
  impl_->forget_marks();
  (void)impl_->take_in(supply);
  Profile& profile = *impl_->profile;
  if (impl_->held || profile.empty()) return std::nullopt;
  impl_->prepare(supply, false);
  const auto stretch = profile.skip();
  impl_->position = profile.position();
  impl_->forget_path();
  return stretch;
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
  Profile& profile = *impl_->profile;
  TakenBack& taken = impl_->taken_back;
  taken.before = {profile.place(), impl_->position};
  taken.first = marks.end() - count;
  taken.marks.clear();
  for (std::uint64_t i = taken.first; i != marks.end(); ++i) taken.marks.push_back(marks[i]);
  impl_->unconfirmed = true;
  impl_->drawn_unconfirmed = 0.0;
  impl_->cut_marks(taken.first);
  profile.save();
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
  impl_->profile->revert(taken.before.place);
  impl_->position = taken.before.position;
}

void Planner::set_overrides(double feed, double rapid, double speed) {
  // A NaN fails both comparisons of clamp and would pass: it means 0, the safe side.
  const auto within = [](double factor, double most) {
    return std::isnan(factor) ? 0.0 : std::clamp(factor, 0.0, most);
  };
  impl_->overrides = {within(feed, 3.0), within(rapid, 1.0), within(speed, 3.0)};
  impl_->profile->set_overrides(impl_->overrides);
}

bool Planner::barred() const {
  const auto& [feed, rapid, speed] = impl_->overrides;
  return std::min({feed, rapid, speed}) <= 0.0;
}

void Planner::hold() { impl_->held = true; }
void Planner::resume() { impl_->held = false; }
bool Planner::held() const { return impl_->held; }

bool Planner::clear() {
  if (!impl_->profile->standing()) return false;
  impl_->forget_marks();
  impl_->profile->clear();
  impl_->simplifier.clear();
  impl_->smoother.clear();
  impl_->waiting.clear();
  impl_->queue_end = impl_->position;
  return true;
}

const Position& Planner::queue_end() const { return impl_->queue_end; }
const Position& Planner::position() const { return impl_->position; }

double Planner::queued_time() const {
  double time = impl_->profile->time_to_end();
  for (std::uint64_t i = impl_->waiting.first(); i != impl_->waiting.end(); ++i) {
    const Piece& piece = impl_->waiting[i];
    time += time_alone(piece, piece.end, impl_->settings.limits, impl_->overrides);
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
