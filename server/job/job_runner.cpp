#include "server/job/job_runner.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <variant>

#include "server/job/surface_speed.h"
#include "server/job/travel_limits.h"

namespace cnc::server {

using interp::SpindleDirection;

namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

/// What a command asks of the runner.
enum class Role { motion, dwell, feed, path_mode, guard, note, action, unsupported };

Role role_of(const interp::CommandBody& body) {
  return std::visit(Overloaded{
                        [](const interp::RapidMove&) { return Role::motion; },
                        [](const interp::FeedMove&) { return Role::motion; },
                        [](const interp::ArcMove&) { return Role::motion; },
                        [](const interp::Dwell&) { return Role::dwell; },
                        [](const interp::SetFeedRate&) { return Role::feed; },
                        [](const interp::SetPathMode&) { return Role::path_mode; },
                        [](const interp::SelectPlane&) { return Role::note; },
                        [](const interp::UseLengthUnit&) { return Role::note; },
                        [](const interp::SetWorkOffset&) { return Role::note; },
                        [](const interp::SetG92Offset&) { return Role::note; },
                        [](const interp::UseToolLength&) { return Role::note; },
                        [](const interp::SelectTool&) { return Role::note; },
                        [](const interp::EnableOverrides&) { return Role::note; },
                        [](const interp::Message&) { return Role::note; },
                        [](const interp::SetSpindleSpeed&) { return Role::note; },
                        [](const interp::UseSurfaceSpeed&) { return Role::note; },
                        [](const interp::OpenLogFile&) { return Role::note; },
                        [](const interp::StorePosition&) { return Role::note; },
                        [](const interp::SetOverride&) { return Role::note; },
                        [](const interp::SelectHead&) { return Role::note; },
                        [](const interp::UseHomeSensorsAsEstop&) { return Role::note; },
                        [](const interp::SetGuard&) { return Role::guard; },
                        [](const interp::ClampAxis&) { return Role::action; },
                        [](const interp::StoreHeadOffset&) { return Role::action; },
                        [](const interp::ProbeMove&) { return Role::action; },
                        [](const interp::SyncMove&) { return Role::motion; },
                        [](const interp::AskOperator&) { return Role::action; },
                        [](const interp::HomeAxis&) { return Role::action; },
                        [](const interp::ChangeHeightMap&) { return Role::action; },
                        [](const interp::Synchronise&) { return Role::action; },
                        [](const interp::EnableDrives&) { return Role::action; },
                        [](const interp::SetOutput&) { return Role::action; },
                        [](const interp::SetAnalogOutput&) { return Role::action; },
                        [](const interp::SetSpindleOutput&) { return Role::action; },
                        [](const interp::ReadInput&) { return Role::action; },
                        [](const interp::SetCoolant&) { return Role::note; },
                        [](const interp::TurnSpindle&) { return Role::action; },
                        [](const interp::ChangeTool&) { return Role::action; },
                        [](const interp::ProgramStop&) { return Role::action; },
                        [](const interp::ProgramEnd&) { return Role::action; },
                        [](const auto&) { return Role::unsupported; },
                    },
                    body);
}

JobEvent event_of(const interp::Command& command) {
  JobEvent event{command, {}};
  std::visit(Overloaded{
                 [&](const interp::Message& message) { event.text = message.text; },
                 [&](const interp::OpenLogFile& open) { event.text = open.name; },
                 [&](const interp::StorePosition& store) { event.text = store.name; },
                 [&](const interp::ChangeHeightMap& change) { event.text = change.name; },
                 [](const auto&) {},
             },
             command.body);
  return event;
}

}  // namespace

JobRunner::JobRunner(const config::MachineConfig& config, interp::Interpreter& interpreter,
                     motion::Planner& planner)
    : config_(config), interpreter_(interpreter), planner_(planner) {}

void JobRunner::start(std::shared_ptr<const interp::Program> program, const Position& position,
                      SpindleDirection spindle, interp::RunMode mode) {
  abandon();
  planner_.set_position(position);
  program_ = program;
  interpreter_.start(std::move(program), position, {.mode = mode});
  running_ = true;
  program_over_ = false;
  last_move_ = 0;
  spindle_ = spindle;
  mode_ = mode;
  guards_machine_ = guards_tool_change_ = true;
  thread_move_.reset();
  in_thread_ = false;
}

void JobRunner::abandon() {
  interpreter_.stop();
  planner_.clear();
  planner_.resume();
  running_ = false;
  notes_.clear();
  pending_action_.reset();
  held_ = false;
  dwell_left_ = 0.0;
  drawn_.reset();
  error_.reset();
}

JobRunner::Next JobRunner::next() {
  if (!running_) return error_ ? Next::failed : Next::ended;
  fill_planner();
  if (!drawn_) drawn_ = planner_.next();

  if (note_is_due(drawn_.has_value(), drawn_ ? drawn_->tag.id : 0)) {
    event_ = std::move(notes_.front().event);
    notes_.pop_front();
    return Next::note;
  }
  if (drawn_) {
    setpoint_ = *drawn_;
    drawn_.reset();
    return Next::setpoint;
  }
  if (held_ || !planner_.idle()) return Next::held;
  if (dwell_left_ > 0.0) {
    take_dwell(config_.trajectory.interpolation_time);
    return Next::setpoint;
  }
  if (pending_action_) {
    event_ = *pending_action_;
    return Next::action;
  }
  if (interpreter_busy_) return Next::busy;
  running_ = false;
  return error_ ? Next::failed : Next::ended;
}

