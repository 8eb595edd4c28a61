#include "motion/jerk_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cnc::motion {

namespace {

using Phase = MotionPlace::Phase;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Plans again when this part of the look-ahead is new.
constexpr double kNewPart = 0.5;
constexpr double kEnoughAhead = 2.5;

}  // namespace

JerkPlan::JerkPlan(const JerkLimits& limits, std::size_t max_cells, std::size_t max_intervals)
    : cutter_(limits, max_intervals), window_(max_cells), trial_(max_cells / 4) {}

// --- Path ----------------------------------------------------------------------------------------

double JerkPlan::known_ahead() const {
  double ahead = cutter_.left();
  if (standing() || window_.cells.empty()) return ahead;
  const PlannedCell& last = window_.cells.back();
  ahead += last.distance + last.cell.length;
  if (place_.phase == Phase::driving) ahead -= window_.cells[place_.cell].distance;
  return ahead;
}

bool JerkPlan::wants_path() const {
  const bool room = cutter_.intervals.free() > 0 && window_.cells.free() > 16;
  return room && known_ahead() <= kEnoughAhead * look_ahead_;
}

void JerkPlan::append(const PathInterval& interval) {
  cutter_.append(interval);
  const Stopping stopping = cutter_.stopping_on(interval);
  look_ahead_ = std::max(look_ahead_, stopping.distance);
  stopping_time_ = std::max(stopping_time_, stopping.time);
}

void JerkPlan::close() { cutter_.close(); }

bool JerkPlan::due() const {
  if (place_.phase == Phase::stopping) return false;
  if (standing()) return !held_ && cutter_.path_left();
  if (changed_ || held_) return changed_;
  const double planned = known_ahead() - cutter_.left();
  if (window_.cells.free() == 0 || planned > kEnoughAhead * look_ahead_) return false;
  const double enough = cutter_.closed() ? stop_.length : kNewPart * look_ahead_;
  return cutter_.left() > enough && cutter_.next_length() > 0.0;
}

void JerkPlan::set_override(double factor) {
  override_ = std::clamp(factor, 1e-3, 10.0);
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

CellX JerkPlan::x_in_force(std::uint64_t index) const {
  const auto& cells = window_.cells;
  const double own = cells[index].x_in_force;
  const Knot& begin = cells[index].knot;
  const bool is_last = index + 1 == stop_.cell;
  const Knot& end = is_last ? stop_.end.knot : cells[index + 1].knot;
  const double before = begin.before == 0.0 ? 0.0 : begin.before * cells[index - 1].x_in_force;
  const double behind = is_last ? 0.0 : end.behind * cells[index + 1].x_in_force;
  return {before + begin.behind * own + begin.given, own, end.before * own + behind + end.given};
}

CellMotion JerkPlan::motion_of(std::uint64_t index) const {
  const CellX x = x_in_force(index);
  const double h = window_.cells[index].cell.length;
  return {std::sqrt(x[0]), (x[1] - x[0]) / h, ((x[2] - x[1]) - (x[1] - x[0])) / (h * h)};
}

double JerkPlan::duration_of(std::uint64_t index) const {
  const double end = std::sqrt(x_in_force(index)[2]);
  return motion_of(index).time_to(window_.cells[index].cell.length, end);
}

StandstillMotion JerkPlan::start_motion() const {
  return {start_length_, std::sqrt(x_in_force(run_begin_)[0])};
}

StandstillMotion JerkPlan::stop_motion() const {
  return {stop_.length, std::sqrt(x_in_force(stop_.cell - 1)[2])};
}

PathMotion JerkPlan::motion() const {
  switch (place_.phase) {
    case Phase::standing:
      return {standstill_, 0.0, 0.0, kInfinity};
    case Phase::starting: {
      const MotionState state = start_motion().after_start(place_.time);
      return {cutter_.behind(standstill_, state.s), state.v, state.w, state.dw};
    }
    case Phase::driving: {
      const MotionState state = motion_of(place_.cell).after(place_.time);
      const SpeedCell& cell = window_.cells[place_.cell].cell;
      return {{cell.interval, cell.start + std::clamp(state.s, 0.0, cell.length)},
              state.v,
              state.w,
              state.dw};
    }
    case Phase::stopping: {
      const MotionState state = stop_motion().after_stop_began(place_.time);
      return {cutter_.behind(stop_.place, state.s), state.v, state.w, state.dw};
    }
  }
  return {};
}

double JerkPlan::time_in_cell() const {
  switch (place_.phase) {
    case Phase::standing:
      return 0.0;
    case Phase::starting:
      return start_motion().duration() - place_.time;
    case Phase::driving:
      return duration_of(place_.cell) - place_.time;
    case Phase::stopping:
      return stop_motion().duration() - place_.time;
  }
  return 0.0;
}

void JerkPlan::enter_next_phase() {
  place_.time = 0.0;
  switch (place_.phase) {
    case Phase::standing:
      return;
    case Phase::starting:
      place_ = {Phase::driving, run_begin_, 0.0};
      return;
    case Phase::driving:
      if (++place_.cell == stop_.cell) place_.phase = Phase::stopping;
      return;
    case Phase::stopping:
      place_.phase = Phase::standing;
      standstill_ = cutter_.behind(stop_.place, stop_.length);
      cutter_.go_to(standstill_, 0.0);
      window_.cells.clear();
      return;
  }
}

void JerkPlan::advance(double time) {
  while (!standing()) {
    const double rest = time_in_cell();
    if (time < rest) {
      place_.time += time;
      return;
    }
    time -= std::max(0.0, rest);
    enter_next_phase();
  }
}

void JerkPlan::forget_before(const MotionPlace& place) {
  if (place.phase == Phase::driving) {
    while (window_.cells.first() < place.cell) drop_behind(1);
  }
  const std::uint64_t oldest = standing() ? standstill_.interval : motion().place.interval;
  while (!cutter_.intervals.empty() && cutter_.intervals.first() < oldest) {
    cutter_.intervals.pop_front();
  }
}

void JerkPlan::drop_behind(std::uint64_t count) {
  for (; count > 0; --count) {
    const std::uint64_t next = window_.cells.first() + 1;
    if (next < window_.cells.end()) {
      const double x = x_in_force(next - 1)[2];
      window_.cells[next].knot = {0.0, 0.0, x};
    }
    window_.cells.pop_front();
  }
  window_.most_start_x = kInfinity;
}

double JerkPlan::time_to_stop() const {
  if (standing()) return 0.0;
  double time = time_in_cell();
  if (place_.phase == Phase::stopping) return time;
  const std::uint64_t next = place_.phase == Phase::driving ? place_.cell + 1 : run_begin_;
  for (std::uint64_t i = next; i != stop_.cell; ++i) time += duration_of(i);
  return time + stop_motion().duration();
}

}  // namespace cnc::motion
