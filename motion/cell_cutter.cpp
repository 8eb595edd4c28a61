#include "motion/cell_cutter.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// A start from rest and a stop have constant jerk over this distance, mm, unless the whole way is
/// short.
constexpr double kStandstill = 1e-3;
constexpr double kShareOfShortWay = 1.0 / 20.0;

/// From one cell to the next at most. x ~ u^(4/3) beside a standstill must not change by more than
/// a factor of 3 within a cell (see JerkBound), and is represented well below 2.
constexpr double kGrowth = 1.4;

/// Longest cell: this part of the distance in which acceleration builds up, or of the one in which
/// speed does, whichever is longer.
constexpr double kPartOfJerking = 0.1;
constexpr double kPartOfAccelerating = 0.005;

constexpr double kShortestCell = 1e-9;

double speed_on(const SpeedCell& cell) { return std::sqrt(std::min(cell.feed_x, cell.machine_x)); }

/// Time in which acceleration builds up, on the way to full speed.
double jerking_time(const SpeedCell& cell) {
  const double j = cell.reach.j_first;
  return std::min(cell.reach.a_first / j, std::sqrt(speed_on(cell) / j));
}

}  // namespace

CellCutter::CellCutter(const JerkLimits& limits, std::size_t max_intervals)
    : intervals(max_intervals), limits_(limits) {}

void CellCutter::append(const PathInterval& interval) {
  intervals.push_back(interval);
  left_ += interval.length;
  closed_ = false;
}

void CellCutter::go_to(const PathPlace& place, double previous) {
  place_ = place;
  previous_ = previous;
  ends_early_ = false;
  left_ = -place.start;
  for (std::uint64_t i = place.interval; i < intervals.end(); ++i) left_ += intervals[i].length;
}

void CellCutter::end_after(double length) {
  left_ = length;
  ends_early_ = true;
}

PathPlace CellCutter::behind(PathPlace place, double length) const {
  place.start += length;
  while (place.interval + 1 < intervals.end() &&
         place.start >= intervals[place.interval].length - kShortestCell) {
    place.start = std::max(0.0, place.start - intervals[place.interval].length);
    ++place.interval;
  }
  return place;
}

void CellCutter::move_on(double length) {
  place_ = behind(place_, length);
  left_ -= length;
}

void CellCutter::skip(double length) {
  move_on(length);
  previous_ = length;
}

Reach CellCutter::reach_of(PathPlace at, double length) const {
  Reach reach;
  while (length > kShortestCell && at.interval < intervals.end()) {
    const PathInterval& interval = intervals[at.interval];
    const double part = std::min(length, interval.length - at.start);
    if (part > 0.0) reach.include(make_cell(interval, at.start, part, limits_).reach);
    length -= part;
    at = {at.interval + 1, 0.0};
  }
  return reach;
}

double CellCutter::begin_run() {
  standstill_ = std::min(kStandstill, kShareOfShortWay * left_);
  return standstill_;
}

/// Cells shrink towards the end as they grow from the start; the last stretch is left for the stop.
double CellCutter::length_towards_end() const {
  const double before_stop = left_ - standstill_;
  if (before_stop < 0.7 * standstill_) return 0.0;
  return std::max(0.7 * standstill_, before_stop * (1.0 - 1.0 / kGrowth));
}

double CellCutter::stop_length() const {
  const bool at_end = end_is_final() && length_towards_end() == 0.0;
  return at_end ? left_ : std::min(left_, previous_);
}

/// Where the present interval wants no shorter cells.
double CellCutter::longest_here() const {
  const PathInterval& interval = intervals[place_.interval];
  const SpeedCell cell = make_cell(interval, place_.start, interval.length - place_.start, limits_);
  const double v = speed_on(cell);
  const double a = cell.reach.a_first;
  return std::max(kPartOfJerking * v * jerking_time(cell), kPartOfAccelerating * v * v / a);
}

double CellCutter::next_length() const {
  if (place_.interval >= intervals.end()) return 0.0;
  const double rest = intervals[place_.interval].length - place_.start;
  const double towards_end = length_towards_end();
  double length = std::min(rest, kGrowth * previous_);
  if (length > kShortestCell) length = std::min(length, longest_here());
  if (towards_end < length && !end_is_final()) return 0.0;
  length = std::min(length, towards_end);
  if (length < kShortestCell) return 0.0;
  // No sliver at the end of the interval.
  const double count = std::ceil(rest / length - 1e-6);
  return count <= 4.0 ? rest / count : length;
}

SpeedCell CellCutter::cell_at(const PathPlace& place, double length) const {
  SpeedCell cell = make_cell(intervals[place.interval], place.start, length, limits_);
  cell.interval = place.interval;
  return cell;
}

std::optional<SpeedCell> CellCutter::next() {
  const double length = next_length();
  if (length == 0.0) return std::nullopt;
  const SpeedCell cell = cell_at(place_, length);
  move_on(length);
  previous_ = length;
  return cell;
}

Stopping CellCutter::stopping_on(const PathInterval& interval) const {
  const SpeedCell cell = make_cell(interval, 0.0, interval.length, limits_);
  const double v = speed_on(cell);
  const double a = cell.reach.a_first;
  const double jerking = jerking_time(cell);
  return {v * v / (2.0 * a) + v * jerking, v / a + 2.0 * jerking};
}

}  // namespace cnc::motion
