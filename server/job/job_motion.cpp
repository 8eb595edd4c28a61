// Moves of the interpreter become moves of the planner: with their feed, inside of the travel.
#include <cmath>
#include <utility>
#include <variant>

#include "server/job/job_runner.h"
#include "server/job/overloaded.h"
#include "server/job/surface_speed.h"
#include "server/job/travel_limits.h"

namespace cnc::server {

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
  const double rpm = mode_ == interp::RunMode::run ? measured_speed_ : 60.0 * turns_per_second();
  motion::MoveOptions options = options_for(command, motion::MoveKind::feed, move.end);
  options.feed = move.pitch * rpm / 60.0;
  options.follows_override = false;
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
            return queue_line(move.end, options_for(command, motion::MoveKind::rapid, move.end));
          },
          [&](const interp::FeedMove& move) -> Result<void> {
            return queue_line(move.end, options_for(command, motion::MoveKind::feed, move.end));
          },
          [&](const interp::ProbeMove& move) -> Result<void> {
            return queue_line(move.end, options_for(command, motion::MoveKind::feed, move.end));
          },
          [&](const interp::ArcMove& move) -> Result<void> {
            return queue_arc(
                {move.end, move.plane, move.first_centre, move.second_centre, move.turns},
                options_for(command, motion::MoveKind::feed, move.end));
          },
          [](const auto&) -> Result<void> { return {}; },
      },
      command.body);
}

Result<void> JobRunner::queue_line(const Position& end, const motion::MoveOptions& options) {
  const Position start = planner_.queue_end();
  if (auto inside = check_space(motion::extents_of_line(start, end)); !inside) return inside;
  if (guards_tool_change_) {
    if (auto clear = check_tool_change_area(config_.tool_change_area, start, end); !clear)
      return clear;
  }
  return planner_.add_line(end, options);
}

Result<void> JobRunner::queue_arc(const motion::ArcShape& shape,
                                  const motion::MoveOptions& options) {
  const auto arc = motion::make_arc(planner_.queue_end(), shape);
  if (!arc) return std::unexpected(arc.error());
  const auto extents = motion::extents_of_arc(*arc);
  if (auto inside = check_space(extents); !inside) return inside;
  if (guards_tool_change_) {
    if (auto clear = check_tool_change_area(config_.tool_change_area, extents); !clear)
      return clear;
  }
  return planner_.add_arc(shape, options);
}

/// MCAGuard off concerns rendering only: a run never leaves the travel.
Result<void> JobRunner::check_space(const motion::Extents& extents) const {
  if (!guards_machine_ && mode_ != interp::RunMode::run) return {};
  return check_travel(config_, extents);
}

motion::MoveOptions JobRunner::options_for(const interp::Command& command, motion::MoveKind kind,
                                           const Position& end) {
  motion::MoveOptions options;
  options.kind = kind;
  options.feed = feed_for(end);
  options.stop_at_end = path_mode_.mode == interp::PathMode::exact_stop;
  options.laf_angle = path_mode_.laf_angle;
  if (path_mode_.mode == interp::PathMode::continuous) {
    options.tolerance = path_mode_.tolerance.value_or(config_.trajectory.path_tolerance);
  }
  options.simplify = path_mode_.simplification.value_or(0.0);
  options.tag = {++last_move_, command.source.file == 0 ? command.source.line : 0};
  return options;
}

/// Of the spindle where the tool is. The turning axis is at work X = 0.
double JobRunner::turns_per_second() const {
  constexpr double kSecondsPerMinute = 60.0;
  double rpm = spindle_speed_;
  if (surface_speed_) {
    const double radius = std::abs(interpreter_.to_work(planner_.queue_end())[Axis::X]);
    rpm = surface_rpm(*surface_speed_, radius, config_.spindle.max_speed);
  }
  return rpm / kSecondsPerMinute;
}

/// The feed along the path in mm/s. Inverse time: the whole move takes 1/F.
double JobRunner::feed_for(const Position& end) const {
  if (feed_.mode == interp::FeedMode::per_revolution) return feed_.feed * turns_per_second();
  if (feed_.mode == interp::FeedMode::per_minute) return feed_.feed;
  const Position way = end - planner_.queue_end();
  const double length = linear_length(way);
  return feed_.feed * (length > 0.0 ? length : rotary_length(way));
}

}  // namespace cnc::server
