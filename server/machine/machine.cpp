// The machine as an object: what it is made of, who may ask what, who waits for what, and how it
// comes to rest. Commands are in machine_commands.cpp, the cycle in machine_cycle.cpp,
// the board in machine_board.cpp.
#include "server/machine/machine.h"

#include <algorithm>
#include <utility>

#include "config/ini_file.h"
#include "server/job/settings.h"

namespace cnc::server {
namespace {

/// Spindle 0 has none: the others' offsets count from it.
config::HeadOffset config::MachineConfig::*setting_of(interp::Head head) {
  switch (head) {
    case interp::Head::spindle_0:
      return nullptr;
    case interp::Head::spindle_1:
      return &config::MachineConfig::spindle_1;
    case interp::Head::spindle_2:
      return &config::MachineConfig::spindle_2;
    case interp::Head::probe:
      return &config::MachineConfig::probe;
    case interp::Head::camera:
      return &config::MachineConfig::camera;
  }
  return nullptr;
}

/// Those that a program can move; slaves follow their masters in this too.
AxisArray<bool> programmable_axes(const config::MachineConfig& config) {
  AxisArray<bool> axes;
  for (const Axis axis : kAllAxes) axes[axis] = config.axes[axis].programmable();
  return axes;
}

}  // namespace

Machine::Machine(MachineData data, Link& link, MessageLog& log)
    : data_(std::move(data)),
      log_(log),
      feed_(link, data_.config, data_.clock),
      io_(data_.config, feed_),
      files_(data_.program_folder, log),
      interpreter_(interpreter_settings(data_.config), data_.parameters, data_.tools),
      job_(data_.config, interpreter_, data_.parameters, feed_, io_, files_, log_),
      homing_(data_.config, feed_),
      jog_(data_.config, feed_),
      saver_({data_.parameter_file, data_.tool_file}, log_),
      trust_(programmable_axes(data_.config)) {
  if (!data_.macros.empty()) use_macros(data_.macros);
  load_macros();
  job_.set_head_keeper([this](const interp::StoreHeadOffset& store) { return keep_head(store); });
}

Machine::~Machine() {
  const auto stopped = fail(ErrorCode::server_stopping, "The server is shutting down.");
  for (Waiter& waiter : std::exchange(waiters_, {})) waiter.done(stopped);
  for (auto& [ticket, done] : std::exchange(waiting_for_disk_, {})) done(stopped);
}

Result<void> Machine::allow(CommandKind command) const {
  if (shutting_down_) return fail(ErrorCode::server_stopping, "The server is shutting down.");
  if (reset_wanted_ && command != CommandKind::set_override)
    return fail(ErrorCode::command_not_allowed, "The machine is being reset: wait for its end.");
  if (auto reason = refusal(command, state_))
    return fail(ErrorCode::command_not_allowed, std::move(*reason));
  return {};
}

void Machine::wait_for(WaitFor what, Completion done) {
  waiters_.push_back({what, std::move(done)});
}

/// A completion may call the machine again: waiters are taken out before any of them is called.
std::vector<Completion> Machine::take_waiters(WaitFor what) {
  std::vector<Completion> taken;
  std::erase_if(waiters_, [&](Waiter& waiter) {
    if (waiter.what != what) return false;
    taken.push_back(std::move(waiter.done));
    return true;
  });
  return taken;
}

void Machine::settle(WaitFor what, const Result<void>& result) {
  for (Completion& completion : take_waiters(what)) completion(result);
}

void Machine::settle_when_saved(WaitFor what, const Result<void>& result) {
  if (!result) return settle(what, result);
  for (Completion& completion : take_waiters(what)) when_saved(std::move(completion));
}

void Machine::when_saved(Completion done) {
  waiting_for_disk_.emplace_back(saver_.save(data_.parameters, data_.tools), std::move(done));
}

void Machine::answer_saved() {
  while (!waiting_for_disk_.empty()) {
    const auto outcome = saver_.outcome(waiting_for_disk_.front().first);
    if (!outcome) return;
    const Completion done = std::move(waiting_for_disk_.front().second);
    waiting_for_disk_.erase(waiting_for_disk_.begin());
    done(*outcome);
  }
}

/// Into the machine's configuration and its file; only this, not what the command line has changed.
Result<void> Machine::keep_head(const interp::StoreHeadOffset& store) {
  const auto member = setting_of(store.head);
  if (member == nullptr) return {};
  const config::HeadOffset offset{store.offset[Axis::X], store.offset[Axis::Y],
                                  store.offset[Axis::Z]};
  data_.config.*member = offset;
  if (data_.config_file.empty()) return {};
  auto on_disk = config::load_machine_config(data_.config_file);
  if (!on_disk) return std::unexpected(on_disk.error().front());
  (*on_disk).*member = offset;
  if (auto saved = config::save_machine_config(data_.config_file, *on_disk); !saved)
    return std::unexpected(saved.error().front());
  return {};
}

/// Check and prediction depend on modes, offsets, tools and where the machine stands: they begin
/// anew when one of these has changed.
void Machine::analyse() {
  findings_.reset();
  analysis_.reset();
  if (program_ && data_.analyse_jobs)
    analysis_ = std::make_unique<JobAnalysis>(
        PredictionInput{data_.config, program_, data_.parameters, data_.tools, feed_.commanded(),
                        macros_, interpreter_.state()});
}

void Machine::shut_down() {
  shutting_down_ = true;
  begin_stop();
  save_parameters();
}

bool Machine::is_shut_down() const {
  if (!shutting_down_ || !is_motionless()) return false;
  return state_ == State::off ||
         (feed_.at_rest() && io_.spindle() == interp::SpindleDirection::off);
}

bool Machine::is_motionless() const {
  return !job_.active() && !homing_.active() && !jog_.active() && !feed_.stopping();
}

/// Slows down whatever moves; come_to_rest() follows when it stands.
void Machine::begin_stop() {
  jog_.stop();
  homing_.stop();
  switch (state_) {
    case State::running:
    case State::mdi:
    case State::pausing:
      job_.hold();
      enter(State::stopping);
      break;
    case State::paused:
    case State::program_stop:
    case State::tool_change:
    case State::question:
      end_job(fail(ErrorCode::command_interrupted, "The job was stopped."));
      break;
    case State::jogging:
      if (job_.active()) enter(State::stopping);  // the job ends when the jog has
      break;
    default:
      break;
  }
}

State Machine::resting_state() const {
  if (job_.active()) return waiting_state_;  // jogged while the program waits
  if (!feed_.board().connected) return State::off;
  if (!io_.outputs().drives_enabled) return State::needs_reset;
  if (data_.config.safety.homing_mandatory && !trust_.all_trusted()) return State::needs_homing;
  return State::ready;
}

std::shared_ptr<const JobFindings> Machine::findings() const { return findings_; }

}  // namespace cnc::server
