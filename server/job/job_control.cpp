#include "server/job/job_control.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <variant>

#include "server/job/settings.h"
#include "server/job/surface_speed.h"

namespace cnc::server {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

}  // namespace

JobControl::JobControl(const config::MachineConfig& config, interp::Interpreter& interpreter,
                       const config::ParameterStore& parameters, MotionFeed& feed, MachineIo& io,
                       ProgramFiles& files, MessageLog& log)
    : config_(config),
      interpreter_(interpreter),
      parameters_(parameters),
      feed_(feed),
      io_(io),
      files_(files),
      log_(log),
      planner_(planner_settings(config), Position{}),
      runner_(config, interpreter, planner_),
      home_is_estop_(config.safety.home_sensor_is_estop),
      probe_(config, feed) {}

void JobControl::start(std::shared_ptr<const interp::Program> program, Kind kind) {
  offsets_ = offsets();
  kind_ = kind;
  active_ = true;
  waits_for_ = WaitsFor::nothing;
  line_ = 0;
  error_.reset();
  notes_.clear();
  feed_.begin_motion(AxisArray<bool>::filled(true));
  runner_.start(std::move(program), feed_.commanded(), io_.spindle());
  apply_overrides();
}

void JobControl::resume() {
  if (waits_for_ == WaitsFor::operator_) go_on({});
  probe_.resume();
  runner_.resume();
}

/// The action in hand is done. The machine may stand elsewhere than where the program left it.
void JobControl::go_on(interp::Answer answer) {
  waits_for_ = WaitsFor::nothing;
  const hal::ControllerStatus& board = feed_.board();
  answer.position = feed_.commanded();
  constexpr double kSecondsPerMinute = 60.0;
  answer.live = {.probe = board.inputs.probe,
                 .hand_wheel = static_cast<double>(board.inputs.hand_wheel_count),
                 .spindle_speed = board.spindle_speed / kSecondsPerMinute,
                 .height_map = false};
  runner_.action_done(answer);
  feed_.begin_motion(AxisArray<bool>::filled(true));
}

const interp::Dialog* JobControl::question() const {
  if (waits_for_ != WaitsFor::answer) return nullptr;
  return std::get<interp::AskOperator>(runner_.event().command.body).dialog;
}

std::optional<Error> JobControl::refusal_of_answer(bool confirmed,
                                                   const std::vector<double>& values) const {
  interp::Answer answer;
  answer.confirmed = confirmed;
  answer.values = values;
  return interpreter_.refusal_of(answer);
}

void JobControl::answer_question(bool confirmed, std::vector<double> values) {
  interp::Answer answer;
  answer.confirmed = confirmed;
  answer.values = std::move(values);
  go_on(std::move(answer));
}

interp::HomeAxis JobControl::home_request() const {
  return std::get<interp::HomeAxis>(runner_.event().command.body);
}

void JobControl::home_done() { go_on({}); }

void JobControl::abandon() {
  // A new planner: the old one may have been interrupted in full motion.
  planner_ = motion::Planner(planner_settings(config_), feed_.commanded());
  runner_.abandon();
  probe_.drop();
  notes_.clear();
  active_ = false;
  waits_for_ = WaitsFor::nothing;
  interpreter_.set_position(feed_.commanded());
}

JobSignal JobControl::cycle() {
  if (!active_) return JobSignal::none;
  if (const std::uint32_t line = feed_.executing().tag.line; line != 0) line_ = line;
  show_due_notes();
  if (waits_for_ == WaitsFor::probe) return cycle_probe();
  if (waits_for_ == WaitsFor::input) return cycle_input();
  if (waits_for_ == WaitsFor::spindle) return cycle_spindle();
  if (waits_for_ != WaitsFor::nothing) return JobSignal::none;

  // Bounds the time of one cycle when the program says much and moves little.
  constexpr int kMaxSteps = 2000;
  for (int step = 0; step < kMaxSteps && feed_.wants_more(config_.trajectory.fifo_time); ++step) {
    switch (runner_.next()) {
      case JobRunner::Next::setpoint:
        if (auto sent = feed_.emit(runner_.setpoint()); !sent) return fail_with(sent.error());
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
        return fail_with(runner_.error());
    }
  }
  return JobSignal::none;
}

