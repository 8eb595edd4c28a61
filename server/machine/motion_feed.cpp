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
  Sent next{.id = newest_id_ + 1,
            .before = before.id,
            .ordinal = before.ordinal + 1,
            .end_time = before.end_time + setpoint.duration,
            .duration = setpoint.duration,
            .end = setpoint.position,
            .start_velocity = before.end_velocity,
            .end_velocity = setpoint.velocity,
            .tag = setpoint.tag,
            .feed_limit = setpoint.feed_limit};
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
  last_id_ = newest_id_ = next.id;
  commanded_ = setpoint.position;
  if (listener_) listener_(setpoint);
  return {};
}

std::size_t MotionFeed::under_way() const {
  const std::uint64_t last = sent(last_id_).ordinal;
  const Sent& executing = sent(status_.board.executing_id);
  const bool known = executing.id == status_.board.executing_id && executing.ordinal <= last;
  return known ? static_cast<std::size_t>(last - executing.ordinal) : 0;
}

/// Two exchanges lie between a status and the board's taking what was decided on it, at the most:
/// the one under way, and the next. And threads do not wake up to the microsecond.
std::size_t MotionFeed::replaceable() {
  constexpr double kLatest = 0.001;
  status_ = link_.status();
  const double reached = executed_time() + patience_ * (2.0 * status_.interval + kLatest);
  std::size_t count = under_way();
  std::size_t in_time = 0;
  for (const Sent* last = &sent(last_id_); count > 0; --count, last = &sent(last->before)) {
    if (last->tag.spindle_speed != 0.0) return 0;
    if (sent(last->before).end_time >= reached) ++in_time;
  }
  return in_time;
}

void MotionFeed::begin_cut(std::size_t count) {
  std::uint32_t id = last_id_;
  for (std::size_t i = 0; i < count; ++i) id = sent(id).before;
  link_.begin_cut(id);
  cut_ = {link_.pushed(), id, last_id_, CutAnswer::pending};
  go_on_behind(id);
  if (cut_listener_) cut_listener_(count);
}

CutAnswer MotionFeed::cut_answer() {
  if (cut_.answer != CutAnswer::pending || status_.items_done < cut_.item) return cut_.answer;
  const bool late = status_.board.cut_late;
  cut_.answer = late ? CutAnswer::late : CutAnswer::taken;
  constexpr double kMostPatience = 16.0;
  patience_ = late ? std::min(2.0 * patience_, kMostPatience) : 1.0;
  if (late) revoke_cut();
  return cut_.answer;
}

/// The board goes on with what it had.
void MotionFeed::revoke_cut() {
  if (cut_listener_) {
    cut_listener_(static_cast<std::size_t>(sent(last_id_).ordinal - sent(cut_.kept_id).ordinal));
    std::vector<const Sent*> again;
    for (std::uint32_t id = cut_.last_id; id != cut_.kept_id; id = sent(id).before)
      again.push_back(&sent(id));
    for (auto it = again.rbegin(); listener_ && it != again.rend(); ++it)
      listener_({(*it)->duration, (*it)->end, (*it)->end_velocity, (*it)->feed_limit, (*it)->tag});
  }
  go_on_behind(cut_.last_id);
}

void MotionFeed::go_on_behind(std::uint32_t id) {
  last_id_ = id;
  commanded_ = sent(id).end;
  check_.restart(commanded_, sent(id).end_velocity);
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
         status_.board.fifo_count == 0 && !position_unknown_ && cut_.answer != CutAnswer::pending &&
         cut_.answer != CutAnswer::late;
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
  cut_ = {};
  position_unknown_ = true;
}

void MotionFeed::accept_board_position() {
  commanded_ = status_.board.position;
  cut_ = {};
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
  last.end = commanded_;
  last.ordinal = executing.ordinal;  // nothing is under way
  void_id_ = newest_id_;
  position_unknown_ = false;
}

void MotionFeed::set_position(Axis axis, double position) {
  SetPosition item;
  item.axes[axis] = true;
  item.position[axis] = position;
  link_.push(item);
  commanded_[axis] = position;
  history_[last_id_ % kHistory].end = commanded_;
  check_.restart(commanded_);
  if (restart_listener_) restart_listener_(commanded_);
}

}  // namespace cnc::server
