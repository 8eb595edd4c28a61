#include "motion/jerk_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "motion/step.h"

namespace cnc::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Cells of the plan ahead of the motion, and intervals of the path; how much of both may lie
/// behind it where it can be sent back, and how much a setpoint may add.
constexpr std::size_t kMostAhead = 4096;
constexpr std::uint64_t kMostBehind = 4096;
constexpr std::uint64_t kMostRunsBehind = 256;
constexpr std::uint64_t kMostCellsOfSetpoint = 256;

/// Largest distance of a setpoint's cubic from the planned motion, mm: far below any step.
constexpr double kPathTolerance = 1e-5;

/// Acceleration of a cubic at its ends beside that of the planned motion: so much of the change
/// that the jerk allows while it lasts. It leaps by that from one setpoint to the next.
constexpr double kLeap = 0.01;

/// Share of the jerk that the plan uses; these leaps may take the rest.
constexpr double kShareOfJerk = 1.0 - kLeap;

/// Setpoints are never shorter, s, and none ends so shortly before the end of a cell: the next one
/// would have to reach beyond, and the jerk may leap there.
constexpr double kSliver = 5e-5;

/// In which an axis reaches its acceleration, s, without a limit of jerk or with one that is
/// higher: less would make cells so short that planning takes longer than the motion.
constexpr double kShortestJerking = 1e-3;

}  // namespace

JerkLimits jerk_limits(const AxisLimits& limits) {
  JerkLimits result{limits.max_velocity, limits.max_acceleration, limits.max_jerk};
  for (const Axis axis : kAllAxes) {
    const double most = limits.max_acceleration[axis] / kShortestJerking;
    const double jerk = limits.max_jerk[axis];
    result.jerk[axis] = kShareOfJerk * (jerk > 0.0 ? std::min(jerk, most) : most);
  }
  return result;
}

PathInterval interval_of(const Piece& piece, double begin, double length) {
  PathInterval interval;
  interval.length = length;
  interval.first = tangent_of(piece.curve, begin);
  interval.second = bend_of(piece.curve, begin);
  if (!is_straight(piece.curve)) {
    const Position end = bend_of(piece.curve, begin + length);
    interval.third = (end - interval.second) * (1.0 / length);
  }
  interval.feed = piece.kind == MoveKind::rapid ? kInfinity : piece.feed;
  interval.measure = measure_of(piece.curve);
  interval.override = piece.override;
  return interval;
}

JerkProfile::JerkProfile(const AxisLimits& limits, double max_duration, bool goes_back)
    : limits_(limits),
      max_duration_(max_duration - kSliver),
      plan_(jerk_limits(limits), kMostAhead, goes_back ? kMostBehind : 0),
      pieces_(kMostAhead + (goes_back ? kMostBehind : 0)),
      parts_(kMostAhead + (goes_back ? kMostBehind : 0)) {
  limits_.max_jerk = jerk_limits(limits).jerk;
  if (goes_back) plan_.save();
}

// --- The path ------------------------------------------------------------------------------------

void JerkProfile::append(const Piece& piece) {
  if (piece.entry != Entry::smooth) plan_.stop_at_end();
  pieces_.push_back(piece);
  Piece& last = pieces_.back();
  last.stepped = last.begin;
  last.grid = last.end - last.begin;
  if (const auto* arc = std::get_if<Arc>(&last.curve)) {
    last.grid /= std::ceil(std::abs(arc->sweep()) / kArcStep);
  }
  (void)extend();
}

bool JerkProfile::extend() {
  if (pieces_.empty()) return true;
  Piece& last = pieces_.back();
  while (last.stepped < last.end) {
    const bool goes_on = last.stepped > last.begin;
    if (!plan_.has_room() || (goes_on && !plan_.wants_path())) return false;
    const double left = last.end - last.stepped;
    const double length = left < 1.5 * last.grid ? left : last.grid;
    plan_.append(interval_of(last, last.stepped, length));
    parts_.push_back({pieces_.end() - 1, last.stepped});
    last.stepped = length == left ? last.end : last.stepped + length;
  }
  if (last.stop_at_end || last.entry == Entry::vertex) plan_.stop_at_end();
  return plan_.has_room();
}

void JerkProfile::stop_at_end() {
  if (pieces_.empty()) return;
  pieces_.back().stop_at_end = true;
  (void)extend();
}

void JerkProfile::set_overrides(const Overrides& overrides) {
  overrides_ = overrides;
  plan_.set_overrides(overrides);
}