/// An action is performed at rest. Some of them take time, or a person.
JobSignal JobControl::perform(const JobEvent& event) {
  line_ = event.command.source.file == 0 ? event.command.source.line : line_;
  const JobSignal signal = std::visit(
      Overloaded{
          [&](const interp::TurnSpindle& turn) {
            io_.turn_spindle(turn.direction);
            return JobSignal::none;
          },
          [&](const interp::EnableDrives& enable) {
            io_.enable_drives(enable.on);
            return JobSignal::none;
          },
          [&](const interp::ChangeTool& change) {
            io_.turn_spindle(interp::SpindleDirection::off);
            tool_ = change.tool;
            if (config_.job.auto_tool_change) return JobSignal::none;
            log_.add(Severity::info, fmt::format("Change to tool T{}, then resume.", tool_));
            return wait_for(WaitsFor::operator_, JobSignal::tool_change);
          },
          [&](const interp::ProgramStop&) {
            return wait_for(WaitsFor::operator_, JobSignal::program_stop);
          },
          [&](const interp::AskOperator&) {
            return wait_for(WaitsFor::answer, JobSignal::question);
          },
          [&](const interp::HomeAxis&) { return wait_for(WaitsFor::homing, JobSignal::home); },
          [&](const interp::ProbeMove& move) { return start_probe(move); },
          [&](const interp::SyncMove&) {
            wait_began_ = speed_checked_ = feed_.board().time;
            speed_before_ = 0.0;
            return wait_for(WaitsFor::spindle, JobSignal::none);
          },
          [&](const interp::ReadInput&) {
            wait_began_ = feed_.board().time;
            return wait_for(WaitsFor::input, JobSignal::none);
          },
          [&](const interp::ChangeHeightMap& change) {
            const auto changed = change_height_map(change, event.text);
            return changed ? JobSignal::none : fail_with(changed.error());
          },
          [&](const interp::SetOutput& set) {
            const auto done = io_.set_output(set.port, set.on);
            return done ? JobSignal::none : fail_with(done.error());
          },
          [&](const interp::SetAnalogOutput& set) {
            const auto done = io_.set_analog_output(set.port, set.value);
            return done ? JobSignal::none : fail_with(done.error());
          },
          [&](const interp::StoreHeadOffset& store) {
            const auto kept = keep_head_ ? keep_head_(store) : Result<void>{};
            return kept ? JobSignal::none : fail_with(kept.error());
          },
          [&](const interp::ClampAxis& clamp) {
            clamped_[clamp.axis] = clamp.on;
            const auto done = clamp.port ? io_.set_output(*clamp.port, clamp.on) : Result<void>{};
            return done ? JobSignal::none : fail_with(done.error());
          },
          [&](const interp::SetSpindleOutput& set) {
            io_.set_spindle_output(set.output, set.on);
            return JobSignal::none;
          },
          [&](const interp::ProgramEnd&) {
            if (kind_ == Kind::job) io_.all_off();
            return JobSignal::none;
          },
          [](const auto&) { return JobSignal::none; },
      },
      event.command.body);
  if (active_ && waits_for_ == WaitsFor::nothing) go_on({});
  return signal;
}

JobSignal JobControl::wait_for(WaitsFor what, JobSignal signal) {
  waits_for_ = what;
  return signal;
}

JobSignal JobControl::start_probe(const interp::ProbeMove& move) {
  const auto started = probe_.start(move.end, runner_.feed_of(move));
  return started ? wait_for(WaitsFor::probe, JobSignal::none) : fail_with(started.error());
}

JobSignal JobControl::fail_with(Error error) {
  error_ = std::move(error);
  return finish(JobSignal::failed);
}

