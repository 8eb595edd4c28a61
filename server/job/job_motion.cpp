// Moves of the interpreter become moves of the planner: with their feed, inside of the travel.
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "server/job/job_runner.h"
#include "server/job/overloaded.h"
#include "server/job/surface_speed.h"
#include "server/job/travel_limits.h"

namespace cnc::server {
namespace {

/// A line along which the spindle changes its speed (G96) has so many feeds per revolution (G95).
constexpr int kPartsOfFacing = 64;

}  // namespace

/// Whoever only renders a program lets a probe move run to its end.
bool JobRunner::is_motion(const interp::CommandBody& body) const {
  return mode_ != interp::RunMode::run && std::holds_alternative<interp::ProbeMove>(body);
}

void JobRunner::queue_thread(bool goes_on) {
  if (thread_move_) {
    const interp::Command command = *std::exchange(thread_move_, std::nullopt);
    if (auto queued = queue_sync_move(command, goes_on); !queued)
      fail_with(std::move(queued.error()), command.source);
  }
  in_thread_ = in_thread_ && goes_on;
}

Result<void> JobRunner::queue_sync_move(const interp::Command& command, bool goes_on) {
  const auto& move = std::get<interp::SyncMove>(command.body);
  const double rpm =
      mode_ == interp::RunMode::run
          ? measured_speed_
          : 60.0 * turns_per_second(motion::extents_of_line(planner_.queue_end(), move.end));
  motion::MoveOptions options = options_for(command, motion::MoveKind::feed);
  options.feed = move.pitch * rpm / 60.0;
  options.override = motion::Override::none;
  options.stop_at_end = !goes_on;
  options.laf_angle = 180.0;  // a thread goes on through its tapers
  options.tag.spindle_speed = mode_ == interp::RunMode::run ? rpm : 0.0;
  options.tag.begins_at_index = std::exchange(begins_at_index_, false);
  if (auto possible = check_thread_speed(config_, move.end - planner_.queue_end(), options.feed);
      !possible)
    return possible;
  return queue_line(move.end, options);
}

Result<void> JobRunner::queue_motion(const interp::Command& command) {
  return std::visit(
      Overloaded{
          [&](const interp::RapidMove& move) -> Result<void> {
            return queue_line(move.end, options_for(command, motion::MoveKind::rapid));
          },
          [&](const interp::FeedMove& move) -> Result<void> {
            return queue_feed_line(command, move.end);
          },
          [&](const interp::ProbeMove& move) -> Result<void> {
            return queue_feed_line(command, move.end);
          },
          [&](const interp::ArcMove& move) -> Result<void> {
            return queue_arc(
                {move.end, move.plane, move.first_centre, move.second_centre, move.turns},
                options_for(command, motion::MoveKind::feed));
          },
          [](const auto&) -> Result<void> { return {}; },
      },
      command.body);
}

Result<void> JobRunner::queue_feed_line(const interp::Command& command, const Position& end) {
  motion::MoveOptions options = options_for(command, motion::MoveKind::feed);
  const Position start = planner_.queue_end();
  const bool stops = std::exchange(options.stop_at_end, false);
  const int parts = feed_depends_on_radius() && start[Axis::X] != end[Axis::X] ? kPartsOfFacing : 1;
  for (int part = 1; part <= parts; ++part) {
    const bool is_last = part == parts;
    const Position to = is_last ? end : start + (end - start) * (1.0 / parts * part);
    options.feed = feed_of_line(to);
    options.stop_at_end = stops && is_last;
    if (auto queued = queue_line(to, options); !queued) return queued;
  }
  return {};
}

Result<void> JobRunner::queue_line(const Position& end, const motion::MoveOptions& options) {
  const Position start = planner_.queue_end();
  const auto extents = motion::extents_of_line(start, end);
  if (auto inside = check_space(extents); !inside) return inside;
  if (guards_tool_change_) {
    if (auto clear = check_tool_change_area(config_.tool_change_area, start, end); !clear)
      return clear;
  }
  return planner_.add_line(end, beside_limits(options, extents));
}

Result<void> JobRunner::queue_arc(const motion::ArcShape& shape, motion::MoveOptions options) {
  const auto arc = motion::make_arc(planner_.queue_end(), shape);
  if (!arc) return std::unexpected(arc.error());
  const auto extents = motion::extents_of_arc(*arc);
  if (feed_depends_on_way()) options.feed = feed_along(*arc, extents);
  if (auto inside = check_space(extents); !inside) return inside;
  if (guards_tool_change_) {
    if (auto clear = check_tool_change_area(config_.tool_change_area, extents); !clear)
      return clear;
  }
  return planner_.add_arc(shape, beside_limits(options, extents));
}

/// Where the program runs along the end of the travel, a smoothed path must not swing out of it.
motion::MoveOptions JobRunner::beside_limits(motion::MoveOptions options,
                                             const motion::Extents& extents) const {
  options.tolerance = tolerance_within_travel(config_, with_height_map(extents), options.tolerance);
  return options;
}

/// MCAGuard off concerns rendering only: a run never leaves the travel.
Result<void> JobRunner::check_space(const motion::Extents& extents) const {
  if (!guards_machine_ && mode_ != interp::RunMode::run) return {};
  return check_travel(config_, with_height_map(extents));
}

motion::Extents JobRunner::with_height_map(motion::Extents extents) const {
  extents.min[Axis::Z] += lowest_added_;
  extents.max[Axis::Z] += highest_added_;
  return extents;
}

motion::MoveOptions JobRunner::options_for(const interp::Command& command, motion::MoveKind kind) {
  motion::MoveOptions options;
  options.kind = kind;
  options.feed = feed_.feed;
  if (feed_.mode == interp::FeedMode::per_revolution)
    options.override = motion::Override::feed_per_turn;
  options.stop_at_end = path_mode_.mode == interp::PathMode::exact_stop;
  options.laf_angle = path_mode_.laf_angle;
  if (path_mode_.mode == interp::PathMode::continuous) {
    options.tolerance = path_mode_.tolerance.value_or(config_.trajectory.path_tolerance);
  }
  options.simplify = path_mode_.simplification.value_or(0.0);
  options.tag = {++last_move_, command.source.file == 0 ? command.source.line : 0};
  return options;
}

/// Of the spindle where the tool is furthest from the turning axis, which is at work X = 0: there
/// it turns slowest.
double JobRunner::turns_per_second(const motion::Extents& extents) const {
  constexpr double kSecondsPerMinute = 60.0;
  double rpm = std::min(spindle_speed_, config_.spindle.max_speed);
  if (surface_speed_) {
    const double axis = interpreter_.total_offset()[Axis::X];
    const double radius =
        std::max(std::abs(extents.min[Axis::X] - axis), std::abs(extents.max[Axis::X] - axis));
    rpm = surface_rpm(*surface_speed_, radius, config_.spindle.max_speed);
  }
  return rpm / kSecondsPerMinute;
}

bool JobRunner::feed_depends_on_radius() const {
  return feed_.mode == interp::FeedMode::per_revolution && surface_speed_.has_value();
}

double JobRunner::feed_of_line(const Position& end) const {
  if (!feed_depends_on_way()) return feed_.feed;
  const Position start = planner_.queue_end();
  return feed_along(motion::Line(start, end), motion::extents_of_line(start, end));
}

/// Per minute F is the feed itself, unless it is that of the tip over a turning work piece.
bool JobRunner::feed_depends_on_way() const {
  return feed_.mode != interp::FeedMode::per_minute ||
         config_.axes[Axis::A].mode == config::AxisMode::mill;
}

/// The feed along the path, per second of what its length measures. Inverse time: the whole move
/// takes 1/F. With a fourth axis the tip's mean speed on the work piece is F.
double JobRunner::feed_along(const motion::Curve& curve, const motion::Extents& extents) const {
  const double length = motion::length_of(curve);
  if (length == 0.0) return feed_.feed;  // the move vanishes
  if (feed_.mode == interp::FeedMode::inverse_time) return feed_.feed * length;
  const bool per_revolution = feed_.mode == interp::FeedMode::per_revolution;
  const double feed = per_revolution ? feed_.feed * turns_per_second(extents) : feed_.feed;
  const double way = tip_way(curve);
  if (feed * length >= motion::kLargestFeed * way) return motion::kLargestFeed;
  return feed * length / way;
}

/// How far the tip goes on the work piece. A turns it about work Y0 Z0; seen from there the tip
/// moves with v + omega x r. Gauss' rule of two points in each of 16 parts.
double JobRunner::tip_way(const motion::Curve& curve) const {
  const double length = motion::length_of(curve);
  const bool turns = motion::tangent_of(curve, 0.0)[Axis::A] != 0.0;
  if (!turns || config_.axes[Axis::A].mode != config::AxisMode::mill) return length;
  constexpr int kParts = 16;
  constexpr double kRadian = std::numbers::pi / 180.0;
  const double part = length / kParts;
  const double gauss = 0.5 / std::numbers::sqrt3;
  double way = 0.0;
  for (int i = 0; i < kParts; ++i) {
    for (const double place : {i + 0.5 - gauss, i + 0.5 + gauss}) {
      const Position point = motion::point_of(curve, place * part);
      const Position tangent = motion::tangent_of(curve, place * part);
      const Position at = interpreter_.to_work(point);
      const Position v = interpreter_.to_work(point + tangent) - at;
      const double omega = kRadian * tangent[Axis::A];
      way += 0.5 * part *
             std::hypot(v[Axis::X], v[Axis::Y] - omega * at[Axis::Z],
                        v[Axis::Z] + omega * at[Axis::Y]);
    }
  }
  return way;
}

}  // namespace cnc::server
