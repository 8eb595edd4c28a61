#include "motion/jerk_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cnc::motion {

namespace {

using Phase = MotionPlace::Phase;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Plans again when so much path is new, as a part of what it would change; while the motion is not
/// so many times as far before that, and this long, s.
constexpr double kNewPart = 0.5;
constexpr double kEnoughAhead = 1.5;
constexpr double kTimeAhead = 0.1;
/// And wants so much that is new.
constexpr double kStock = 1.0;

/// Room that new path needs at least.
constexpr std::size_t kFewCells = 16;

constexpr double kNothingLeft = 1e-9;

/// Times that differ by less are the same, s.
constexpr double kInstant = 1e-12;

constexpr double kLeastFactor = 1e-3;
constexpr double kMostFactor = 10.0;

}  // namespace

struct JerkPlan::Saved {
  Ring<PlannedCell> cells;
  Ring<Run> runs;
  CellCutter::State cutter;
  std::uint64_t window_begin;
  EndOfCells window_end;
  double most_start_x;
  MotionPlace place;
  double look_ahead;
  Overrides overrides;
  bool held;
  bool changed;
};

JerkPlan::JerkPlan(const JerkLimits& limits, std::size_t ahead, std::size_t behind)
    : most_ahead_(ahead),
      cutter_(limits, ahead + behind),
      window_(ahead + behind),
      trial_(ahead / 2),
      runs_(ahead / 4) {
  runs_.push_back({});
}
JerkPlan::~JerkPlan() = default;
JerkPlan::JerkPlan(JerkPlan&&) noexcept = default;
JerkPlan& JerkPlan::operator=(JerkPlan&&) noexcept = default;

void JerkPlan::save() {
  if (!saved_) saved_ = std::make_unique<Saved>();
  saved_->cells.copy(window_.cells);
  saved_->runs.copy(runs_);
  saved_->cutter = cutter_.state();
  saved_->window_begin = window_.begin_cell;
  saved_->window_end = window_.end;
  saved_->most_start_x = window_.most_start_x;
  saved_->place = place_;
  saved_->look_ahead = look_ahead_;
  saved_->overrides = overrides_;
  saved_->held = held_;
  saved_->changed = changed_;
}

void JerkPlan::restore() {
  window_.cells.copy(saved_->cells);
  runs_.copy(saved_->runs);
  cutter_.set_state(saved_->cutter);
  window_.begin_cell = saved_->window_begin;
  window_.end = saved_->window_end;
  window_.most_start_x = saved_->most_start_x;
  place_ = saved_->place;
  look_ahead_ = saved_->look_ahead;
  changed_ = saved_->changed || saved_->held != held_ || saved_->overrides != overrides_;
  retry_at_cell_ = 0;
}

// --- Path ----------------------------------------------------------------------------------------

bool JerkPlan::path_left() const {
  if (!standing() || !in_last_run()) return cutter_.path_left();
  const PathPlace at = cutter_.behind(run().end, 0.0);
  return at.interval < intervals().end() &&
         at.start < intervals()[at.interval].length - kNothingLeft;
}

/// Up to the end of the last run; the machine is in it.
double JerkPlan::known_ahead() const {
  double ahead = cutter_.left();
  if (standing() || window_.cells.end() == run().begin) return ahead;
  const PlannedCell& last = window_.cells.back();
  ahead += last.distance + last.cell.length;
  if (place_.phase == Phase::driving) ahead -= window_.cells[place_.cell].distance;
  return ahead;
}

/// Of the path that this place is on; those before it are driven.
std::uint64_t JerkPlan::first_interval_of(const MotionPlace& place) const {
  const Run& run = run_of(place);
  switch (place.phase) {
    case Phase::starting:
      return run.from.interval;
    case Phase::driving:
      return window_.cells[place.cell].cell.interval;
    case Phase::stopping:
      return run.stop.place.interval;
    case Phase::standing:
      break;
  }
  return run.end.interval;
}

std::size_t JerkPlan::free_cells() const {
  const std::uint64_t end = window_.cells.end();
  const std::uint64_t ahead = end - std::min(place_.cell, end);
  const std::size_t room = ahead < most_ahead_ ? most_ahead_ - ahead : 0;
  return std::min(room, window_.cells.free());
}

bool JerkPlan::takes_intervals() const {
  return cutter_.has_room() && intervals().end() - first_interval_of(place_) < most_ahead_;
}

