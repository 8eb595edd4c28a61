// Commands: what is asked of the machine, and whether it is allowed now.
#include "server/machine/machine.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "config/ini_file.h"
#include "server/job/settings.h"

namespace cnc::server {
namespace {

Result<void> check_factor(std::string_view name, double value, double highest) {
  if (value >= 0.0 && value <= highest) return {};
  return fail(ErrorCode::value_out_of_range,
              fmt::format("The {} override is {} %; it can be 0 to {} %.", name, 100.0 * value,
                          100.0 * highest));
}

}  // namespace

Machine::Machine(MachineData data, Link& link, MessageLog& log)
    : data_(std::move(data)),
      log_(log),
      feed_(link, data_.config),
      io_(data_.config, feed_),
      files_(data_.program_folder, log),
      interpreter_(interpreter_settings(data_.config), data_.parameters, data_.tools),
      job_(data_.config, interpreter_, data_.parameters, feed_, io_, files_, log_),
      homing_(data_.config, feed_),
      jog_(data_.config, feed_),
      saver_({data_.parameter_file, data_.tool_file}, log_) {
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

void Machine::reset(Completion done) {
  if (auto allowed = allow(CommandKind::reset); !allowed) return done(allowed);
  wait_for(WaitFor::reset, std::move(done));
  reset_wanted_ = true;
  begin_stop();
  reset_deadline_ = 0.0;  // counts from when the machine stands
}

void Machine::home(std::vector<Axis> axes, Completion done) {
  if (auto allowed = allow(CommandKind::home); !allowed) return done(allowed);
  const bool all = axes.empty();
  if (all) axes = Homing::default_order(data_.config);
  for (const Axis axis : axes)
    if (!data_.config.axes[axis].connected())
      return done(
          fail(ErrorCode::axis_not_connected,
               fmt::format("Axis {} is not connected; it cannot be homed.", axis_name(axis))));
  wait_for(WaitFor::home, std::move(done));
  load_macros();
  if (auto text = homing_subs(axes, all)) return run_text(std::move(*text), "homing");
  for (const Axis axis : axes) homed_[axis] = false;
  homing_.start(std::move(axes));
  enter(State::homing);
}

/// Homing as the macro files have it (HOM-3); nothing when they lack a sub for one of the axes.
std::optional<std::string> Machine::homing_subs(const std::vector<Axis>& axes, bool all) const {
  if (all && has_sub("home_all")) return "gosub home_all";
  std::string text;
  for (const Axis axis : axes) {
    const std::string sub = fmt::format("home_{}", axis_name(axis));
    if (!has_sub(sub)) return std::nullopt;
    text += fmt::format("gosub {}\n", sub);
  }
  return text;
}

void Machine::mdi(const std::string& line, Completion done) {
  if (auto allowed = allow(CommandKind::mdi); !allowed) return done(allowed);
  if (line.empty()) return done(fail(ErrorCode::program_empty, "The line is empty."));
  wait_for(WaitFor::mdi, std::move(done));
  load_macros();
  run_text(line, "single line");
}

void Machine::run_sub(std::string_view name, Completion done) {
  const CommandKind kind = name.starts_with("home_") ? CommandKind::home : CommandKind::mdi;
  if (auto allowed = allow(kind); !allowed) return done(allowed);
  load_macros();
  if (!has_sub(name)) {
    return done(
        fail(ErrorCode::sub_unknown, fmt::format("There is no sub {} in the macro files.", name)));
  }
  wait_for(WaitFor::mdi, std::move(done));
  run_text(fmt::format("gosub {}", name), std::string(name));
}

/// `text` is not empty.
void Machine::run_text(std::string text, std::string name) {
  single_line_ = true;
  job_.start(interp::Program::from_text(std::move(text), std::move(name)).value(),
             JobControl::Kind::single_line);
  enter(State::mdi);
}

Result<void> Machine::answer(std::uint64_t question, bool confirmed, std::vector<double> values) {
  if (auto allowed = allow(CommandKind::answer); !allowed) return allowed;
  const interp::Dialog* dialog = job_.question();
  if (question != question_ || dialog == nullptr) {
    return fail(ErrorCode::no_question,
                "This question is not asked any more: look at the status for the present one.");
  }
  if (!values.empty() && values.size() != dialog->fields.size()) {
    return fail(ErrorCode::value_out_of_range,
                fmt::format("The question has {} fields; the answer has {} values.",
                            dialog->fields.size(), values.size()));
  }
  for (const double value : values)
    if (!std::isfinite(value))
      return fail(ErrorCode::value_out_of_range, "A value of the answer is not a number.");
  if (auto refused = job_.refusal_of_answer(confirmed, values)) return std::unexpected(*refused);
  job_.answer_question(confirmed, std::move(values));
  enter(working_state());
  return {};
}

/// Reads the macro files again if one of them has changed. One that cannot be read is told, and
/// what was loaded before stays.
void Machine::load_macros() {
  std::vector<std::filesystem::file_time_type> times;
  for (const auto& path : data_.macro_files) {
    std::error_code missing;
    times.push_back(std::filesystem::last_write_time(path, missing));
  }
  if (times == macro_times_) return;
  macro_times_ = std::move(times);
  interp::Library macros;
  for (const auto& path : data_.macro_files) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    auto program = interp::Program::open(path);
    if (!program) return log_.add(program.error());
    macros.push_back(std::move(*program));
  }
  use_macros(std::move(macros));
}

void Machine::use_macros(interp::Library macros) {
  macros_ = std::move(macros);
  interpreter_.set_library(macros_);
  const auto& warnings = interpreter_.library_warnings();
  if (warnings.empty()) return;
  log_.add(Severity::warning, fmt::format("{} remarks on the macro files, first: {}",
                                          warnings.size(), warnings[0].to_error().to_string()));
}

/// Into the machine's configuration and its file; only this, not what the command line has changed.
Result<void> Machine::keep_head(const interp::StoreHeadOffset& store) {
  const auto put = [&](config::MachineConfig& config) {
    const config::HeadOffset offset{store.offset[Axis::X], store.offset[Axis::Y],
                                    store.offset[Axis::Z]};
    switch (store.head) {
      case interp::Head::spindle_1:
        config.spindle_1 = offset;
        break;
      case interp::Head::spindle_2:
        config.spindle_2 = offset;
        break;
      case interp::Head::probe:
        config.probe = offset;
        break;
      case interp::Head::camera:
        config.camera = offset;
        break;
      case interp::Head::spindle_0:
        break;  // the one that offsets count from
    }
  };
  put(data_.config);
  if (data_.config_file.empty()) return {};
  auto on_disk = config::load_machine_config(data_.config_file);
  if (!on_disk) return std::unexpected(on_disk.error().front());
  put(*on_disk);
  if (auto saved = config::save_machine_config(data_.config_file, *on_disk); !saved)
    return std::unexpected(saved.error().front());
  return {};
}

bool Machine::has_sub(std::string_view name) const {
  return std::ranges::any_of(
      macros_, [&](const auto& macros) { return macros->flow().find_sub(name).mark != nullptr; });
}

Result<void> Machine::load(std::shared_ptr<const interp::Program> program, std::string path) {
  if (auto allowed = allow(CommandKind::load); !allowed) return allowed;
  if (job_.active())
    return fail(ErrorCode::command_not_allowed, "A program waits for the operator: end it first.");
  program_ = std::move(program);
  program_path_ = std::move(path);
  elapsed_ = move_began_ = 0.0;
  move_ = line_ = runs_ = 0;
  ended_well_ = false;
  analyse();
  log_.add(Severity::info,
           fmt::format("Loaded {} ({} lines).", program_path_, program_->line_count()));
  return {};
}

/// Check and prediction depend on offsets, tools and where the machine stands: they begin anew when
/// one of these has changed.
void Machine::analyse() {
  findings_.reset();
  analysis_.reset();
  if (program_ && data_.analyse_jobs)
    analysis_ = std::make_unique<JobAnalysis>(PredictionInput{
        data_.config, program_, data_.parameters, data_.tools, feed_.commanded(), macros_});
}

Result<void> Machine::run() {
  if (auto allowed = allow(CommandKind::run); !allowed) return allowed;
  if (!program_) return fail(ErrorCode::no_job, "No job is loaded: load a file first.");
  load_macros();
  elapsed_ = move_began_ = 0.0;
  move_ = line_ = 0;
  single_line_ = false;
  job_.start(program_, JobControl::Kind::job);
  enter(State::running);
  return {};
}

void Machine::pause(Completion done) {
  if (auto allowed = allow(CommandKind::pause); !allowed) return done(allowed);
  wait_for(WaitFor::pause, std::move(done));
  job_.hold();
  enter(State::pausing);
}

Result<void> Machine::resume() {
  if (auto allowed = allow(CommandKind::resume); !allowed) return allowed;
  job_.resume();
  enter(working_state());
  return {};
}

void Machine::stop(Completion done) {
  if (auto allowed = allow(CommandKind::stop); !allowed) return done(allowed);
  wait_for(WaitFor::rest, std::move(done));
  begin_stop();
}

Result<void> Machine::rewind() {
  if (auto allowed = allow(CommandKind::rewind); !allowed) return allowed;
  elapsed_ = move_began_ = 0.0;
  move_ = line_ = 0;
  return {};
}

Result<void> Machine::jog(const Position& rates, double lease) {
  if (auto allowed = allow(CommandKind::jog); !allowed) return allowed;
  for (const Axis axis : kAllAxes)
    if (rates[axis] != 0.0)
      if (auto free = check_clamp(axis); !free) return free;
  if (auto set = jog_.set_rates(rates, now_ + lease, homed_); !set) return set;
  if (jog_.active()) enter(State::jogging);
  return {};
}

Result<void> Machine::jog_step(Axis axis, double distance, double rate) {
  if (auto allowed = allow(CommandKind::jog); !allowed) return allowed;
  if (auto free = check_clamp(axis); !free) return free;
  if (auto stepped = jog_.step(axis, distance, rate, homed_); !stepped) return stepped;
  if (jog_.active()) enter(State::jogging);
  return {};
}

Result<void> Machine::check_clamp(Axis axis) const {
  if (!job_.clamped()[axis]) return {};
  return fail(ErrorCode::axis_clamped,
              fmt::format("Axis {} is clamped (M26): M27 releases it.", axis_name(axis)));
}

void Machine::jog_stop() { jog_.stop(); }

Result<Overrides> Machine::set_overrides(const Overrides& overrides) {
  constexpr double kHighest = 3.0;
  for (const auto& checked :
       {check_factor("feed", overrides.feed, kHighest), check_factor("rapid", overrides.rapid, 1.0),
        check_factor("speed", overrides.speed, kHighest)})
    if (!checked) return std::unexpected(checked.error());
  job_.set_overrides(overrides);
  return overrides;
}

/// G10 L20 for the active system, by the interpreter itself: there is one rule for offsets.
Result<void> Machine::set_work_zero(const std::vector<WorkCoordinate>& coordinates) {
  if (auto allowed = allow(CommandKind::set_work_zero); !allowed) return allowed;
  if (coordinates.empty())
    return fail(ErrorCode::value_out_of_range, "Name at least one axis to set the work zero of.");
  const double unit = interp::millimetres_per(interpreter_.modal().unit);
  std::string line = fmt::format("G10 L20 P{}", data_.parameters.active_system());
  for (const auto& [axis, value] : coordinates)
    line += fmt::format(" {}{:.9f}", axis_name(axis), is_rotary(axis) ? value : value / unit);
  return interpret_now(line);
}

/// A line that only changes the interpreter's state and moves nothing.
Result<void> Machine::interpret_now(std::string line) {
  auto program = interp::Program::from_text(std::move(line), "work zero");
  if (!program) return std::unexpected(program.error());
  interpreter_.start(std::move(*program), feed_.commanded());
  for (;;) {
    switch (interpreter_.next()) {
      case interp::Progress::command:
      case interp::Progress::working:
      case interp::Progress::waiting:
      case interp::Progress::found:
        break;
      case interp::Progress::failed: {
        Error error = interpreter_.diagnostic().to_error();
        interpreter_.stop();
        return std::unexpected(std::move(error));
      }
      case interp::Progress::ended:
        interpreter_.stop();
        save_parameters();
        analyse();
        return {};
    }
  }
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

bool Machine::all_homed() const {
  return std::ranges::all_of(
      kAllAxes, [&](Axis axis) { return homed_[axis] || !data_.config.axes[axis].connected(); });
}

State Machine::resting_state() const {
  if (job_.active()) return waiting_state_;  // jogged while the program waits
  if (!feed_.board().connected) return State::off;
  if (!io_.outputs().drives_enabled) return State::needs_reset;
  if (data_.config.safety.homing_mandatory && !all_homed()) return State::needs_homing;
  return State::ready;
}

std::shared_ptr<const JobFindings> Machine::findings() const { return findings_; }

}  // namespace cnc::server