void JobRunner::action_done(const std::optional<interp::Answer>& answer) {
  const interp::CommandBody& done = pending_action_->command.body;
  if (const auto* turn = std::get_if<interp::TurnSpindle>(&done)) {
    const bool starts = turn->direction != spindle_ && turn->direction != SpindleDirection::off;
    if (starts) dwell_left_ = config_.spindle.ramp_up_time;
    spindle_ = turn->direction;
  }
  if (std::holds_alternative<interp::ChangeTool>(done)) spindle_ = SpindleDirection::off;
  if (std::holds_alternative<interp::SyncMove>(done)) begins_at_index_ = true;
  pending_action_.reset();
  if (!answer) return;
  interpreter_.answer(*answer);
  planner_.set_position(answer->position);
}

void JobRunner::hold() {
  held_ = true;
  planner_.hold();
}

void JobRunner::resume() {
  held_ = false;
  planner_.resume();
}

bool JobRunner::note_is_due(bool has_setpoint, std::uint64_t move) const {
  if (notes_.empty()) return false;
  return has_setpoint ? notes_.front().after_move < move : planner_.idle();
}

/// Pulls commands until the planner has enough, or one of them has to wait for standstill.
void JobRunner::fill_planner() {
  // Between moves the program may say very much (messages, offsets); bounded per call like lines.
  constexpr std::size_t kMaxNotes = 1000;
  interpreter_busy_ = false;
  while (!program_over_ && !pending_action_ && dwell_left_ == 0.0 && !planner_.full()) {
    if (notes_.size() >= kMaxNotes) return;
    switch (interpreter_.next()) {
      case interp::Progress::command:
        take(interpreter_.command());
        break;
      case interp::Progress::working:
        interpreter_busy_ = true;
        return;
      case interp::Progress::waiting:
      case interp::Progress::found:
        return;  // the action is pending; nobody searches here
      case interp::Progress::failed:
        queue_thread(false);
        error_ = interpreter_.diagnostic().to_error();
        program_over_ = true;
        break;
      case interp::Progress::ended:
        program_over_ = true;
        break;
    }
  }
}

/// Whoever only renders a program lets a probe move run to its end.
bool JobRunner::is_motion(const interp::CommandBody& body) const {
  return mode_ != interp::RunMode::run && std::holds_alternative<interp::ProbeMove>(body);
}

void JobRunner::take(const interp::Command& command) {
  if (std::holds_alternative<interp::SyncMove>(command.body)) return take_sync_move(command);
  queue_thread(false);
  if (const auto* speed = std::get_if<interp::SetSpindleSpeed>(&command.body)) {
    spindle_speed_ = speed->speed;
    surface_speed_.reset();
  }
  if (const auto* surface = std::get_if<interp::UseSurfaceSpeed>(&command.body))
    surface_speed_ = *surface;
  switch (is_motion(command.body) ? Role::motion : role_of(command.body)) {
    case Role::motion:
      if (auto queued = queue_motion(command); !queued)
        fail_with(std::move(queued.error()), command.source);
      break;
    case Role::dwell:
      dwell_left_ = std::get<interp::Dwell>(command.body).duration;
      // G4 P0 waits until every move before it is done.
      if (dwell_left_ == 0.0) pending_action_ = event_of(command);
      break;
    case Role::feed:
      feed_ = std::get<interp::SetFeedRate>(command.body);
      break;
    case Role::path_mode:
      path_mode_ = std::get<interp::SetPathMode>(command.body);
      break;
    case Role::guard: {
      const auto& set = std::get<interp::SetGuard>(command.body);
      (set.guard == interp::Guard::machine_area ? guards_machine_ : guards_tool_change_) = set.on;
      break;
    }
    case Role::note:
      notes_.push_back({last_move_, event_of(command)});
      break;
    case Role::action:
      pending_action_ = event_of(command);
      break;
    case Role::unsupported:
      fail_with(
          {ErrorCode::not_on_this_machine,
           fmt::format("This machine cannot execute {}.", interp::text_of(command)), std::nullopt},
          command.source);
      break;
  }
}

/// The first move of a thread begins at rest, at the spindle's index and with its measured speed:
/// it becomes an action first. Those behind it belong to the same thread.
void JobRunner::take_sync_move(const interp::Command& command) {
  queue_thread(true);
  if (error_) return;
  thread_move_ = command;
  if (std::exchange(in_thread_, true) || mode_ != interp::RunMode::run) return;
  pending_action_ = event_of(command);
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

void JobRunner::fail_with(Error error, interp::SourceLine source) {
  if (!error.place) {
    error.place = TextPlace{std::string(interpreter_.file_name(source.file)), source.line, 0};
  }
  error_ = std::move(error);
  program_over_ = true;
}

/// A dwell is motion that goes nowhere: it then takes exactly its time on the board's clock.
void JobRunner::take_dwell(double slice) {
  setpoint_ = {};
  setpoint_.duration = std::min(slice, dwell_left_);
  // A rest too short for a setpoint of its own is spent at once.
  if (dwell_left_ - setpoint_.duration < 0.5 * slice) setpoint_.duration = dwell_left_;
  setpoint_.position = planner_.position();
  setpoint_.tag = {last_move_, 0};
  dwell_left_ -= setpoint_.duration;
}

}  // namespace cnc::server
