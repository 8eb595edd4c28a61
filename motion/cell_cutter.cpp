#include "motion/cell_cutter.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// A start from rest and a stop have constant jerk over this distance, mm, unless the whole way is
/// short, or the feed so low that the acceleration is built up sooner.
constexpr double kStandstill = 1e-3;
constexpr double kShareOfShortWay = 1.0 / 20.0;

/// From one cell to the next at most. x ~ u^(4/3) beside a standstill must not change by more than
/// a factor of 3 within a cell (see JerkBound), and is represented well below 2.
constexpr double kGrowth = 1.4;

/// Longest cell: this part of the distance in which acceleration builds up, or of the one in which
/// speed does, or the way in this time, s, whichever is longest.
constexpr double kPartOfJerking = 0.1;
constexpr double kPartOfAccelerating = 0.005;
constexpr double kLeastTime = 5e-4;

/// Unless the whole way is as short.
constexpr double kShortestCell = 1e-9;

/// The distance of a stop is longer by the way in this time, s: a plan is then made so long before
/// it is needed that it does not matter where exactly the motion is, within a setpoint.
constexpr double kMargin = 0.01;

/// Part of an interval that is rounding.
constexpr double kRounding = 1e-14;

double speed_on(const SpeedCell& cell) { return std::sqrt(std::min(cell.feed_x, cell.machine_x)); }

/// Time in which acceleration builds up, on the way to full speed.
double jerking_time(const SpeedCell& cell) {
  const double j = cell.reach.j_first;
  return std::min(cell.reach.a_first / j, std::sqrt(speed_on(cell) / j));
}

}  // namespace

CellCutter::CellCutter(const JerkLimits& limits, std::size_t max_intervals)
    : limits_(limits), intervals_(max_intervals), stops_(max_intervals) {}

void CellCutter::append(const PathInterval& interval) {
  intervals_.push_back(interval);
  if (!at_.end_is_known) at_.left += interval.length;
}

void CellCutter::stop_at_end() {
  const std::uint64_t end = intervals_.end();
  if (!stops_.empty() && stops_.back() == end) return;
  stops_.push_back(end);
  if (path_left()) at_.end_is_known = true;
}

void CellCutter::clear() {
  intervals_.clear();
  stops_.clear();
  at_ = {};
  at_.place.interval = intervals_.end();
}

void CellCutter::forget_before(std::uint64_t interval) {
  while (!intervals_.empty() && intervals_.first() < interval) intervals_.pop_front();
  while (!stops_.empty() && stops_.front() < interval) stops_.pop_front();
}

/// The first stop behind the begin of an interval; the end of the path if there is none.
std::uint64_t CellCutter::next_stop(std::uint64_t interval) const {
  std::uint64_t low = stops_.first();
  std::uint64_t high = stops_.end();
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (stops_[middle] <= interval) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low == stops_.end() ? intervals_.end() : stops_[low];
}

void CellCutter::go_to(const PathPlace& place, double previous) {
  at_.place = behind(place, 0.0);
  at_.previous = previous;
  at_.ends_early = false;
  const std::uint64_t end = next_stop(at_.place.interval);
  at_.left = -at_.place.start;
  for (std::uint64_t i = at_.place.interval; i < end; ++i) at_.left += intervals_[i].length;
  at_.end_is_known = path_left() && !stops_.empty() && stops_.back() >= end;
}

void CellCutter::end_after(double length) {
  at_.left = length;
  at_.ends_early = true;
}

PathPlace CellCutter::behind(PathPlace place, double length) const {
  place.start += length;
  while (place.interval + 1 < intervals_.end() &&
         place.start >= intervals_[place.interval].length * (1.0 - kRounding)) {
    place.start = std::max(0.0, place.start - intervals_[place.interval].length);
    ++place.interval;
  }
  return place;
}

