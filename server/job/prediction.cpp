#include "server/job/prediction.h"

#include <algorithm>
#include <future>

#include "motion/profile.h"
#include "server/job/job_runner.h"
#include "server/job/path_queue.h"
#include "server/job/path_relay.h"
#include "server/job/settings.h"

namespace cnc::server {

void Prediction::add(double duration, std::uint64_t move) {
  time_ += duration;
  if (!marks_.empty() && move < marks_.back().move + stride_) {
    if (move == marks_.back().move) marks_.back().time = time_;
    return;
  }
  marks_.push_back({move, time_});
  if (marks_.size() < kMaxMarks) return;
  for (std::size_t i = 0; 2 * i < marks_.size(); ++i) marks_[i] = marks_[2 * i];
  marks_.resize((marks_.size() + 1) / 2);
  stride_ *= 2;
}

double Prediction::time_at(std::uint64_t move) const {
  const auto next = std::ranges::upper_bound(marks_, move, {}, &Mark::move);
  return next == marks_.begin() ? 0.0 : std::prev(next)->time;
}

namespace {

/// However a thread leaves: the other one does not wait for it.
class Abandoning {
 public:
  explicit Abandoning(PathQueue& queue) : queue_(queue) {}
  Abandoning(const Abandoning&) = delete;
  Abandoning& operator=(const Abandoning&) = delete;
  ~Abandoning() { queue_.abandon(); }

 private:
  PathQueue& queue_;
};

/// The first stage: the job's path and rests. The error that the job would end with.
std::optional<Error> run_through(const PredictionInput& input, PathQueue& path,
                                 const std::stop_token& stop) {
  config::ParameterStore parameters = input.parameters;
  config::ToolTable tools = input.tools;
  interp::Interpreter interpreter(interpreter_settings(input.config, input.macros), parameters,
                                  tools);
  if (input.begins_with) interpreter.set_state(*input.begins_with);
  motion::Planner planner(planner_settings(input.config), input.start,
                          std::make_unique<PathRelay>(path));
  JobRunner runner(input.config, interpreter, planner, JobRunner::Detail::times);
  runner.start(input.program, input.start, interp::SpindleDirection::off, interp::RunMode::render);
  std::uint64_t move = 0;  // the last one that has been handed on
  while (!stop.stop_requested()) {
    switch (runner.next()) {
      case JobRunner::Next::setpoint: {
        // The path comes without times; what takes time is a dwell.
        const motion::Setpoint& setpoint = runner.setpoint();
        move = setpoint.tag.id;
        if (setpoint.duration > 0.0) path.add(Rest{setpoint.duration, move});
        break;
      }
      case JobRunner::Next::action:
        path.add(Rest{0.0, move});
        runner.action_done();
        break;
      case JobRunner::Next::note:
      case JobRunner::Next::busy:
        break;
      case JobRunner::Next::failed:
        return runner.error();
      case JobRunner::Next::held:  // nobody holds here
      case JobRunner::Next::ended:
        return std::nullopt;
    }
  }
  return std::nullopt;
}

/// The second stage: a machine without a clock on the path that comes.
class Timing {
 public:
  Timing(const config::MachineConfig& config, PathQueue& path)
      : path_(path), profile_(motion::make_profile(planner_settings(config))) {}

  [[nodiscard]] Prediction run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (const auto stretch = go_on()) {
        prediction_.add(stretch->duration, stretch->tag.id);
        profile_->forget_before(profile_->place());
      } else if (const auto* rest = next<Rest>()) {
        prediction_.add(rest->duration, rest->move);
        path_.pop();
      } else {
        break;
      }
    }
    return std::move(prediction_);
  }

 private:
  /// The next item if it is a T.
  template <typename T>
  [[nodiscard]] const T* next() {
    return std::get_if<T>(path_.front());
  }

  /// Like the planner: the plan does not depend on when the path comes. Whether some came.
  bool take_in() {
    bool appended = false;
    while (profile_->extend() && !profile_->well_stocked()) {
      const auto* piece = next<motion::Piece>();
      if (piece == nullptr) break;
      profile_->append(*piece);
      path_.pop();
      appended = true;
    }
    profile_->plan();
    return appended;
  }

  [[nodiscard]] std::optional<motion::Stretch> go_on() {
    if (!profile_->sufficient()) (void)take_in();
    do {
      profile_->prepare(false);
    } while (!profile_->sufficient() && take_in());
    return profile_->skip();
  }

  PathQueue& path_;
  std::unique_ptr<motion::Profile> profile_;
  Prediction prediction_;
};

}  // namespace

std::optional<Prediction> predict(const PredictionInput& input, std::stop_token stop) {
  PathQueue path;
  const std::stop_callback end_waiting(stop, [&] { path.abandon(); });
  auto timed = std::async(std::launch::async, [&] {
    const Abandoning at_end(path);
    return Timing(input.config, path).run(stop);
  });
  const Abandoning at_end(path);  // before `timed` waits for its thread
  auto error = run_through(input, path, stop);
  path.close();
  Prediction prediction = timed.get();
  if (stop.stop_requested()) return std::nullopt;
  prediction.error = std::move(error);
  return prediction;
}

}  // namespace cnc::server
