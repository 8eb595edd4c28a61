// What an answer changes: position, results in parameters, values that the operator typed.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/parameter_access.h"

namespace cnc::interp {
namespace {

// Parameters with results (manual 3.1.1).
constexpr std::int32_t kProbeMachinePosition = 5051;
constexpr std::int32_t kProbeWorkPosition = 5061;
constexpr std::int32_t kProbeTripped = 5067;
constexpr std::int32_t kProbeJointPosition = 5081;
constexpr std::int32_t kDialogResult = 5398;
constexpr std::int32_t kInputResult = 5399;

/// Far beyond what words can add up to, far below where sums become infinite.
constexpr double kMaxAnswer = 1e15;

[[nodiscard]] bool is_possible(double value) {
  return std::abs(value) <= kMaxAnswer;  // false for NaN
}

[[nodiscard]] bool is_possible(const Position& position) {
  return std::ranges::all_of(kAllAxes, [&](Axis axis) { return is_possible(position[axis]); });
}

[[nodiscard]] bool is_possible(const Answer& answer) {
  return is_possible(answer.position) && is_possible(answer.probe_position) &&
         is_possible(answer.input) && is_possible(answer.live.hand_wheel) &&
         is_possible(answer.live.spindle_speed);
}

/// Screens give back what they showed, a few digits short. What only the machine writes may stand
/// in a dialog to be seen.
[[nodiscard]] bool is_only_shown(const DialogField& field, double typed) {
  constexpr double kAsShown = 1e-4;
  return std::abs(typed - field.value) <= kAsShown &&
         !ParameterAccess::check_writable(field.parameter, {});
}

}  // namespace

void Execution::take(const Answer& answer, const CommandBody& command) {
  // Commands of the line that are in the queue already have their end points.
  if (&command == &commands_.back().body) state_.arrive(answer.position);
  state_.live = answer.live;
  if (std::holds_alternative<ProbeMove>(command)) {
    parameters_.set_six(kProbeMachinePosition, answer.probe_position);
    parameters_.set_six(kProbeJointPosition, answer.probe_position);
    parameters_.set_six(kProbeWorkPosition, state_.coordinates.to_work(answer.probe_position));
    parameters_.set(kProbeTripped, answer.probe_tripped ? 1.0 : 0.0);
  } else if (std::holds_alternative<ReadInput>(command)) {
    parameters_.set(kInputResult, answer.input);
  } else if (const auto* ask = std::get_if<AskOperator>(&command)) {
    parameters_.set(kDialogResult, answer.confirmed ? 1.0 : -1.0);
    const std::vector<DialogField>& fields = ask->dialog->fields;
    for (std::size_t i = 0; answer.confirmed && i < fields.size() && i < answer.values.size(); ++i)
      if (!is_only_shown(fields[i], answer.values[i]))
        set_now(fields[i].parameter, answer.values[i]);
  }
}

Accepted Execution::check(const Answer& answer, const CommandBody& command) const {
  if (!is_possible(answer)) {
    return refuse(ErrorCode::answer_impossible, {},
                  "The machine answered with a number that it cannot have.");
  }
  const auto* ask = std::get_if<AskOperator>(&command);
  if (ask == nullptr || !answer.confirmed) return {};
  const ParameterAccess access(settings_, parameters_, tools_, names_, state_);
  const std::vector<DialogField>& fields = ask->dialog->fields;
  for (std::size_t i = 0; i < fields.size() && i < answer.values.size(); ++i) {
    if (is_only_shown(fields[i], answer.values[i])) continue;
    Accepted possible = access.check({fields[i].parameter, answer.values[i], {}});
    if (!possible) return possible;
    if (!std::isfinite(answer.values[i])) {
      return refuse(ErrorCode::word_out_of_range, {},
                    fmt::format("#{} cannot be {}.", fields[i].parameter, answer.values[i]),
                    "A number.");
    }
  }
  return {};
}

Answer Execution::expected_answer(const CommandBody& command) const {
  Answer answer;
  answer.position = state_.machine_position();
  answer.live = state_.live;
  if (const auto* probe = std::get_if<ProbeMove>(&command)) {
    answer.probe_tripped = true;
    answer.probe_position = probe->end;
  }
  if (const auto* read = std::get_if<ReadInput>(&command)) {
    answer.input = read->wait == WaitForInput::high ? 1.0 : 0.0;
  }
  return answer;
}

}  // namespace cnc::interp
