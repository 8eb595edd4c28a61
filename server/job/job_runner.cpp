#include "server/job/job_runner.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>
#include <variant>

#include "server/job/command_roles.h"
#include "server/job/overloaded.h"

namespace cnc::server {

using interp::SpindleDirection;

namespace {

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
                     motion::Planner& planner, Detail detail)
    : config_(config), interpreter_(interpreter), planner_(planner), detail_(detail) {}

void JobRunner::start(std::shared_ptr<const interp::Program> program, const Position& position,
                      SpindleDirection spindle, interp::RunMode mode) {
  abandon();
  planner_.set_position(position);
  program_ = program;
  interpreter_.start(std::move(program), position, {.mode = mode});
  take_modes(interpreter_.modal());
  running_ = true;
  program_over_ = false;
  last_move_ = 0;
  spindle_ = spindle;
  mode_ = mode;
  guards_machine_ = guards_tool_change_ = true;
  thread_move_.reset();
  in_thread_ = false;
}

/// What the program finds in force is not said again.
void JobRunner::take_modes(const interp::ModalState& modal) {
  feed_ = {modal.feed_mode, modal.feed};
  path_mode_ = modal.path;
  spindle_speed_ = modal.speed;
  surface_speed_.reset();
  if (modal.speed_by_surface) surface_speed_ = {modal.surface_speed, modal.max_speed};
}

void JobRunner::abandon() {
  interpreter_.stop();
  planner_.clear();
  planner_.resume();
  running_ = false;
  due_.clear();
  forget_given();
  pending_action_.reset();
  held_ = false;
  drawn_.reset();
  error_.reset();
}

JobRunner::Next JobRunner::next() {
  if (!running_) return error_ ? Next::failed : Next::ended;
  if (!unconfirmed_) fill_planner();
  if (!drawn_) {
    before_drawn_ = planner_.position();
    drawn_ = draw();
  }
  if (item_is_due()) {
    if (std::holds_alternative<JobEvent>(due_.front().what)) return give_note();
    return held_ ? Next::held : give_dwell();
  }
  if (drawn_) {
    setpoint_ = *drawn_;
    drawn_.reset();
    ++number_;
    return Next::setpoint;
  }
  if (unconfirmed_) return Next::busy;
  if (held_) return Next::held;
  if (ought_to_move()) return fail_without_motion();
  if (!planner_.idle() && !more_to_come_) return Next::held;
  if (pending_action_) {
    event_ = *pending_action_;
    return Next::action;
  }
  if (more_to_come_) return Next::busy;
  running_ = false;
  return error_ ? Next::failed : Next::ended;
}

/// There is path enough to be planned, and nothing forbids to drive it.
bool JobRunner::ought_to_move() const {
  const bool is_known = planner_.full() || !more_to_come_;
  return is_known && !planner_.idle() && !planner_.barred();
}

/// A job that would wait without end, and could not say for what.
JobRunner::Next JobRunner::fail_without_motion() {
  const Position& at = planner_.position();
  error_ = Error{ErrorCode::motion_not_found,
                 fmt::format("The job stands at X{:.3f} Y{:.3f} Z{:.3f}, behind move {}, and the "
                             "planner finds no motion for what follows.",
                             at[Axis::X], at[Axis::Y], at[Axis::Z], setpoint_.tag.id),
                 std::nullopt};
  running_ = false;
  return Next::failed;
}

/// Between moves the program may say very much (messages, offsets); bounded per call like lines.
bool JobRunner::notes_are_many() const {
  constexpr std::size_t kMaxNotes = 1000;
  return due_.size() >= kMaxNotes;
}

std::optional<motion::Setpoint> JobRunner::draw() {
  auto drawn = draw(more_to_come_ ? motion::Supply::coming : motion::Supply::ended);
  // Notes so many that nothing is read before they are handed out, which wait for a path that is
  // still open.
  if (!drawn && !held_ && !unconfirmed_ && notes_are_many()) drawn = draw(motion::Supply::ended);
  return drawn;
}

std::optional<motion::Setpoint> JobRunner::draw(motion::Supply supply) {
  if (detail_ == Detail::whole) return planner_.next(supply);
  const auto stretch = planner_.skip(supply);
  if (!stretch) return std::nullopt;
  motion::Setpoint setpoint;
  setpoint.duration = stretch->duration;
  setpoint.tag = stretch->tag;
  return setpoint;
}

void JobRunner::action_done(const std::optional<interp::Answer>& answer) {
  const interp::CommandBody& done = pending_action_->command.body;
  if (const auto* turn = std::get_if<interp::TurnSpindle>(&done)) {
    const bool starts = turn->direction != spindle_ && turn->direction != SpindleDirection::off;
    if (starts && config_.spindle.ramp_up_time > 0.0)
      due_.push_back({last_move_, config_.spindle.ramp_up_time});
    spindle_ = turn->direction;
  }
  if (std::holds_alternative<interp::ChangeTool>(done)) spindle_ = SpindleDirection::off;
  if (std::holds_alternative<interp::SyncMove>(done)) begins_at_index_ = true;
  pending_action_.reset();
  forget_given();
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

bool JobRunner::item_is_due() const {
  if (due_.empty()) return false;
  return drawn_ ? due_.front().after_move < drawn_->tag.id : planner_.idle();
}

JobRunner::Next JobRunner::give_note() {
  event_ = std::get<JobEvent>(due_.front().what);
  if (planner_.keeps_setpoints()) given_.push_back({number_, std::move(due_.front())});
  due_.pop_front();
  return Next::note;
}

/// A dwell is motion that goes nowhere: it then takes exactly its time on the board's clock.
JobRunner::Next JobRunner::give_dwell() {
  const double slice = config_.trajectory.interpolation_time;
  const std::uint64_t after_move = due_.front().after_move;
  double& left = std::get<double>(due_.front().what);
  setpoint_ = {};
  // A rest too short for a setpoint of its own is spent at once.
  setpoint_.duration = left < 1.5 * slice ? left : slice;
  setpoint_.position = drawn_ ? before_drawn_ : planner_.position();
  setpoint_.tag = {after_move, 0};
  ++number_;
  if (planner_.keeps_setpoints()) given_.push_back({number_, {after_move, setpoint_.duration}});
  left -= setpoint_.duration;
  if (left <= 0.0) due_.pop_front();
  return Next::setpoint;
}

/// Nothing behind a dwell is read before it has been handed out.
bool JobRunner::waits_for_dwell() const {
  return std::ranges::any_of(due_, [&](const DueItem& item) {
    return item.after_move == last_move_ && std::holds_alternative<double>(item.what);
  });
}

// --- what is taken back --------------------------------------------------------------------------

/// Setpoints behind `number` that are none of the planner's.
std::size_t JobRunner::dwells_behind(std::uint64_t number) const {
  return static_cast<std::size_t>(std::ranges::count_if(given_, [&](const GivenItem& given) {
    return given.number > number && std::holds_alternative<double>(given.item.what);
  }));
}

void JobRunner::forget_all_but(std::size_t count) {
  if (unconfirmed_) return;
  const std::uint64_t first = number_ - std::min<std::uint64_t>(count, number_);
  while (!given_.empty() && given_.front().number <= first) given_.pop_front();
  planner_.forget_all_but(count - std::min(count, dwells_behind(first)) + (drawn_ ? 1 : 0));
}

bool JobRunner::take_back(std::size_t count) {
  if (count > number_) return false;
  const std::uint64_t last = number_ - count;
  const std::size_t dwells = dwells_behind(last);
  if (dwells > count || !planner_.take_back(count - dwells + (drawn_ ? 1 : 0))) return false;
  taken_back_ = {number_, last, due_, {}, std::exchange(drawn_, std::nullopt)};
  while (!given_.empty() && given_.back().number > last) {
    due_.push_front(given_.back().item);
    taken_back_.given.push_front(std::move(given_.back()));
    given_.pop_back();
  }
  number_ = last;
  running_ = unconfirmed_ = true;
  return true;
}

void JobRunner::forget_given() {
  given_.clear();
  taken_back_ = {};
  unconfirmed_ = false;
}

void JobRunner::confirm_take_back() {
  planner_.confirm_take_back();
  taken_back_ = {};
  unconfirmed_ = false;
}

void JobRunner::revoke_take_back() {
  if (!unconfirmed_) return;
  planner_.revoke_take_back();
  unconfirmed_ = false;
  due_ = std::move(taken_back_.due);
  drawn_ = taken_back_.drawn;
  while (!given_.empty() && given_.back().number > taken_back_.last) given_.pop_back();
  for (GivenItem& item : taken_back_.given) given_.push_back(std::move(item));
  number_ = taken_back_.number;
  taken_back_ = {};
}

// --- reading the program -------------------------------------------------------------------------

/// Pulls commands until the planner has enough, or one of them has to wait for standstill.
void JobRunner::fill_planner() {
  more_to_come_ = false;
  while (!program_over_ && !pending_action_ && !waits_for_dwell() && !planner_.full()) {
    if (notes_are_many()) {
      more_to_come_ = true;
      return;
    }
    switch (interpreter_.next()) {
      case interp::Progress::command:
        take(interpreter_.command());
        break;
      case interp::Progress::working:
        more_to_come_ = true;
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
      // G4 P0 waits until every move before it is done.
      if (const double time = std::get<interp::Dwell>(command.body).duration; time > 0.0) {
        due_.push_back({last_move_, time});
      } else {
        pending_action_ = event_of(command);
      }
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
      due_.push_back({last_move_, event_of(command)});
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

void JobRunner::fail_with(Error error, interp::SourceLine source) {
  if (!error.place) {
    error.place = TextPlace{std::string(interpreter_.file_name(source.file)), source.line, 0};
  }
  error_ = std::move(error);
  program_over_ = true;
}

}  // namespace cnc::server
