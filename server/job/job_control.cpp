#include "server/job/job_control.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "server/job/overloaded.h"
#include "server/job/settings.h"
#include "server/job/surface_speed.h"

namespace cnc::server {

namespace {

SpindleSpeed speed_behind(const interp::CommandBody& command, SpindleSpeed speed) {
  std::visit(
      Overloaded{
          [&](const interp::SetSpindleSpeed& set) { speed.programmed = set.speed; },
          [&](const interp::UseSurfaceSpeed&) { speed.programmed.reset(); },
          [&](const interp::SetOverride& set) {
            if (set.which != interp::Override::speed) return;
            if (set.factor) speed.override = *set.factor;
            speed.override_enabled = set.factor.has_value();
          },
          [&](const interp::EnableOverrides& enable) { speed.override_enabled = enable.speed; },
          [](const auto&) {},
      },
      command);
  return speed;
}

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
      planner_(job_planner_settings(config, feed.limits()), Position{}),
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
  replan_wanted_ = false;
  feed_.begin_motion(AxisArray<bool>::filled(true));
  runner_.start(std::move(program), feed_.commanded(), io_.spindle());
  apply_overrides();
}

void JobControl::hold() {
  runner_.hold();
  probe_.hold();
  replan();
}

void JobControl::resume() {
  if (waits_for_ == WaitsFor::operator_) go_on({});
  probe_.resume();
  runner_.resume();
  replan();
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
                 .height_map = feed_.surface() != nullptr};
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
  planner_ = motion::Planner(job_planner_settings(config_, feed_.limits()), feed_.commanded());
  runner_.abandon();
  probe_.drop();
  notes_.clear();
  notes_before_cut_.clear();
  replan_wanted_ = false;
  active_ = false;
  waits_for_ = WaitsFor::nothing;
  interpreter_.set_position(feed_.commanded());
}

JobSignal JobControl::cycle() {
  if (!active_) return JobSignal::none;
  if (const std::uint32_t line = feed_.executing().tag.line; line != 0) line_ = line;
  if (error_) return fail_with(*error_);
  if (!cut_is_settled()) return JobSignal::none;
  runner_.forget_all_but(feed_.under_way());
  show_due_notes();
  if (waits_for_ == WaitsFor::probe) return cycle_probe();
  if (waits_for_ == WaitsFor::input) return cycle_input();
  if (waits_for_ == WaitsFor::spindle) return cycle_spindle();
  if (waits_for_ != WaitsFor::nothing) return JobSignal::none;

  // Bounds the time of one cycle when the program says much and moves little.
  constexpr int kMaxSteps = 2000;
  for (int step = 0; step < kMaxSteps && wants_more(); ++step) {
    switch (runner_.next()) {
      case JobRunner::Next::setpoint:
        if (auto sent = emit(runner_.setpoint()); !sent) return fail_with(sent.error());
        break;
      case JobRunner::Next::note:
        note(runner_.event());
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

/// G96: the spindle follows the radius at which the tool is.
void JobControl::follow_surface_speed() {
  if (!surface_speed_) return;
  const double radius = std::abs((feed_.board().position - offsets().total())[Axis::X]);
  io_.set_spindle_speed(surface_rpm(*surface_speed_, radius, config_.spindle.max_speed));
}

JobSignal JobControl::finish(JobSignal how) {
  show_due_notes();
  notes_.clear();
  active_ = false;
  interpreter_.set_position(feed_.commanded());
  return how;
}

SpindleSpeed JobControl::speed_shown() const {
  const auto programmed = surface_speed_ ? std::nullopt : std::optional(io_.spindle_speed());
  return {programmed, overrides_.speed, speed_override_enabled_};
}

void JobControl::note(const JobEvent& event) {
  const SpindleSpeed before = notes_.empty() ? speed_shown() : notes_.back().speed;
  notes_.push_back({feed_.last_id(), event, speed_behind(event.command.body, before)});
}

/// Anew, for the notes to come: what is shown, or which notes there are, has changed.
void JobControl::plan_speeds() {
  SpindleSpeed speed = speed_shown();
  for (DueNote& note : notes_) speed = note.speed = speed_behind(note.event.command.body, speed);
}

/// With it goes what the notes behind the segment before it switch.
Result<void> JobControl::emit(const motion::Setpoint& setpoint) {
  hal::OutputChange change;
  const MotionFeed::Id id = feed_.next_id();
  for (auto note = notes_.rbegin(); note != notes_.rend() && note->after_segment == feed_.last_id();
       ++note) {
    note->change = io_.change_for(note->event.command.body, note->speed);
    if (note->change.empty()) continue;
    note->with_segment = id;
    note->ticket = io_.sent_with_path();
    hal::OutputChange earlier = note->change;
    earlier.add(change);
    change = earlier;
  }
  return feed_.emit(setpoint, change);
}

bool JobControl::is_due(const DueNote& note) const {
  return note.with_segment != 0 ? feed_.begun(note.with_segment)
                                : feed_.executed(note.after_segment);
}

void JobControl::show_due_notes() {
  for (; !notes_.empty() && is_due(notes_.front()); notes_.pop_front()) {
    const DueNote& note = notes_.front();
    if (note.with_segment != 0) io_.switched(note.change, note.ticket);
    show(note.event);
  }
  io_.correct();
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
                   apply_overrides();
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
  const bool same = overrides == overrides_;
  overrides_ = overrides;
  apply_overrides();
  plan_speeds();
  if (!same) replan();
}

void JobControl::apply_overrides() {
  const double speed = speed_override_enabled_ ? overrides_.speed : 1.0;
  planner_.set_overrides(feed_override_enabled_ ? overrides_.feed : 1.0, overrides_.rapid,
                         speed_reached(speed));
  io_.set_speed_override(speed);
}

/// The part of its programmed speed at which the spindle turns with this override: a feed per
/// revolution must not grow beyond what the spindle can do.
double JobControl::speed_reached(double override) const {
  const double programmed = std::min(io_.spindle_speed(), config_.spindle.max_speed);
  if (programmed <= 0.0) return override;
  return std::clamp(override * programmed, config_.spindle.min_speed, config_.spindle.max_speed) /
         programmed;
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
