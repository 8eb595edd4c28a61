// What an answer changes: position, results in parameters, values that the operator typed.
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
      set_now(fields[i].parameter, answer.values[i]);
  }
}

Accepted Execution::check(const Answer& answer, const CommandBody& command) const {
  const auto* ask = std::get_if<AskOperator>(&command);
  if (ask == nullptr || !answer.confirmed) return {};
  const ParameterAccess access(settings_, parameters_, tools_, state_);
  const std::vector<DialogField>& fields = ask->dialog->fields;
  for (std::size_t i = 0; i < fields.size() && i < answer.values.size(); ++i) {
    Accepted possible = access.check({fields[i].parameter, answer.values[i], {}});
    if (!possible) return possible;
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