PathPlace CellCutter::end_behind(const PathPlace& place, double length) const {
  PathPlace end = behind(place, length);
  const double whole = intervals_[end.interval].length;
  if (end.start < kShortestCell) end.start = 0.0;
  if (end.start > whole - kShortestCell) end.start = whole;
  return behind(end, 0.0);
}

void CellCutter::move_on(double length) {
  at_.place = behind(at_.place, length);
  at_.left -= length;
}

void CellCutter::skip(double length) {
  move_on(length);
  at_.previous = length;
}

Reach CellCutter::reach_of(PathPlace at, double length) const {
  Reach reach;
  while (length > kShortestCell && at.interval < intervals_.end()) {
    const PathInterval& interval = intervals_[at.interval];
    const double part = std::min(length, interval.length - at.start);
    if (part > 0.0) reach.include(make_cell(interval, at.start, part, limits_).reach);
    length -= part;
    at = {at.interval + 1, 0.0};
  }
  return reach;
}

double CellCutter::begin_run() {
  const SpeedCell cell = rest_of_interval();
  const double way = speed_on(cell) * std::max(jerking_time(cell), kLeastTime);
  at_.standstill =
      std::min({kStandstill, kShareOfShortWay * at_.left, std::max(way, kShortestCell)});
  return at_.standstill;
}

/// Cells shrink towards the end as they grow from the start; the last stretch is left for the stop.
double CellCutter::length_towards_end() const {
  const double before_stop = at_.left - at_.standstill;
  if (before_stop < 0.7 * at_.standstill) return 0.0;
  return std::max(0.7 * at_.standstill, before_stop * (1.0 - 1.0 / kGrowth));
}

double CellCutter::stop_length() const {
  const bool at_end = end_is_final() && length_towards_end() == 0.0;
  return at_end ? at_.left : std::min(at_.left, at_.previous);
}

SpeedCell CellCutter::rest_of_interval() const {
  const PathInterval& interval = intervals_[at_.place.interval];
  return make_cell(interval, at_.place.start, interval.length - at_.place.start, limits_);
}

/// Where the present interval wants no shorter cells.
double CellCutter::longest_here() const {
  const SpeedCell cell = rest_of_interval();
  const double v = speed_on(cell);
  const double a = cell.reach.a_first;
  return std::max({kPartOfJerking * v * jerking_time(cell), kPartOfAccelerating * v * v / a,
                   kLeastTime * v, kShortestCell});
}

double CellCutter::next_length() const {
  if (at_.place.interval >= intervals_.end()) return 0.0;
  const double rest = intervals_[at_.place.interval].length - at_.place.start;
  const double towards_end = length_towards_end();
  const double shortest = std::min(kShortestCell, 0.5 * at_.standstill);
  double length = std::min(rest, kGrowth * at_.previous);
  if (length > shortest) length = std::min(length, longest_here());
  if (towards_end < length && !end_is_final()) return 0.0;
  length = std::min(length, towards_end);
  if (length < shortest) return 0.0;
  // No sliver at the end of the interval.
  const double count = std::ceil(rest / length - 1e-6);
  return count <= 4.0 ? rest / count : length;
}

SpeedCell CellCutter::cell_at(const PathPlace& place, double length) const {
  SpeedCell cell = make_cell(intervals_[place.interval], place.start, length, limits_);
  cell.interval = place.interval;
  return cell;
}

std::optional<SpeedCell> CellCutter::next() {
  const double length = next_length();
  if (length == 0.0) return std::nullopt;
  const SpeedCell cell = cell_at(at_.place, length);
  move_on(length);
  at_.previous = length;
  return cell;
}

double CellCutter::stopping_distance(const PathInterval& interval) const {
  const SpeedCell cell = make_cell(interval, 0.0, interval.length, limits_);
  const double v = speed_on(cell);
  return v * v / (2.0 * cell.reach.a_first) + v * (jerking_time(cell) + kMargin);
}

}  // namespace cnc::motion
