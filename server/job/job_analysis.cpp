#include "server/job/job_analysis.h"

#include <utility>

#include "server/job/settings.h"

namespace cnc::server {

JobAnalysis::JobAnalysis(PredictionInput input)
    : input_(std::move(input)), thread_([this](std::stop_token stop) { work(stop); }) {}

JobAnalysis::~JobAnalysis() = default;

std::shared_ptr<const JobFindings> JobAnalysis::findings() const {
  const std::scoped_lock lock(mutex_);
  return findings_;
}

void JobAnalysis::work(std::stop_token stop) {
  std::atomic<bool> cancel{false};
  const std::stop_callback forward(stop, [&] { cancel = true; });
  interp::CheckOptions options;
  options.cancel = &cancel;
  options.begins_with = input_.begins_with;
  JobFindings found;
  found.report = interp::check(input_.program, interpreter_settings(input_.config, input_.macros),
                               input_.parameters, input_.tools, input_.start, options);
  auto prediction = predict(input_, stop);
  if (!prediction) return;
  found.prediction = std::move(*prediction);
  const std::scoped_lock lock(mutex_);
  findings_ = std::make_shared<const JobFindings>(std::move(found));
}

}  // namespace cnc::server
