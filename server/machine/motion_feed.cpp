#include "server/machine/motion_feed.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include "server/job/settings.h"

namespace cnc::server {
namespace {

/// Room kept in the link for commands: outputs, latches, faults to clear.
constexpr std::size_t kReserve = 64;

/// The travel of the limited axes; infinite for the others.
motion::Extents travel_of(const config::MachineConfig& config, const AxisArray<bool>& limited) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  motion::Extents travel{Position::filled(-kInfinite), Position::filled(kInfinite)};
  for (const Axis axis : kAllAxes) {
    if (!limited[axis] || !config.axes[axis].connected()) continue;
    travel.min[axis] = config.axes[axis].negative_limit;
    travel.max[axis] = config.axes[axis].positive_limit;
  }
  return travel;
}

}  // namespace

MotionFeed::MotionFeed(Link& link, const config::MachineConfig& config)
    : link_(link),
      config_(config),
      check_(axis_limits(config), travel_of(config, {}), Position{}) {}

void MotionFeed::update() {
  status_ = link_.status();
  if (position_unknown_ && !status_.board.moving && status_.items_done == link_.pushed())
    accept_board_position();
}

bool MotionFeed::wants_more(double lead) const {
  return sent(last_id_).end_time - executed_time() < lead && link_.space() > kReserve;
}

void MotionFeed::begin_motion(const AxisArray<bool>& limited) {
  check_ = motion::SetpointCheck(axis_limits(config_), travel_of(config_, limited), commanded_);
}

Result<void> MotionFeed::emit(const motion::Setpoint& setpoint) {
  if (auto checked = check_.check(setpoint); !checked) return checked;
  const Sent& before = sent(last_id_);
  Sent next{last_id_ + 1,      before.end_time + setpoint.duration,
            setpoint.duration, before.end_velocity,
            setpoint.velocity, {},
            setpoint.tag,      setpoint.feed_limit};
  for (const Axis axis : kAllAxes)
    next.moves[axis] = setpoint.position[axis] != commanded_[axis] ||
                       next.start_velocity[axis] != 0.0 || next.end_velocity[axis] != 0.0;
  const motion::MoveTag& tag = setpoint.tag;
  const hal::Segment segment{.id = next.id,
                             .duration = setpoint.duration,
                             .position = setpoint.position,
                             .velocity = setpoint.velocity,
                             .wait_for_index = tag.begins_at_index && tag.id != before.tag.id,
                             .spindle_speed = tag.spindle_speed};
  if (!link_.push(segment))
    return fail(ErrorCode::internal_error, "The link's queue is full; wants_more() was not asked.");
  history_[next.id % kHistory] = next;
  last_id_ = next.id;
  commanded_ = setpoint.position;
  if (listener_) listener_(setpoint);
  return {};
}

double MotionFeed::executed_time() const {
  const std::uint32_t id = status_.board.executing_id;
  const Sent& entry = sent(id);
  if (id == 0 || entry.id != id) return 0.0;
  return entry.end_time - (1.0 - status_.board.executing_phase) * entry.duration;
}

bool MotionFeed::executed(std::uint32_t id) const {
  if (id <= void_id_) return true;
  const hal::ControllerStatus& board = status_.board;
  return board.executing_id > id || (board.executing_id == id && board.executing_phase >= 1.0);
}

bool MotionFeed::at_rest() const {
  return status_.items_done == link_.pushed() && !status_.board.moving &&
         status_.board.fifo_count == 0 && !position_unknown_;
}

Executing MotionFeed::executing() const {
  const hal::ControllerStatus& board = status_.board;
  const Sent& entry = sent(board.executing_id);
  if (board.executing_id == 0 || entry.id != board.executing_id || !board.moving) return {};
  const Position change = entry.end_velocity - entry.start_velocity;
  return {entry.tag, entry.feed_limit, entry.start_velocity + change * board.executing_phase};
}

AxisArray<bool> MotionFeed::axes_in_motion() const {
  const hal::ControllerStatus& board = status_.board;
  const Sent& entry = sent(board.executing_id);
  if (board.executing_id == 0 || entry.id != board.executing_id) return {};
  if (board.executing_phase < 1.0) return entry.moves;
  AxisArray<bool> still_moving;
  for (const Axis axis : kAllAxes) still_moving[axis] = entry.end_velocity[axis] != 0.0;
  return still_moving;
}

void MotionFeed::quick_stop() {
  link_.quick_stop();
  position_unknown_ = true;
}

void MotionFeed::accept_board_position() {
  commanded_ = status_.board.position;
  check_.restart(commanded_);
  if (restart_listener_) restart_listener_(commanded_);
  // What was under way and did not come to its end is over now; the next segment starts at rest.
  Sent& executing = history_[status_.board.executing_id % kHistory];
  if (executing.id == status_.board.executing_id) {
    executing.moves = {};
    executing.end_velocity = {};
  }
  Sent& last = history_[last_id_ % kHistory];
  last.end_velocity = {};
  last.end_time = executed_time();
  void_id_ = last_id_;
  position_unknown_ = false;
}

void MotionFeed::set_position(Axis axis, double position) {
  SetPosition item;
  item.axes[axis] = true;
  item.position[axis] = position;
  link_.push(item);
  commanded_[axis] = position;
  check_.restart(commanded_);
  if (restart_listener_) restart_listener_(commanded_);
}

}  // namespace cnc::server