bool JerkPlan::has_room() const { return takes_intervals() && free_cells() > kFewCells; }

bool JerkPlan::wants_path() const {
  return in_last_run() && !cutter_.end_is_known() && has_room() &&
         cutter_.left() <= kStock * look_ahead_;
}

/// For the next plan, or for one that may be wanted at any instant.
bool JerkPlan::lacks_path() const {
  return in_last_run() && !cutter_.end_is_known() && has_room() &&
         (cutter_.left() <= kNewPart * look_ahead_ || !knows_enough());
}

void JerkPlan::append(const PathInterval& interval) {
  if (!cutter_.end_is_known()) look_at(interval);
  cutter_.append(interval);
}

void JerkPlan::look_at(const PathInterval& interval) {
  look_ahead_ = std::max(look_ahead_, cutter_.stopping_distance(interval));
}

bool JerkPlan::knows_enough() const {
  return !in_last_run() || cutter_.end_is_known() || known_ahead() >= look_ahead_;
}

void JerkPlan::clear() {
  cutter_.clear();
  window_.cells.clear();
  runs_.clear();
  Run none;
  none.begin = none.stop.cell = window_.cells.end();
  none.end = cutter_.place();
  runs_.push_back(none);
  place_ = {runs_.first(), Phase::standing, window_.cells.end(), 0.0};
  look_ahead_ = 0.0;
  retry_at_cell_ = 0;
}

/// The next run begins where the last one ended.
void JerkPlan::begin_at_standstill() {
  cutter_.go_to(run().end, 0.0);
  look_ahead_ = 0.0;
  double seen = 0.0;
  for (std::uint64_t i = cutter_.place().interval; i != intervals().end() && seen < cutter_.left();
       ++i) {
    look_at(intervals()[i]);
    seen += intervals()[i].length;
  }
}

bool JerkPlan::due() const {
  if (place_.phase == Phase::stopping) return false;
  if (standing()) return !held_ && runs_.free() > 0 && (!in_last_run() || path_left());
  if (place_.cell < retry_at_cell_) return false;
  if (changed_ || held_ || !in_last_run()) return changed_;
  if (free_cells() == 0) return false;
  const double shaped_from = distance_of(std::max(run().shaped_from, place_.cell));
  const double shaped = distance_of(run().stop.cell) - shaped_from;
  const double margin = kTimeAhead * std::sqrt(window_.cells[place_.cell].x_in_force);
  const double ahead = shaped_from - distance_of(place_.cell);
  if (ahead > kEnoughAhead * shaped + margin) return false;
  const double enough =
      cutter_.end_is_known() ? run().stop.length : kNewPart * std::min(shaped, look_ahead_);
  return (cutter_.left() > enough || !takes_intervals()) && cutter_.next_length() > 0.0;
}

/// Of a cell's begin along the run; also of the place behind the last one.
double JerkPlan::distance_of(std::uint64_t index) const {
  if (index < window_.cells.end()) return window_.cells[index].distance;
  const PlannedCell& last = window_.cells.back();
  return last.distance + last.cell.length;
}

void JerkPlan::set_overrides(const Overrides& factors) {
  const Overrides wanted{std::clamp(factors.feed, kLeastFactor, kMostFactor),
                         std::clamp(factors.rapid, kLeastFactor, kMostFactor),
                         std::clamp(factors.speed, kLeastFactor, kMostFactor)};
  if (wanted == overrides_) return;
  overrides_ = wanted;
  changed_ = true;
}

void JerkPlan::hold() {
  held_ = true;
  changed_ = true;
}

void JerkPlan::resume() {
  held_ = false;
  changed_ = true;
}

// --- Motion --------------------------------------------------------------------------------------

CellX JerkPlan::x_in_force(std::uint64_t index, const Run& run) const {
  const auto& cells = window_.cells;
  const double own = cells[index].x_in_force;
  const Knot& begin = cells[index].knot;
  const bool is_last = index + 1 == run.stop.cell;
  const Knot& end = is_last ? run.stop.end.knot : cells[index + 1].knot;
  const double before = begin.before == 0.0 ? 0.0 : begin.before * cells[index - 1].x_in_force;
  const double behind = is_last ? 0.0 : end.behind * cells[index + 1].x_in_force;
  return {before + begin.behind * own + begin.given, own, end.before * own + behind + end.given};
}

