#include "interpreter/execution.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "interpreter/parameter_access.h"

namespace cnc::interp {
namespace {

/// A program without moves in its contour cannot fill the memory behind a held-back move.
constexpr std::size_t kMaxHeldBack = 1000;

constexpr std::int32_t kLastPlainMotion = 30;  // G0 G1 G2 G3

}  // namespace

Execution::Execution(const InterpreterSettings& settings, config::ParameterStore& parameters,
                     config::ToolTable& tools, ParameterNames& names)
    : settings_(settings),
      parameters_(parameters),
      tools_(tools),
      names_(names),
      head_offsets_(settings.machine.head_offset) {
  head_offsets_.at(static_cast<std::size_t>(Head::spindle_0)) = {};
}

Accepted Execution::run(const Block& block, SourceLine source, StepSet steps) {
  block_ = &block;
  source_ = source;
  waits_ = false;
  steps_left_ = 0;
  stopped_last_ = false;
  habit_ = Habit::none;
  const double a_before = state_.position[Axis::A];
  const Before before = remember(steps);
  Accepted done = run_steps(steps);
  if (done && state_.modal.a_clamped) done = check_clamp(a_before, before.commands);
  if (done && !block.settings().empty()) done = check_settings();
  if (!done) {
    undo(before);
    return done;
  }
  if (!writes_.empty() || measured_head_) apply_writes();
  if (steps_left_ == 0 && !block.settings().empty()) apply_settings();
  return {};
}

Accepted Execution::run_steps(StepSet steps) {
  for (; steps != 0; steps &= steps - 1) {
    const Step step{static_cast<std::uint8_t>(std::countr_zero(steps))};
    code_ = &block_->code(step);
    code_span_ = block_->span_of(step);
    if (state_.modal.compensation != CompensationSide::off) {
      if (Accepted allowed = check_under_compensation(*this); !allowed) return allowed;
    }
    if (Accepted done = code_->handler(*this); !done) return done;
    if (waits_) {
      steps_left_ = steps & (steps - 1);
      return {};
    }
  }
  return {};
}

// Nearly all lines of a CAM program.
bool Execution::is_plain(StepSet steps) const {
  constexpr StepSet kPlainSteps =
      Block::step_bit(Step::comment) | Block::step_bit(Step::feed) | Block::step_bit(Step::motion);
  if ((steps & ~kPlainSteps) != 0 || state_.modal.compensation != CompensationSide::off)
    return false;
  return !block_->has(Step::motion) || block_->code(Step::motion).number <= kLastPlainMotion;
}

Execution::Before Execution::remember(StepSet steps) {
  if (is_plain(steps)) return {state_.plain(), commands_.size()};
  if (const auto held = state_.compensation.held) {
    held_before_.assign(commands_.begin() + static_cast<std::ptrdiff_t>(*held), commands_.end());
  }
  return {state_, commands_.size()};
}

void Execution::undo(const Before& before) {
  if (const auto* plain = std::get_if<PlainState>(&before.state)) {
    state_.put_back(*plain);
  } else {
    state_ = std::get<MachineState>(before.state);
  }
  commands_.resize(before.commands, Command{ProgramEnd{}, source_});
  if (const auto held = state_.compensation.held) {
    std::ranges::copy(held_before_, commands_.begin() + static_cast<std::ptrdiff_t>(*held));
  }
  writes_.clear();
  measured_head_.reset();
  program_ended_ = false;
}

void Execution::assume_done(const Block& block, SourceLine source) {
  constexpr auto kModes =
      std::to_array<Step>({Step::feed_mode, Step::feed, Step::spindle_mode, Step::speed,
                           Step::plane, Step::units, Step::distance_mode, Step::arc_distance_mode});
  const std::size_t commands = commands_.size();
  StepSet others =
      block.steps() & ~(Block::step_bit(Step::motion) | Block::step_bit(Step::comment));
  for (const Step step : kModes) {
    if (block.has(step)) static_cast<void>(run(block, source, Block::step_bit(step)));
    others &= ~Block::step_bit(step);
  }
  const std::int32_t motion =
      block.has(Step::motion) ? block.code(Step::motion).number : state_.modal.motion;
  if (motion <= kLastPlainMotion) {
    const bool compensated = state_.modal.compensation != CompensationSide::off;
    if (others == 0 && !compensated && (block.words() & kAxisWords) != 0) {
      Block rapid = block;
      rapid.put_code(*find_g_code(0), {});
      static_cast<void>(run(rapid, source, Block::step_bit(Step::motion)));
    }
    state_.modal.motion = motion;
  }
  commands_.resize(commands, Command{ProgramEnd{}, source_});
}

void Execution::drop_commands(std::size_t count) {
  std::optional<std::size_t>& held = state_.compensation.held;
  if (!held) {
    commands_.clear();
    return;
  }
  commands_.erase(commands_.begin(), commands_.begin() + static_cast<std::ptrdiff_t>(count));
  *held -= count;
  if (commands_.size() > kMaxHeldBack) release_held();
}

// Whatever code turns the axis: the brake does not ask which (manual 3.5.10).
Accepted Execution::check_clamp(double a, std::size_t first) const {
  constexpr double kSameAngle = 1e-6;
  for (std::size_t i = first; i < commands_.size(); ++i) {
    const Position* end = end_of(commands_[i].body);
    if (end == nullptr || std::abs((*end)[Axis::A] - a) < kSameAngle) continue;
    return refuse(ErrorCode::axis_clamped, block_->has(Axis::A) ? block_->span_of('A') : Span{},
                  fmt::format("The A axis is clamped (M26): it cannot turn from {:.6g} to {:.6g}.",
                              a, (*end)[Axis::A]),
                  "M27 on a line before.");
  }
  return {};
}

// They have been checked when they were computed; G20 or G21 on their line changes their unit.
Accepted Execution::check_settings() const {
  const ParameterAccess access(settings_, parameters_, tools_, names_, state_);
  const bool offsets_are_fixed = state_.modal.compensation != CompensationSide::off;
  for (const ParameterSetting& setting : block_->settings()) {
    if (Accepted allowed = access.check(setting); !allowed) return allowed;
    if (!offsets_are_fixed || (!ParameterAccess::affects_offsets(setting.number) &&
                               !ParameterAccess::affects_tools(setting.number))) {
      continue;
    }
    return refuse(ErrorCode::compensation_offset_change, setting.span,
                  "Offsets and tools cannot change while cutter compensation is on.",
                  "G40 before it.");
  }
  return {};
}

void Execution::keep_head_offset(const StoreHeadOffset& measured) {
  measured_head_ = measured;
  emit(measured);
}

void Execution::apply_writes() {
  for (const ParameterWrite& write : writes_) parameters_.set(write.number, write.value);
  writes_.clear();
  if (const auto head = std::exchange(measured_head_, std::nullopt)) {
    head_offsets_.at(static_cast<std::size_t>(head->head)) = head->offset;
  }
}

void Execution::apply_settings() {
  bool offsets_changed = false;
  bool tools_changed = false;
  for (const ParameterSetting& setting : block_->settings()) {
    set_now(setting.number, setting.value);
    if (!ParameterAccess::is_system(setting.number)) continue;
    offsets_changed |= ParameterAccess::affects_offsets(setting.number);
    tools_changed |= ParameterAccess::affects_tools(setting.number);
  }
  if (offsets_changed) reload_offsets();
  if (tools_changed) reload_tool_length();
}

Accepted Execution::tolerate(Habit habit, Span span) {
  if (settings_.strict) return refuse_habit(habit, span);
  habit_ = habit;
  habit_span_ = span;
  return {};
}

void Execution::ask(Dialog dialog) {
  dialog_ = std::move(dialog);
  emit(AskOperator{&dialog_});
}

double Execution::parameter(std::int32_t number) const {
  return ParameterAccess(settings_, parameters_, tools_, names_, state_).get(number);
}

void Execution::set_now(std::int32_t number, double value) {
  ParameterAccess(settings_, parameters_, tools_, names_, state_).set(number, value);
}

void Execution::set_six(std::int32_t first, const Position& position) {
  for (const Axis axis : kAllAxes) {
    set_parameter(first + static_cast<std::int32_t>(index_of(axis)), position[axis]);
  }
}

void Execution::reload_offsets() {
  const std::int32_t system = parameters_.active_system();
  const Position offset = parameters_.work_offset(system);
  if (system == state_.modal.work_system && offset == state_.coordinates.work_offset()) return;
  state_.modal.work_system = system;
  state_.coordinates.set_work_offset(offset);
  emit(SetWorkOffset{system, true, offset});
}

void Execution::reload_tool_length() {
  const ModalState& modal = state_.modal;
  if (modal.length_source == LengthSource::words) return;  // in no table
  const bool from_spindle = modal.length_source == LengthSource::spindle_tool;
  const std::int32_t number = from_spindle ? modal.tool : modal.length_tool;
  const bool none = modal.length_source == LengthSource::none;
  const config::Tool& tool = tools_.tool(none ? 0 : number);
  use_tool_length(tool.x_offset, tool.length);
}

void Execution::use_tool_length(double x, double z) {
  const Position& now = state_.coordinates.tool_length();
  if (now[Axis::X] == x && now[Axis::Z] == z) return;
  state_.coordinates.set_tool_length(x, z);
  emit(UseToolLength{z, x});
}

}  // namespace cnc::interp
