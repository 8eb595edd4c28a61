#include "server/job/prediction.h"

#include <algorithm>

#include "server/job/job_runner.h"
#include "server/job/settings.h"

namespace cnc::server {

void Prediction::add(const motion::Setpoint& setpoint) {
  time_ += setpoint.duration;
  if (!marks_.empty() && setpoint.tag.id < marks_.back().move + stride_) {
    if (setpoint.tag.id == marks_.back().move) marks_.back().time = time_;
    return;
  }
  marks_.push_back({setpoint.tag.id, time_});
  if (marks_.size() < kMaxMarks) return;
  for (std::size_t i = 0; 2 * i < marks_.size(); ++i) marks_[i] = marks_[2 * i];
  marks_.resize((marks_.size() + 1) / 2);
  stride_ *= 2;
}

double Prediction::time_at(std::uint64_t move) const {
  const auto next = std::ranges::upper_bound(marks_, move, {}, &Mark::move);
  return next == marks_.begin() ? 0.0 : std::prev(next)->time;
}

std::optional<Prediction> predict(const PredictionInput& input, std::stop_token stop) {
  config::ParameterStore parameters = input.parameters;
  config::ToolTable tools = input.tools;
  interp::Interpreter interpreter(interpreter_settings(input.config, input.macros), parameters,
                                  tools);
  motion::Planner planner(planner_settings(input.config), input.start);
  JobRunner runner(input.config, interpreter, planner, JobRunner::Detail::times);
  runner.start(input.program, input.start, interp::SpindleDirection::off, interp::RunMode::render);

  Prediction prediction;
  for (std::uint32_t count = 0;; ++count) {
    constexpr std::uint32_t kLookUpEvery = 256;
    if (count % kLookUpEvery == 0 && stop.stop_requested()) return std::nullopt;
    switch (runner.next()) {
      case JobRunner::Next::setpoint:
        prediction.add(runner.setpoint());
        break;
      case JobRunner::Next::action:
        runner.action_done();
        break;
      case JobRunner::Next::note:
      case JobRunner::Next::busy:
        break;
      case JobRunner::Next::failed:
        prediction.error = runner.error();
        return prediction;
      case JobRunner::Next::held:  // nobody holds here
      case JobRunner::Next::ended:
        return prediction;
    }
  }
}

}  // namespace cnc::server