void JerkProfile::clear() {
  plan_.clear();
  pieces_.clear();
  parts_.clear();
}

// --- Places --------------------------------------------------------------------------------------

const Piece& JerkProfile::piece_of(std::uint64_t interval) const {
  return pieces_[parts_[interval].piece];
}

double JerkProfile::place_on_curve(const PathPlace& place) const {
  const Part& part = parts_[place.interval];
  return std::min(part.begin + place.start, pieces_[part.piece].end);
}

Position JerkProfile::position_at(const PathPlace& place) const {
  return point_of(piece_of(place.interval).curve, place_on_curve(place));
}

void JerkProfile::go_back(const ProfilePlace& place) {
  plan_.go_back(std::get<MotionPlace>(place));
}

void JerkProfile::revert(const ProfilePlace& place) {
  plan_.restore();
  go_back(place);
}

void JerkProfile::forget_before(const ProfilePlace& place) {
  plan_.forget_before(std::get<MotionPlace>(place));
  while (parts_.first() < plan_.intervals().first()) parts_.pop_front();
  if (parts_.empty()) return;
  while (pieces_.first() < parts_.front().piece) pieces_.pop_front();
}

std::uint64_t JerkProfile::cells_since(const MotionPlace& place) const {
  return plan_.place().cell - place.cell;
}

bool JerkProfile::keeps_too_much(const ProfilePlace& oldest) const {
  const auto& place = std::get<MotionPlace>(oldest);
  return cells_since(place) > kMostBehind || plan_.place().run - place.run > kMostRunsBehind ||
         plan_.motion().place.interval - plan_.motion_at(place).place.interval > kMostBehind;
}

bool JerkProfile::can_keep_more(const ProfilePlace& oldest) const {
  const auto& place = std::get<MotionPlace>(oldest);
  return cells_since(place) + kMostCellsOfSetpoint <= kMostBehind &&
         plan_.place().run - place.run < kMostRunsBehind &&
         plan_.motion().place.interval - plan_.motion_at(place).place.interval +
                 kMostCellsOfSetpoint <=
             kMostBehind;
}

bool JerkProfile::can_go_on_alone() const { return plan_.held() || plan_.knows_enough(); }

// --- Motion --------------------------------------------------------------------------------------

/// An override of 0 is a hold.
void JerkProfile::obey(bool held) {
  const PathPlace next = plan_.next_place();
  const bool barred =
      next.interval < parts_.end() && overrides_.of(piece_of(next.interval).override) <= 0.0;
  const bool stop = held || barred;
  if (stop == plan_.held()) return;
  if (stop) {
    plan_.hold();
  } else {
    plan_.resume();
  }
}

void JerkProfile::prepare(bool held) {
  obey(held);
  while (plan_.due() && plan_.plan()) {
  }
}

std::optional<Setpoint> JerkProfile::next(bool /*held*/) {
  if (plan_.standing()) return std::nullopt;
  Setpoint setpoint = setpoint_of(without_sliver(longest_duration()));
  while (!follows(setpoint)) {
    if (setpoint.duration > kShortestSetpoint + kSliver) {
      setpoint = setpoint_of(without_sliver(shorter_than(setpoint.duration)));
    } else {
      // Within a cell the jerk does not leap.
      setpoint = setpoint_of(std::min(setpoint.duration, time_to_end_of_cell()));
      break;
    }
  }
  const Piece& piece = piece_before(setpoint.duration);
  setpoint.tag = piece.tag;
  setpoint.feed_limit = piece.kind == MoveKind::feed ? piece.feed : 0.0;
  plan_.advance_to(plan_.after(plan_.place(), setpoint.duration));
  return setpoint;
}

/// To the standstill if that is near; neither this setpoint nor the last one becomes too short.
double JerkProfile::longest_duration() const {
  const double enough = max_duration_ + kShortestSetpoint;
  double time = 0.0;
  for (MotionPlace at = plan_.place(); at.phase != MotionPlace::Phase::standing;
       at = plan_.behind_cell(at)) {
    time += plan_.time_in_cell(at);
    if (time > enough) return max_duration_;
  }
  return time <= max_duration_ ? time : 0.5 * time;
}

/// To the first one that is no sliver away.
double JerkProfile::time_to_end_of_cell() const {
  double time = 0.0;
  for (MotionPlace at = plan_.place(); at.phase != MotionPlace::Phase::standing && time <= kSliver;
       at = plan_.behind_cell(at)) {
    time += plan_.time_in_cell(at);
  }
  return time;
}

