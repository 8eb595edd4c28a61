#include "server/job/job_control.h"

#include <fmt/format.h>
#include <utility>
#include <variant>

#include "server/job/settings.h"

namespace cnc::server {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

}  // namespace

JobControl::JobControl(const config::MachineConfig& config, interp::Interpreter& interpreter,
                       const config::ParameterStore& parameters, MotionFeed& feed, MachineIo& io,
                       MessageLog& log)
    : config_(config),
      interpreter_(interpreter),
      parameters_(parameters),
      feed_(feed),
      io_(io),
      log_(log),
      planner_(planner_settings(config), Position{}),
      runner_(config, interpreter, planner_) {}

void JobControl::start(std::shared_ptr<const interp::Program> program, Kind kind) {
  offsets_ = offsets();
  kind_ = kind;
  active_ = true;
  waits_for_resume_ = false;
  line_ = 0;
  error_.reset();
  notes_.clear();
  feed_.begin_motion(AxisArray<bool>::filled(true));
  runner_.start(std::move(program), feed_.commanded(), io_.spindle());
  apply_overrides();
}

void JobControl::resume() {
  if (std::exchange(waits_for_resume_, false)) runner_.action_done();
  runner_.resume();
}

void JobControl::abandon() {
  // A new planner: the old one may have been interrupted in full motion.
  planner_ = motion::Planner(planner_settings(config_), feed_.commanded());
  runner_.abandon();
  notes_.clear();
  active_ = false;
  waits_for_resume_ = false;
  interpreter_.set_position(feed_.commanded());
}

JobSignal JobControl::cycle() {
  if (!active_) return JobSignal::none;
  if (const std::uint32_t line = feed_.executing().tag.line; line != 0) line_ = line;
  show_due_notes();
  if (waits_for_resume_) return JobSignal::none;

  // Bounds the time of one cycle when the program says much and moves little.
  constexpr int kMaxSteps = 2000;
  for (int step = 0; step < kMaxSteps && feed_.wants_more(config_.trajectory.fifo_time); ++step) {
    switch (runner_.next()) {
      case JobRunner::Next::setpoint:
        if (auto sent = feed_.emit(runner_.setpoint()); !sent) {
          error_ = std::move(sent.error());
          return finish(JobSignal::failed);
        }
        break;
      case JobRunner::Next::note:
        notes_.push_back({feed_.last_id(), runner_.event()});
        break;
      case JobRunner::Next::action:
        if (!feed_.at_rest()) return JobSignal::none;
        show_due_notes();
        if (const JobSignal signal = perform(runner_.event()); signal != JobSignal::none)
          return signal;
        break;
      case JobRunner::Next::busy:
        return JobSignal::none;
      case JobRunner::Next::held:
        return feed_.at_rest() ? JobSignal::standing : JobSignal::none;
      case JobRunner::Next::ended:
        return feed_.at_rest() ? finish(JobSignal::ended) : JobSignal::none;
      case JobRunner::Next::failed:
        if (!feed_.at_rest()) return JobSignal::none;
        error_ = runner_.error();
        return finish(JobSignal::failed);
    }
  }
  return JobSignal::none;
}

/// An action is performed at rest. Stops and tool changes wait for the operator's resume.
JobSignal JobControl::perform(const JobEvent& event) {
  line_ = event.command.source.line;
  const JobSignal signal = std::visit(
      Overloaded{
          [&](const interp::TurnSpindle& turn) {
            io_.turn_spindle(turn.direction);
            return JobSignal::none;
          },
          [&](const interp::ChangeTool& change) {
            io_.turn_spindle(interp::SpindleDirection::off);
            tool_ = change.tool;
            if (config_.job.auto_tool_change) return JobSignal::none;
            log_.add(Severity::info, fmt::format("Change to tool T{}, then resume.", tool_));
            return JobSignal::tool_change;
          },
          [&](const interp::ProgramStop&) { return JobSignal::program_stop; },
          [&](const interp::ProgramEnd&) {
            if (kind_ == Kind::job) io_.all_off();
            return JobSignal::none;
          },
          [](const auto&) { return JobSignal::none; },
      },
      event.command.body);
  if (signal == JobSignal::none)
    runner_.action_done();
  else
    waits_for_resume_ = true;
  return signal;
}

JobSignal JobControl::finish(JobSignal how) {
  while (!notes_.empty()) {
    show(notes_.front().event);
    notes_.pop_front();
  }
  active_ = false;
  interpreter_.set_position(feed_.commanded());
  return how;
}

void JobControl::show_due_notes() {
  while (!notes_.empty() && feed_.executed(notes_.front().after_segment)) {
    show(notes_.front().event);
    notes_.pop_front();
  }
}

void JobControl::show(const JobEvent& event) {
  std::visit(Overloaded{
                 [&](const interp::SetWorkOffset& set) {
                   if (!set.is_active) return;
                   offsets_.system = set.system;
                   offsets_.work = set.offset;
                 },
                 [&](const interp::SetG92Offset& set) { offsets_.g92 = set.offset; },
                 [&](const interp::UseToolLength& use) {
                   offsets_.tool = {};
                   offsets_.tool[Axis::Z] = use.z;
                   offsets_.tool[Axis::X] = use.x;
                 },
                 [&](const interp::SelectTool& select) { selected_tool_ = select.tool; },
                 [&](const interp::SetSpindleSpeed& set) { io_.set_spindle_speed(set.speed); },
                 [&](const interp::SetCoolant& set) { io_.set_coolant(set.mist, set.flood); },
                 [&](const interp::EnableOverrides& enable) {
                   feed_override_enabled_ = enable.feed;
                   speed_override_enabled_ = enable.speed;
                   apply_overrides();
                 },
                 [&](const interp::Message& message) {
                   // The text of errmsg comes again with the error that ends the program.
                   if (message.kind == interp::MessageKind::message)
                     log_.add(Severity::info, event.text);
                   if (message.kind == interp::MessageKind::warning)
                     log_.add(Severity::warning, event.text);
                 },
                 [](const auto&) {},
             },
             event.command.body);
}

void JobControl::set_overrides(const Overrides& overrides) {
  overrides_ = overrides;
  apply_overrides();
}

void JobControl::apply_overrides() {
  planner_.set_overrides(feed_override_enabled_ ? overrides_.feed : 1.0, overrides_.rapid);
  io_.set_speed_override(speed_override_enabled_ ? overrides_.speed : 1.0);
}

/// While nothing runs the interpreter is where the machine is.
ShownOffsets JobControl::offsets() const {
  if (active_) return offsets_;
  ShownOffsets shown;
  shown.system = parameters_.active_system();
  shown.work = parameters_.work_offset(shown.system);
  shown.g92 = parameters_.g92_offset();
  shown.tool = interpreter_.total_offset() - shown.work - shown.g92;
  return shown;
}

}  // namespace cnc::server
