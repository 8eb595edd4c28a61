// How a JerkPlan goes on: a guess for the longer path, rounds, and what becomes of the result.
#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/jerk_plan.h"

namespace cnc::motion {

namespace {

using Phase = MotionPlace::Phase;

/// Rounds of a plan, and how many more when it still breaks a limit.
constexpr int kRounds = 12;
constexpr int kMoreRounds = 24;

/// A finished plan may use kUsageOfPlan of x.
constexpr double kFeedReserve = 0.5 * (kUsageOfPlan - 1.0) * 1.01;

/// New cells in one plan; fewer after one that failed. The rounds of a longer window are slower:
/// they have one step length for all.
constexpr int kFewestNewCells = 10;

/// The guess uses these parts of the limits.
constexpr double kGuessedPart = 0.5;
constexpr double kGuessedSpeed = 0.9;
constexpr double kGuessedStandstill = 0.3;

/// A plan from rest that the rounds do not bring within the limits is slowed down, at most so often
/// (to 1e-39 of it), after x at the ends of a cell has been brought below so many times its middle.
constexpr double kSlower = 0.8;
constexpr int kMostSlower = 400;
constexpr double kSteepest = 2.5;

/// Between two attempts that fail.
constexpr std::uint64_t kCellsBeforeRetry = 8;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The end of a plan shapes what comes before it for about the time that stopping takes; this many
/// of them are planned anew.
constexpr double kTimeOfInfluence = 1.5;

/// To stand still from √x.
double stopping_time(const Reach& reach, double x) {
  const double v = std::sqrt(x);
  return v / reach.a_first +
         2.0 * std::min(reach.a_first / reach.j_first, std::sqrt(v / reach.j_first));
}

}  // namespace

bool JerkPlan::plan() {
  rounds_ = 0;
  if (place_.phase == Phase::stopping) return false;
  if (changed_) {
    drop_later_runs();
    split_present_cell();
  }
  if (standing() && !in_last_run()) {
    begin_next_run();
    return true;
  }
  const bool done = held_ ? plan_hold() : plan_run();
  if (done) changed_ = false;
  retry_at_cell_ = done ? 0 : place_.cell + kCellsBeforeRetry;
  return done;
}

// --- Going on ------------------------------------------------------------------------------------

bool JerkPlan::plan_run() {
  const bool from_rest = standing();
  if (from_rest && !path_left()) return false;
  for (;;) {
    if (from_rest) {
      begin_run();
    } else {
      drop_cells_behind_stop();
    }
    if (try_plan_run(from_rest)) break;
    if (from_rest) {
      drop_last_run();
    } else {
      drop_cells_behind_stop();
    }
    if (new_cells_ == kFewestNewCells) return false;
    new_cells_ = std::max(kFewestNewCells, new_cells_ / 2);
  }
  new_cells_ = std::min(kMostNewCells, 2 * new_cells_);
  if (from_rest) begin_next_run();
  return true;
}

bool JerkPlan::try_plan_run(bool from_rest) {
  auto first = from_rest ? run().begin : first_free();
  if (!first) return false;
  if (!changed_ && !from_rest) first = std::max(*first, run().shaped_from);
  cut();
  if (window_.cells.end() == run().begin) return false;
  const Stop stop = stop_behind(window_);
  window_.end = stop.end;
  guess(*first);
  window_.reset_weights(*first);
  if (!run_rounds(*first, kRounds)) {
    const bool is_last_try = from_rest && new_cells_ == kFewestNewCells;
    if (!is_last_try || !slow_down_until_kept()) return false;
  }
  put_in_force(stop);
  return true;
}

/// The cells end where the last run does, and the cutter goes on from there.
void JerkPlan::drop_cells_behind_stop() {
  auto& cells = window_.cells;
  const Stop& stop = run().stop;
  while (cells.end() > stop.cell) cells.pop_back();
  window_.end = stop.end;
  if (stop.cell > run().begin) cutter_.go_to(stop.place, cells.back().cell.length);
}

void JerkPlan::drop_last_run() {
  auto& cells = window_.cells;
  while (cells.end() > run().begin) cells.pop_back();
  runs_.pop_back();
  cutter_.go_to(run().end, 0.0);
}

/// From where the motion is everything is planned anew.
void JerkPlan::drop_later_runs() {
  if (in_last_run()) return;
  while (!in_last_run()) drop_last_run();
  window_.begin_cell = std::max(run().begin, window_.cells.first());
  window_.most_start_x = window_.begin_cell == run().begin ? run().most_start_x : kInfinity;
  if (standing()) {
    begin_at_standstill();
  } else {
    drop_cells_behind_stop();
  }
}

void JerkPlan::begin_run() {
  begin_at_standstill();
  Run next;
  next.begin = next.shaped_from = window_.cells.end();
  next.from = cutter_.place();
  next.start_length = cutter_.begin_run();
  next.most_start_x =
      cutter_.reach_of(next.from, next.start_length).standstill_x(next.start_length);
  next.stop.cell = next.begin;
  runs_.push_back(next);
  window_.begin_cell = next.begin;
  window_.most_start_x = next.most_start_x;
  cutter_.skip(next.start_length);
}

void JerkPlan::begin_next_run() {
  const std::uint64_t next = place_.run + 1;
  place_ = {next, Phase::starting, runs_[next].begin, 0.0};
}

void JerkPlan::cut() {
  for (int i = 0; i < new_cells_ && free_cells() > 0; ++i) {
    const auto cell = cutter_.next();
    if (!cell) return;
    push_cell(*cell);
  }
}

void JerkPlan::push_cell(const SpeedCell& cell) {
  auto& cells = window_.cells;
  if (cells.end() > run().begin) {
    cells.push_back(planned_behind(cells.back(), cell));
    return;
  }
  PlannedCell planned;
  planned.cell = cell;
  planned.knot.behind = part_beside_standstill(cell.length, run().start_length);
  cells.push_back(planned);
}

JerkPlan::Stop JerkPlan::stop_behind(const SpeedWindow& window) const {
  Stop stop;
  stop.cell = window.cells.end();
  stop.place = cutter_.place();
  stop.length = cutter_.stop_length();
  stop.end.most_x = cutter_.reach_of(stop.place, stop.length).standstill_x(stop.length);
  stop.end.knot.before = part_beside_standstill(window.cells.back().cell.length, stop.length);
  return stop;
}

/// What is driven now, and x and w at its end, cannot change any more: they fix the coefficient of
/// the cell behind it.
std::optional<std::uint64_t> JerkPlan::first_free() const {
  std::uint64_t fixed = run().begin;
  if (place_.phase == Phase::driving) fixed = place_.time > 0.0 ? place_.cell + 1 : place_.cell;
  if (fixed >= run().stop.cell) return std::nullopt;
  return fixed + 1;
}

/// Where the plan in force could still stop in much less time than it has, a longer path changes
/// nothing.
std::uint64_t JerkPlan::first_shaped_by_stop() const {
  double left = 0.0;
  std::uint64_t index = run().stop.cell;
  while (index > window_.begin_cell + 1) {
    left += duration_of(--index, run());
    const PlannedCell& planned = window_.cells[index];
    if (left > kTimeOfInfluence * stopping_time(planned.cell.reach, planned.x_in_force)) break;
  }
  return index;
}

/// x over the next half cells with moderate acceleration, within moderate speeds.
double JerkPlan::guess_forward(std::uint64_t index, double x, double way) const {
  const PlannedCell& planned = window_.cells[index];
  const Reach& reach = planned.cell.reach;
  return std::min({x + 2.0 * way * reach.moderate_w(x), reach.cruise_x(kGuessedPart),
                   kGuessedSpeed * planned.cell.machine_x, kGuessedSpeed * planned.wanted_x});
}

/// Where the rounds begin: second-order envelopes from both ends with half of the limits, or the
/// plan in force where that is faster.
void JerkPlan::guess(std::uint64_t first) {
  auto& cells = window_.cells;
  for (std::uint64_t i = window_.begin_cell; i != cells.end(); ++i) {
    PlannedCell& planned = cells[i];
    const double feed = overrides_.of(planned.cell.override) * (1.0 - kFeedReserve);
    planned.wanted_x = feed * feed * planned.cell.feed_x;
    planned.feed_is_kept = true;
    if (i >= run().stop.cell) continue;
    planned.x = planned.x_in_force;
    const CellX now = x_in_force(i, run());
    planned.feed_is_kept = std::max({now[0], now[1], now[2]}) <= kUsageOfPlan * planned.wanted_x;
  }
  const bool from_rest = first == run().begin;
  double x = from_rest ? kGuessedStandstill * window_.most_start_x : cells[first - 1].x;
  double before = from_rest ? 0.0 : cells[first - 1].cell.length;
  for (std::uint64_t i = first; i != cells.end(); ++i) {
    x = guess_forward(i, x, 0.5 * (before + cells[i].cell.length));
    before = cells[i].cell.length;
    cells[i].guess = x;
  }
  x = kGuessedStandstill * window_.end.most_x;
  before = 0.0;
  for (std::uint64_t i = cells.end(); i-- > first;) {
    PlannedCell& planned = cells[i];
    x = std::min(guess_forward(i, x, 0.5 * (before + planned.cell.length)), planned.guess);
    before = planned.cell.length;
    const bool in_force = i < run().stop.cell;
    planned.x = in_force ? std::max(planned.x_in_force, x) : x;
  }
}

bool JerkPlan::run_rounds(std::uint64_t first, int rounds) {
  for (int most = rounds + kMoreRounds; rounds_ < most; ++rounds_) {
    const bool more = window_.improve(first);
    if (more && rounds_ + 1 < rounds) continue;
    if (window_.usage(first) <= kUsageOfPlan) return true;
    window_.defend_harder(first);
  }
  return false;
}

/// From standstill to standstill a slower motion breaks no limit that it kept before: acceleration
/// goes with x and jerk with its power 1.5. False when it does not help.
bool JerkPlan::slow_down_until_kept() {
  flatten();
  const std::uint64_t first = window_.begin_cell;
  for (int i = 0; i < kMostSlower; ++i) {
    if (window_.usage(first) <= kUsageOfPlan) return true;
    for (std::uint64_t k = first; k != window_.cells.end(); ++k) window_.cells[k].x *= kSlower;
  }
  return false;
}

/// However slow, the jerk is judged by a tangent that leaves nothing where x at an end of a cell is
/// three times that of its middle.
void JerkPlan::flatten() {
  auto& cells = window_.cells;
  const auto limit = [](double& x, double neighbour, double part_of_x) {
    x = std::min(x, neighbour * (1.0 + (kSteepest - 1.0) / part_of_x));
  };
  for (std::uint64_t i = window_.begin_cell + 1; i != cells.end(); ++i) {
    limit(cells[i].x, cells[i - 1].x, cells[i].knot.behind);
  }
  for (std::uint64_t i = cells.end() - 1; i > window_.begin_cell; --i) {
    limit(cells[i - 1].x, cells[i].x, cells[i].knot.before);
  }
}

void JerkPlan::put_in_force(const Stop& stop) {
  for (std::uint64_t i = window_.begin_cell; i != stop.cell; ++i) {
    window_.cells[i].x_in_force = window_.cells[i].x;
  }
  end_run_at(stop);
}

void JerkPlan::end_run_at(const Stop& stop) {
  Run& last = run();
  last.stop = stop;
  last.end = cutter_.end_behind(stop.place, stop.length);
  last.stop_speed = std::sqrt(x_in_force(stop.cell - 1, last)[2]);
  if (window_.begin_cell == last.begin)
    last.start_speed = std::sqrt(x_in_force(last.begin, last)[0]);
  last.shaped_from = first_shaped_by_stop();
}

}  // namespace cnc::motion
