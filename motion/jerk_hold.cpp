// How a JerkPlan stops early, and how it changes at once.
#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/jerk_plan.h"

namespace cnc::motion {

namespace {

using Phase = MotionPlace::Phase;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distances that are tried for a hold: from the one that a straight line needs, each so many times
/// the one before; and rounds for each.
constexpr int kTrials = 16;
constexpr double kNextTrial = 1.15;
/// And so much more, mm, or the way in so many seconds.
constexpr double kMoreWay = 0.02;
constexpr double kMoreTime = 0.005;
constexpr int kFewRounds = 12;
constexpr int kMostRounds = 22;

/// Where the rounds begin: braking at so many times the moderate acceleration.
constexpr double kFirm = 1.8;
constexpr double kGuessedStandstill = 0.3;
constexpr double kGuessedSpeed = 0.9;

/// The rest of a cell is split off if it is at least this part of it, and this long in seconds.
constexpr double kPartWorthSplitting = 0.1;
constexpr double kTimeWorthSplitting = 0.002;

}  // namespace

/// Lets a change act from the present place on, not from the end of the present cell: that becomes
/// two, of which the first is behind the motion.
void JerkPlan::split_present_cell() {
  auto& cells = window_.cells;
  if (place_.phase != Phase::driving || place_.time == 0.0 || cells.free() == 0) return;
  const std::uint64_t index = place_.cell;
  const CellX x = x_in_force(index, run());
  const SpeedCell whole = cells[index].cell;
  const MotionState now = motion_of(index, run()).after(place_.time);
  const double rest = whole.length - now.s;
  if (rest < kPartWorthSplitting * whole.length || time_in_cell() < kTimeWorthSplitting) return;

  cells.push_back(cells.back());
  for (std::uint64_t i = cells.end() - 2; i > index; --i) cells[i + 1] = cells[i];
  PlannedCell& driven = cells[index];
  PlannedCell& ahead = cells[index + 1];
  ahead = driven;
  driven.cell = cutter_.cell_at({whole.interval, whole.start}, now.s);
  driven.x_in_force = x[0] + now.s * (x[1] - x[0]) / whole.length;
  ahead.cell = cutter_.cell_at({whole.interval, whole.start + now.s}, rest);
  ahead.x_in_force = now.v * now.v + rest * now.w;
  ahead.distance += now.s;
  ahead.knot = knot_between(now.s, rest);
  if (index == run().begin) {
    driven.knot.behind = part_beside_standstill(now.s, run().start_length);
  } else if (driven.knot.before != 0.0) {
    driven.knot = knot_between(cells[index - 1].cell.length, now.s);
  }
  Stop& stop = run().stop;
  if (++stop.cell == index + 2) {
    stop.end.knot.before = part_beside_standstill(rest, stop.length);
  } else {
    cells[index + 2].knot = knot_between(rest, cells[index + 2].cell.length);
  }
  window_.end = stop.end;
  if (run().shaped_from > index) ++run().shaped_from;
  place_ = {place_.run, Phase::driving, index + 1, 0.0};
}

/// A hold is a plan to a stop early on the path: the shortest of a few distances for which there is
/// one. It leaves no time to go on as before, so that braking begins at once.
bool JerkPlan::plan_hold() {
  if (standing()) return true;
  const auto first = first_free();
  if (!first) return true;  // it stops within the next cell as it is
  const PlannedCell& fixed = window_.cells[*first - 1];
  const PathPlace begin =
      cutter_.behind({fixed.cell.interval, fixed.cell.start}, fixed.cell.length);
  const double until_stop = distance_to_stop(*first);
  double distance = shortest_braking(*first);
  for (int i = 0; i < kTrials && distance < until_stop; ++i, distance *= kNextTrial) {
    cutter_.go_to(begin, fixed.cell.length);
    cutter_.end_after(distance);
    if (!try_to_stop(*first)) continue;
    take_over_trial(*first);
    return true;
  }
  drop_cells_behind_stop();
  return distance >= until_stop;
}

double JerkPlan::distance_to_stop(std::uint64_t first) const {
  double distance = run().stop.length;
  for (std::uint64_t i = first; i < run().stop.cell; ++i) distance += window_.cells[i].cell.length;
  return distance;
}

/// About what a straight line would take from the begin of cell `first`, where acceleration may
/// have to be undone before braking builds up.
double JerkPlan::shortest_braking(std::uint64_t first) const {
  const SpeedCell& cell = window_.cells[first - 1].cell;
  const CellX x = x_in_force(first - 1, run());
  const double v = std::sqrt(x[2]);
  const double w = std::max(0.0, (x[2] - x[1]) / cell.length);
  const double j = cell.reach.j_first;
  const double a = std::min(cell.reach.a_first, std::sqrt(v * j));
  return v * v / (2.0 * a) + v * (0.5 * a + w) / j + std::min(kMoreWay, kMoreTime * v);
}

/// A window of its own: the fixed cell before `first`, new cells up to the end of the cutter's
/// path, and a guess. False when there is no room.
bool JerkPlan::make_trial(std::uint64_t first) {
  auto& cells = trial_.cells;
  cells.clear();
  trial_.begin_cell = cells.first();
  PlannedCell fixed = window_.cells[first - 1];
  const bool is_run_begin = first - 1 == run().begin && place_.phase == Phase::starting;
  if (!is_run_begin) fixed.knot = {0.0, 0.0, x_in_force(first - 1, run())[0]};
  fixed.x = fixed.x_in_force;
  fixed.feed_is_kept = false;
  cells.push_back(fixed);
  const std::uint64_t room = window_.cells.free() + (window_.cells.end() - first);
  while (const auto cell = cutter_.next()) {
    if (cells.free() == 0 || cells.size() > room) return false;
    PlannedCell planned = planned_behind(cells.back(), *cell);
    planned.wanted_x = fixed.x;
    planned.feed_is_kept = false;
    cells.push_back(planned);
  }
  if (cells.size() < 2) return false;
  trial_.most_start_x = kInfinity;
  trial_.end = stop_behind(trial_).end;
  guess_braking();
  trial_.reset_weights(cells.first() + 1);
  return true;
}

void JerkPlan::guess_braking() {
  auto& cells = trial_.cells;
  const double most = cells.front().x;
  double x = kGuessedStandstill * trial_.end.most_x;
  double before = 0.0;
  for (std::uint64_t i = cells.end(); i-- > cells.first() + 1;) {
    const SpeedCell& cell = cells[i].cell;
    const double way = 0.5 * (before + cell.length);
    before = cell.length;
    x = std::min(
        {x + 2.0 * way * kFirm * cell.reach.moderate_w(x), most, kGuessedSpeed * cell.machine_x});
    cells[i].x = x;
  }
}

bool JerkPlan::try_to_stop(std::uint64_t first) {
  if (!make_trial(first)) return false;
  const std::uint64_t free = trial_.cells.first() + 1;
  for (int i = 1; i <= kMostRounds; ++i, ++rounds_) {
    const bool more = trial_.improve(free);
    if (more && i < kFewRounds) continue;
    if (trial_.usage(free) <= kUsageOfPlan) return true;
    trial_.defend_harder(free);
  }
  return false;
}

void JerkPlan::take_over_trial(std::uint64_t first) {
  auto& cells = window_.cells;
  while (cells.end() > first) cells.pop_back();
  for (std::uint64_t i = trial_.cells.first() + 1; i != trial_.cells.end(); ++i) {
    cells.push_back(trial_.cells[i]);
    cells.back().x_in_force = cells.back().x;
  }
  end_run_at(stop_behind(window_));
}

}  // namespace cnc::motion
