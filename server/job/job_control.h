// The job (or single line) that runs: pulls the runner, sends setpoints, performs actions, and
// tells the machine when something happens that changes its state. Executor thread only.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "server/job/job_runner.h"
#include "server/machine/machine_io.h"
#include "server/machine/message_log.h"
#include "server/machine/motion_feed.h"

namespace cnc::server {

enum class JobSignal : std::uint8_t {
  none,
  standing,      ///< hold() has brought the machine to rest
  program_stop,  ///< M0 M1: resume() goes on
  tool_change,   ///< M6: resume() goes on
  ended,
  failed,  ///< error()
};

/// Offsets as they apply to the move in execution (the interpreter is ahead of it).
struct ShownOffsets {
  std::int32_t system = 1;
  Position work;
  Position g92;
  Position tool;

  [[nodiscard]] Position total() const { return work + g92 + tool; }
};

struct Overrides {
  double feed = 1.0;
  double rapid = 1.0;
  double speed = 1.0;
};

class JobControl {
 public:
  JobControl(const config::MachineConfig& config, interp::Interpreter& interpreter,
             const config::ParameterStore& parameters, MotionFeed& feed, MachineIo& io,
             MessageLog& log);

  /// A job ends with spindle and coolant off; a single line leaves them as they are.
  enum class Kind : std::uint8_t { job, single_line };
  void start(std::shared_ptr<const interp::Program> program, Kind kind);
  void hold() { runner_.hold(); }
  void resume();
  /// At rest only: drops the rest of the program.
  void abandon();

  [[nodiscard]] JobSignal cycle();
  [[nodiscard]] const Error& error() const { return *error_; }
  [[nodiscard]] bool active() const { return active_; }

  void set_overrides(const Overrides& overrides);
  [[nodiscard]] const Overrides& overrides() const { return overrides_; }
  [[nodiscard]] bool overrides_enabled() const { return feed_override_enabled_; }
  [[nodiscard]] std::int32_t tool() const { return tool_; }
  [[nodiscard]] std::int32_t selected_tool() const { return selected_tool_; }
  [[nodiscard]] ShownOffsets offsets() const;
  /// Line of the program that is executed now, 0 before the first.
  [[nodiscard]] std::uint32_t line() const { return line_; }

 private:
  struct DueNote {
    std::uint32_t after_segment = 0;
    JobEvent event;
  };

  [[nodiscard]] JobSignal perform(const JobEvent& event);
  [[nodiscard]] JobSignal finish(JobSignal how);
  void show_due_notes();
  void show(const JobEvent& event);
  void apply_overrides();

  const config::MachineConfig& config_;
  interp::Interpreter& interpreter_;
  const config::ParameterStore& parameters_;
  MotionFeed& feed_;
  MachineIo& io_;
  MessageLog& log_;
  motion::Planner planner_;
  JobRunner runner_;

  Kind kind_ = Kind::job;
  bool active_ = false;
  bool waits_for_resume_ = false;  // an action has signalled and waits
  Overrides overrides_;
  bool feed_override_enabled_ = true;
  bool speed_override_enabled_ = true;
  std::int32_t tool_ = 0;
  std::int32_t selected_tool_ = 0;
  std::uint32_t line_ = 0;
  ShownOffsets offsets_;
  std::deque<DueNote> notes_;
  std::optional<Error> error_;
};

}  // namespace cnc::server
