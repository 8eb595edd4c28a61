// How long a job takes: the same interpreter, planner, runner and profile as in the real run, run
// ahead with nobody watching the clock.
//
//   caller's thread                        │ thread of its own
//   Interpreter ► JobRunner ► Planner ► PathRelay ► PathQueue ► Profile ► Prediction
//   lines, moves, smoothed path            │ speeds, times
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "config/machine_config.h"
#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "interpreter/machine_state.h"
#include "interpreter/sources.h"
#include "motion/planner.h"

namespace cnc::server {

/// Predicted time of a job and of each of its moves. Moves are numbered by the runner in the order
/// of execution, so the numbers of the prediction and of the run are the same.
class Prediction {
 public:
  [[nodiscard]] double time() const { return time_; }
  /// Seconds from the start of the job to the end of `move`.
  [[nodiscard]] double time_at(std::uint64_t move) const;

  /// Goes on for `duration` seconds, to the end of `move` or further towards it.
  void add(double duration, std::uint64_t move);

  /// Set when the job would end with an error.
  std::optional<Error> error;

 private:
  struct Mark {
    std::uint64_t move;
    double time;
  };
  // Thinned to every second mark whenever this many are reached: memory stays bounded, and the
  // resolution stays better than a ten-thousandth of the job.
  static constexpr std::size_t kMaxMarks = 20'000;

  std::vector<Mark> marks_;
  std::uint64_t stride_ = 1;
  double time_ = 0.0;
};

/// Everything a run depends on, by value: the prediction runs beside the machine.
struct PredictionInput {
  config::MachineConfig config;
  std::shared_ptr<const interp::Program> program;
  config::ParameterStore parameters;
  config::ToolTable tools;
  Position start;
  interp::Library macros{};
  /// What the program finds in force; the modes of power-up where it is not said.
  std::optional<interp::MachineState> begins_with{};
};

/// Runs the job without a machine. Prompts are answered "go on". Nothing when `stop` is requested:
/// both threads then end within some milliseconds.
[[nodiscard]] std::optional<Prediction> predict(const PredictionInput& input, std::stop_token stop);

}  // namespace cnc::server
