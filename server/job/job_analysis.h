// Check and time prediction of a loaded job, in the background.
//
// Starts when a job is loaded and is given up when the next one is. The executor polls; nothing is
// ever waited for.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "interpreter/check.h"
#include "server/job/prediction.h"

namespace cnc::server {

struct JobFindings {
  interp::CheckReport report;
  Prediction prediction;

  /// Errors that the run would meet: wrong lines, or a move that the machine cannot make.
  [[nodiscard]] std::uint64_t problem_count() const {
    if (!report.errors.empty()) return report.errors.size();
    return prediction.error ? 1 : 0;
  }
};

class JobAnalysis {
 public:
  explicit JobAnalysis(PredictionInput input);
  ~JobAnalysis();

  /// The result once both parts are done; the same object on every later call.
  [[nodiscard]] std::shared_ptr<const JobFindings> findings() const;

 private:
  void work(std::stop_token stop);

  const PredictionInput input_;
  mutable std::mutex mutex_;  // protects findings_
  std::shared_ptr<const JobFindings> findings_;
  std::jthread thread_;
};

}  // namespace cnc::server