/// At the end of a cell where there is one, for the jerk may leap there; but no sliver.
double JerkProfile::shorter_than(double duration) const {
  double time = 0.0;
  double best = 0.0;
  const double most = 0.95 * duration - kSliver;
  for (MotionPlace at = plan_.place(); time <= most; at = plan_.behind_cell(at)) {
    best = time;
    time += plan_.time_in_cell(at);
  }
  return std::max(kShortestSetpoint, best > 0.25 * duration ? best : 0.5 * duration);
}

/// Longer where less than a sliver would be left of the cell.
double JerkProfile::without_sliver(double duration) const {
  const double rest = plan_.time_in_cell(plan_.after(plan_.place(), duration));
  return rest < kSliver ? duration + rest : duration;
}

Setpoint JerkProfile::setpoint_of(double duration) const {
  const PathMotion end = plan_.motion_at(plan_.after(plan_.place(), duration));
  Setpoint setpoint;
  setpoint.duration = duration;
  setpoint.position = position_at(end.place);
  if (end.v > 0.0) {
    setpoint.velocity =
        end.v * tangent_of(piece_of(end.place.interval).curve, place_on_curve(end.place));
  }
  return setpoint;
}

Position JerkProfile::acceleration_after(double time) const {
  const PathMotion motion = plan_.motion_at(plan_.after(plan_.place(), time));
  if (motion.v == 0.0) return {};
  const PathInterval& q = plan_.intervals()[motion.place.interval];
  const double u = motion.place.start;
  return motion.w * q.first_at(u) + (motion.v * motion.v) * q.second_at(u);
}

/// Of the move that it drives last.
const Piece& JerkProfile::piece_before(double time) const {
  const MotionPlace place = plan_.after(plan_.place(), time * (1.0 - 1e-6));
  return piece_of(plan_.motion_at(place).place.interval);
}

bool JerkProfile::follows(const Setpoint& setpoint) const {
  const Setpoint start = setpoint_of(0.0);
  constexpr std::array<double, 2> kParts{1.0 / 3.0, 2.0 / 3.0};
  std::array<Position, 2> planned;
  for (std::size_t i = 0; i < kParts.size(); ++i) {
    planned[i] = setpoint_of(kParts[i] * setpoint.duration).position;
  }
  const Position start_acceleration = acceleration_after(0.0);
  const Position end_acceleration = acceleration_after(setpoint.duration);
  for (const Axis axis : kAllAxes) {
    const AxisCubic cubic = cubic_of(axis, start.position, start.velocity, setpoint);
    const double most = limits_.max_acceleration[axis];
    const double leap = kLeap * limits_.max_jerk[axis] * setpoint.duration;
    if (std::abs(cubic.start_acceleration() - start_acceleration[axis]) > leap) return false;
    if (std::abs(cubic.end_acceleration() - end_acceleration[axis]) > leap) return false;
    if (std::abs(cubic.start_acceleration()) > most) return false;
    if (std::abs(cubic.end_acceleration()) > most) return false;
    if (cubic.fastest() > limits_.max_velocity[axis]) return false;
    for (std::size_t i = 0; i < kParts.size(); ++i) {
      const double there = cubic.position(kParts[i] * setpoint.duration);
      if (std::abs(there - planned[i][axis]) > kPathTolerance) return false;
    }
  }
  return true;
}

std::optional<Stretch> JerkProfile::skip() {
  if (plan_.standing()) return std::nullopt;
  const PathPlace begin = plan_.motion().place;
  const std::uint64_t piece = parts_[begin.interval].piece;
  Stretch stretch{0.0, pieces_[piece].tag};
  do {
    stretch.duration += plan_.time_in_cell();
    plan_.advance_to(plan_.behind_cell(plan_.place()));
  } while (!plan_.standing() && !plan_.due() && !plan_.lacks_path() &&
           parts_[plan_.motion().place.interval].piece == piece);
  return stretch;
}

double JerkProfile::time_to_end() const {
  double time = plan_.time_to_stop();
  const PathPlace end = plan_.planned_end();
  double done = end.start;
  for (std::uint64_t i = end.interval; i < parts_.end(); ++i) {
    const PathInterval& interval = plan_.intervals()[i];
    const double machine = largest_along(interval.first, limits_.max_velocity);
    const double wanted =
        interval.feed * overrides_.of(interval.override) / interval.speed_of(interval.first);
    time += std::max(0.0, interval.length - done) / std::min(machine, wanted);
    done = 0.0;
  }
  return time;
}

}  // namespace cnc::motion