/// Before a thread the spindle has to turn at a steady speed, which is measured (manual 3.4.19).
JobSignal JobControl::cycle_spindle() {
  constexpr double kInterval = 0.25;  // s
  constexpr double kSteady = 0.01;    // of the speed, in that time
  constexpr double kTimeout = 10.0;   // s
  const hal::ControllerStatus& board = feed_.board();
  if (board.time - speed_checked_ < kInterval) return JobSignal::none;
  speed_checked_ = board.time;
  const double change =
      std::abs(board.spindle_speed - std::exchange(speed_before_, board.spindle_speed));
  if (board.spindle_speed > 0.0 && change <= kSteady * board.spindle_speed) {
    runner_.set_measured_speed(board.spindle_speed);
    go_on({});
    return JobSignal::none;
  }
  if (board.time - wait_began_ < kTimeout) return JobSignal::none;
  return fail_with({ErrorCode::spindle_not_steady,
                    board.spindle_speed > 0.0
                        ? fmt::format("The spindle does not come to a steady speed ({:.0f} rpm).",
                                      board.spindle_speed)
                        : "The spindle does not turn, or its index sensor gives no pulse.",
                    std::nullopt});
}

/// M56: at once, or when the input is as wanted or the time is over; #5399 is then what it is.
JobSignal JobControl::cycle_input() {
  const auto& input = std::get<interp::ReadInput>(runner_.event().command.body);
  const auto value = io_.read(input);
  if (!value) return fail_with(value.error());
  const bool wanted = input.wait == interp::WaitForInput::no ||
                      (*value != 0.0) == (input.wait == interp::WaitForInput::high);
  if (!wanted && feed_.board().time - wait_began_ < input.timeout) return JobSignal::none;
  interp::Answer answer;
  answer.input = *value;
  go_on(std::move(answer));
  return JobSignal::none;
}

JobSignal JobControl::cycle_probe() {
  probe_.cycle();
  if (probe_.standing()) return JobSignal::standing;
  if (probe_.active()) return JobSignal::none;
  if (const auto& error = probe_.error()) return fail_with(*error);
  if (probe_.tripped()) probe_position_ = probe_.position();
  interp::Answer answer;
  answer.probe_tripped = probe_.tripped();
  answer.probe_position = probe_.position();
  go_on(std::move(answer));
  return JobSignal::none;
}

Result<void> JobControl::change_height_map(const interp::ChangeHeightMap& change,
                                           const std::string& name) {
  using enum interp::HeightMapCommand;
  switch (change.command) {
    case begin:
      height_map_ = HeightMap(change.grid_size, change.columns, change.rows);
      return {};
    case add_point:
      return height_map_.add(probe_position_);
    case store:
      return files_.write(name, height_map_.to_text());
    case on:
    case off:
      break;
  }
  return fail(ErrorCode::not_on_this_machine,
              "This machine cannot compensate Z by a height map yet.");
}

/// G96: the spindle follows the radius at which the tool is.
void JobControl::follow_surface_speed() {
  if (!surface_speed_) return;
  const double radius = std::abs((feed_.board().position - offsets().total())[Axis::X]);
  io_.set_spindle_speed(surface_rpm(*surface_speed_, radius, config_.spindle.max_speed));
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
                 [&](const interp::SetSpindleSpeed& set) {
                   surface_speed_.reset();
                   io_.set_spindle_speed(set.speed);
                 },
                 [&](const interp::UseSurfaceSpeed& use) { surface_speed_ = use; },
                 [&](const interp::UseHomeSensorsAsEstop& use) { home_is_estop_ = use.on; },
                 [&](const interp::OpenLogFile& open) { files_.open(event.text, open.append); },
                 [&](const interp::StorePosition& store) {
                   files_.add_position(event.text, store.append, store.work_position);
                 },
                 [&](const interp::SetOverride& set) {
                   double& own =
                       set.which == interp::Override::feed ? overrides_.feed : overrides_.speed;
                   bool& enabled = set.which == interp::Override::feed ? feed_override_enabled_
                                                                       : speed_override_enabled_;
                   if (set.factor) own = *set.factor;
                   enabled = set.factor.has_value();
                   apply_overrides();
                 },
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
                   if (message.kind == interp::MessageKind::log) files_.add_line(event.text);
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
