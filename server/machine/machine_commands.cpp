// Commands: what is asked of the machine, and whether it is allowed now.
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "server/machine/machine.h"

namespace cnc::server {
namespace {

Result<void> check_factor(std::string_view name, double value, double highest) {
  if (value >= 0.0 && value <= highest) return {};
  return fail(ErrorCode::value_out_of_range,
              fmt::format("The {} override is {} %; it can be 0 to {} %.", name, 100.0 * value,
                          100.0 * highest));
}

}  // namespace

void Machine::reset(Completion done) {
  if (auto allowed = allow(CommandKind::reset); !allowed) return done(allowed);
  wait_for(WaitFor::reset, std::move(done));
  reset_wanted_ = true;
  begin_stop();
  reset_deadline_ = 0.0;  // counts from when the machine stands
  reset_is_sent_ = false;
}

void Machine::home(std::vector<Axis> axes, Completion done) {
  if (auto allowed = allow(CommandKind::home); !allowed) return done(allowed);
  const bool all = axes.empty();
  if (all) axes = Homing::default_order(data_.config);
  for (const Axis axis : axes)
    if (!data_.config.axes[axis].programmable())
      return done(
          fail(ErrorCode::axis_not_connected,
               fmt::format("Axis {} is not connected; it cannot be homed.", axis_name(axis))));
  wait_for(WaitFor::home, std::move(done));
  load_macros();
  if (auto text = homing_subs(axes, all)) return run_text(std::move(*text), "homing");
  for (const Axis axis : axes) trust_.take(TrustEvent::homing_begun, only(axis));
  homing_.start(std::move(axes));
  enter(State::homing);
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

Result<void> Machine::answer(std::uint64_t question, bool confirmed, std::vector<double> values) {
  const interp::Dialog* dialog = job_.question();
  const bool is_asked = dialog != nullptr && question == question_;
  const bool was_asked = question != 0 && question <= question_;
  const auto not_asked =
      fail(ErrorCode::no_question,
           "This question is not asked any more: it is answered, or its program has ended.");
  // Whoever answers second is to hear that, not what the machine does meanwhile.
  if (was_asked && !is_asked) return not_asked;
  if (auto allowed = allow(CommandKind::answer); !allowed) return allowed;
  if (!is_asked) return not_asked;
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

Result<void> Machine::load(std::shared_ptr<const interp::Program> program, std::string path) {
  if (auto allowed = allow(CommandKind::load); !allowed) return allowed;
  if (job_.active())
    return fail(ErrorCode::command_not_allowed, "A program waits for the operator: end it first.");
  program_ = std::move(program);
  program_path_ = std::move(path);
  elapsed_ = move_began_ = 0.0;
  move_ = line_ = runs_ = 0;
  ended_well_ = false;
  told_finding_.clear();
  analyse();
  log_.add(Severity::info,
           fmt::format("Loaded {} ({} lines).", program_path_, program_->line_count()));
  return {};
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
  if (auto set = jog_.set_rates(rates, now_ + lease, trust_); !set) return set;
  if (jog_.active()) enter(State::jogging);
  return {};
}

Result<void> Machine::jog_step(Axis axis, double distance, double rate) {
  if (auto allowed = allow(CommandKind::jog); !allowed) return allowed;
  if (auto free = check_clamp(axis); !free) return free;
  if (auto stepped = jog_.step(axis, distance, rate, trust_); !stepped) return stepped;
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

Result<void> Machine::accept_position(const std::vector<Axis>& axes) {
  if (auto allowed = allow(CommandKind::accept_position); !allowed) return allowed;
  for (const Axis axis : axes)
    if (!data_.config.axes[axis].programmable())
      return fail(ErrorCode::axis_not_connected,
                  fmt::format("Axis {} is not connected; it has no position.", axis_name(axis)));
  const auto accepted = trust_.accept(axes);
  if (!accepted) return std::unexpected(accepted.error());
  for (const Axis axis : *accepted)
    log_.add(Severity::warning, fmt::format("The operator accepts {} as the position of axis {}.",
                                            feed_.commanded()[axis], axis_name(axis)));
  enter(resting_state());
  return {};
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

}  // namespace cnc::server