CellMotion JerkPlan::motion_of(std::uint64_t index, const Run& run) const {
  const CellX x = x_in_force(index, run);
  const double h = window_.cells[index].cell.length;
  return {std::sqrt(x[0]), (x[1] - x[0]) / h, ((x[2] - x[1]) - (x[1] - x[0])) / (h * h)};
}

double JerkPlan::duration_of(std::uint64_t index, const Run& run) const {
  const double end = std::sqrt(x_in_force(index, run)[2]);
  return motion_of(index, run).time_to(window_.cells[index].cell.length, end);
}

PathMotion JerkPlan::motion_at(const MotionPlace& place) const {
  const Run& run = run_of(place);
  switch (place.phase) {
    case Phase::starting: {
      const MotionState state = run.start().after_start(place.time);
      return {cutter_.behind(run.from, state.s), state.v, state.w, state.dw};
    }
    case Phase::driving: {
      const MotionState state = motion_of(place.cell, run).after(place.time);
      const SpeedCell& cell = window_.cells[place.cell].cell;
      return {{cell.interval, cell.start + std::clamp(state.s, 0.0, cell.length)},
              state.v,
              state.w,
              state.dw};
    }
    case Phase::stopping: {
      const MotionState state = run.halt().after_stop_began(place.time);
      return {cutter_.behind(run.stop.place, state.s), state.v, state.w, state.dw};
    }
    case Phase::standing:
      break;
  }
  return {run.end, 0.0, 0.0, kInfinity};
}

double JerkPlan::time_in_cell(const MotionPlace& place) const {
  const Run& run = run_of(place);
  switch (place.phase) {
    case Phase::starting:
      return run.start().duration() - place.time;
    case Phase::driving:
      return duration_of(place.cell, run) - place.time;
    case Phase::stopping:
      return run.halt().duration() - place.time;
    case Phase::standing:
      break;
  }
  return 0.0;
}

MotionPlace JerkPlan::behind_cell(const MotionPlace& place) const {
  const Run& run = run_of(place);
  MotionPlace next{place.run, place.phase, place.cell, 0.0};
  switch (place.phase) {
    case Phase::starting:
      next.phase = Phase::driving;
      break;
    case Phase::driving:
      if (++next.cell == run.stop.cell) next.phase = Phase::stopping;
      break;
    case Phase::stopping:
      next.phase = Phase::standing;
      break;
    case Phase::standing:
      break;
  }
  return next;
}

MotionPlace JerkPlan::after(MotionPlace place, double time) const {
  while (place.phase != Phase::standing) {
    const double rest = time_in_cell(place);
    if (time < rest - kInstant) {
      place.time += std::max(0.0, time);
      return place;
    }
    time -= rest;
    place = behind_cell(place);
  }
  return place;
}

void JerkPlan::advance_to(const MotionPlace& place) {
  const bool arrives = !standing() && place.phase == Phase::standing;
  place_ = place;
  if (arrives && in_last_run()) begin_at_standstill();
}

void JerkPlan::go_back(const MotionPlace& place) {
  place_ = place;
  retry_at_cell_ = 0;
  if (!standing() && in_last_run()) drop_cells_behind_stop();
}

void JerkPlan::forget_before(const MotionPlace& place) {
  const std::uint64_t interval = first_interval_of(place);
  const std::uint64_t oldest = std::min(place.cell, window_.cells.end());
  if (window_.cells.first() < oldest) drop_behind(oldest - window_.cells.first());
  cutter_.forget_before(interval);
  while (runs_.first() < place.run) runs_.pop_front();
}

/// What follows goes on from what was planned.
void JerkPlan::drop_behind(std::uint64_t count) {
  auto& cells = window_.cells;
  for (; count > 0; --count) {
    const std::uint64_t first = cells.first();
    if (first + 1 < cells.end() && cells[first + 1].knot.before != 0.0) {
      Knot& knot = cells[first + 1].knot;
      const double x = knot.before * cells[first].x_in_force +
                       knot.behind * cells[first + 1].x_in_force + knot.given;
      knot = {0.0, 0.0, x};
    }
    cells.pop_front();
  }
  if (window_.begin_cell < cells.first()) {
    window_.begin_cell = cells.first();
    window_.most_start_x = kInfinity;
  }
}

double JerkPlan::time_to_stop() const {
  double time = 0.0;
  for (MotionPlace place = place_; place.phase != Phase::standing; place = behind_cell(place)) {
    time += time_in_cell(place);
  }
  return time;
}

}  // namespace cnc::motion
