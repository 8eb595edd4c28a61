// How a JerkPlan stops early, and how it changes at once.
#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/jerk_plan.h"

namespace cnc::motion {

namespace {

using Phase = MotionPlace::Phase;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What is tried for a hold, from the distance that a straight line needs. How far a trial that
/// misses is above the limits tells how much longer the next one should be: 1 + kLongerByUsage
/// times that, at most kMostLonger.
constexpr int kTrials = 16;
constexpr double kFarAbove = 0.1;
constexpr double kLongerByUsage = 0.8;
constexpr double kMostLonger = 2.0;
constexpr double kLonger = 1.15;
/// One that is nearly within them, but for these first cells, begins to brake behind the one that
/// is worst: there the plan in force is about the only one that there is, whatever comes behind.
constexpr std::uint64_t kFirstCells = 8;
constexpr double kLittleLonger = 1.07;
/// And so much more, mm, or the way in so many seconds.
constexpr double kMoreWay = 0.02;
constexpr double kMoreTime = 0.005;

/// Rounds for each: as many as bring it nearer to the limits, by so much of what is missing.
constexpr int kFewRounds = 12;
constexpr int kMostRounds = 30;
constexpr double kNearer = 0.97;

/// Where the rounds begin: as the plan in force, and braking at so many times the moderate
/// acceleration.
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

/// A hold is a plan to a stop early on the path: the first for which there is a plan, of trials
/// that each learn from the last. It leaves no time to go on as before, so that braking begins at
/// once.
bool JerkPlan::plan_hold() {
  if (standing()) return true;
  const auto free = first_free();
  if (!free) return true;  // it stops within the next cell as it is
  std::uint64_t first = *free;
  double longer = 1.0;
  for (int i = 0; i < kTrials; ++i) {
    const double distance = longer * shortest_braking(first);
    if (first >= run().stop.cell || distance >= distance_to_stop(first)) {
      drop_cells_behind_stop();
      return true;
    }
    const Usage usage = try_to_stop(first, distance);
    if (usage.part <= kUsageOfPlan) {
      take_over_trial(first);
      return true;
    }
    const double above = usage.part - 1.0;
    if (above > kFarAbove) {
      longer *= std::min(kMostLonger, 1.0 + kLongerByUsage * above);
    } else if (const std::uint64_t ahead = usage.cell - trial_.cells.first(); ahead < kFirstCells) {
      first += ahead + 1;
      longer *= kLittleLonger;
    } else {
      longer *= kLonger;
    }
  }
  drop_cells_behind_stop();
  return false;
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

/// A window of its own: the fixed cell before `first`, new cells up to a stop after `distance`, and
/// a guess. False when there is no room.
bool JerkPlan::make_trial(std::uint64_t first, double distance) {
  auto& cells = trial_.cells;
  cells.clear();
  trial_.begin_cell = cells.first();
  PlannedCell fixed = window_.cells[first - 1];
  cutter_.go_to(cutter_.behind({fixed.cell.interval, fixed.cell.start}, fixed.cell.length),
                fixed.cell.length);
  cutter_.end_after(distance);
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
  guess_braking(first);
  trial_.reset_weights(cells.first() + 1);
  return true;
}

void JerkPlan::guess_braking(std::uint64_t first) {
  auto& cells = trial_.cells;
  std::uint64_t in_force = first;
  for (std::uint64_t i = cells.first() + 1; i != cells.end(); ++i) {
    const double middle = cells[i].distance + 0.5 * cells[i].cell.length;
    while (in_force + 1 < run().stop.cell && distance_of(in_force + 1) <= middle) ++in_force;
    cells[i].guess = window_.cells[in_force].x_in_force;
  }
  double x = kGuessedStandstill * trial_.end.most_x;
  double before = 0.0;
  for (std::uint64_t i = cells.end(); i-- > cells.first() + 1;) {
    const SpeedCell& cell = cells[i].cell;
    const double way = 0.5 * (before + cell.length);
    before = cell.length;
    x = std::min({x + 2.0 * way * kFirm * cell.reach.moderate_w(x), cells[i].guess,
                  kGuessedSpeed * cell.machine_x});
    cells[i].x = x;
  }
}

/// What the trial uses of the limits in the end; without room for it, all that there are.
Usage JerkPlan::try_to_stop(std::uint64_t first, double distance) {
  if (!make_trial(first, distance)) return {kInfinity, trial_.cells.first()};
  const std::uint64_t free = trial_.cells.first() + 1;
  Usage usage{kInfinity, free};
  for (int i = 1; i <= kMostRounds; ++i, ++rounds_) {
    const bool more = trial_.improve(free);
    if (more && i < kFewRounds) continue;
    const double before = usage.part;
    usage = trial_.worst(free);
    if (usage.part <= kUsageOfPlan || !(usage.part - 1.0 <= kNearer * (before - 1.0))) break;
    trial_.defend_harder(free);
  }
  return usage;
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
