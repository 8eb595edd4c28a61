// The job (or single line) that runs: pulls the runner, sends setpoints, performs actions, and
// tells the machine when something happens that changes its state. Executor thread only.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/job/job_runner.h"
#include "server/machine/height_map.h"
#include "server/machine/machine_io.h"
#include "server/machine/message_log.h"
#include "server/machine/motion_feed.h"
#include "server/machine/probe_motion.h"
#include "server/machine/program_files.h"

namespace cnc::server {

enum class JobSignal : std::uint8_t {
  none,
  standing,      ///< hold() has brought the machine to rest
  program_stop,  ///< M0 M1 M60: resume() goes on
  tool_change,   ///< M6: resume() goes on
  question,      ///< dlgmsg: answer_question() goes on
  home,          ///< home x: home_request(); home_done() goes on
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

  bool operator==(const Overrides&) const = default;
};

class JobControl {
 public:
  JobControl(const config::MachineConfig& config, interp::Interpreter& interpreter,
             const config::ParameterStore& parameters, MotionFeed& feed, MachineIo& io,
             ProgramFiles& files, MessageLog& log);

  /// A job ends with spindle and coolant off; a single line leaves them as they are.
  enum class Kind : std::uint8_t { job, single_line };
  void start(std::shared_ptr<const interp::Program> program, Kind kind);
  /// hold(), resume() and set_overrides() act from the first segment on that the board has not
  /// begun and that can still be replaced, within 10 ms; on a thread, a probe move and overrides
  /// that the program sets, behind what is under way.
  void hold();
  void resume();
  /// What the program asks; nullptr when it asks nothing. Valid until it is answered.
  [[nodiscard]] const interp::Dialog* question() const;
  /// Why the answer cannot be taken: a value that its parameter cannot have.
  [[nodiscard]] std::optional<Error> refusal_of_answer(bool confirmed,
                                                       const std::vector<double>& values) const;
  /// Cancelled, or confirmed with a value for each field (none: they stay).
  void answer_question(bool confirmed, std::vector<double> values);
  [[nodiscard]] interp::HomeAxis home_request() const;
  /// Is called with a head's offset that a program has measured (M91 … M97 Q1).
  void set_head_keeper(std::function<Result<void>(const interp::StoreHeadOffset&)> keeper) {
    keep_head_ = std::move(keeper);
  }
  void home_done();
  /// Whether home switches act as estop (HomeIsEstop), and which axes are clamped (M26).
  [[nodiscard]] bool home_is_estop() const { return home_is_estop_; }
  [[nodiscard]] const AxisArray<bool>& clamped() const { return clamped_; }
  [[nodiscard]] bool waits_for_operator() const {
    return waits_for_ == WaitsFor::operator_ || waits_for_ == WaitsFor::answer;
  }
  /// At rest only: drops the rest of the program.
  void abandon();

  [[nodiscard]] JobSignal cycle();
  /// G96: gives the spindle its speed for where the tool is now, job or not.
  void follow_surface_speed();
  [[nodiscard]] const Error& error() const { return *error_; }
  [[nodiscard]] bool active() const { return active_; }
  [[nodiscard]] bool probing() const { return probe_.active(); }

  void set_overrides(const Overrides& overrides);
  [[nodiscard]] const Overrides& overrides() const { return overrides_; }
  [[nodiscard]] bool overrides_enabled() const { return feed_override_enabled_; }
  [[nodiscard]] std::int32_t tool() const { return tool_; }
  [[nodiscard]] std::int32_t selected_tool() const { return selected_tool_; }
  [[nodiscard]] ShownOffsets offsets() const;
  /// Line of the program that is executed now, 0 before the first.
  [[nodiscard]] std::uint32_t line() const { return line_; }

 private:
  /// A note to be shown behind a segment. What it switches travels with the next one, so that it
  /// happens at its very step (3.5.5, 3.5.2); it is then shown when that one has begun.
  struct DueNote {
    MotionFeed::Id after_segment = 0;
    JobEvent event;
    SpindleSpeed speed;               // behind it
    MotionFeed::Id with_segment = 0;  // 0: with none yet, or nothing to switch
    hal::OutputChange change{};
    std::uint64_t ticket = 0;  // MachineIo's
  };

  /// What the action in hand waits for.
  enum class WaitsFor : std::uint8_t { nothing, operator_, answer, homing, probe, input, spindle };

  void replan();
  void cut_and_go_on(std::size_t count);
  [[nodiscard]] bool wants_more() const;
  void draw_replacement();
  [[nodiscard]] bool cut_is_settled();
  void undo_cut();
  [[nodiscard]] JobSignal perform(const JobEvent& event);
  [[nodiscard]] JobSignal wait_for(WaitsFor what, JobSignal signal);
  [[nodiscard]] JobSignal start_probe(const interp::ProbeMove& move);
  [[nodiscard]] JobSignal cycle_probe();
  [[nodiscard]] JobSignal cycle_input();
  [[nodiscard]] JobSignal cycle_spindle();
  [[nodiscard]] JobSignal signal_of(const Result<void>& deed);
  [[nodiscard]] JobSignal fail_with(Error error);
  void go_on(interp::Answer answer);
  [[nodiscard]] Result<void> change_height_map(const interp::ChangeHeightMap& change,
                                               const std::string& name);
  [[nodiscard]] Result<void> follow(std::shared_ptr<const motion::HeightSurface> surface);
  [[nodiscard]] JobSignal finish(JobSignal how);
  [[nodiscard]] Result<void> emit(const motion::Setpoint& setpoint);
  [[nodiscard]] bool is_due(const DueNote& note) const;
  void note(const JobEvent& event);
  [[nodiscard]] SpindleSpeed speed_shown() const;
  void plan_speeds();
  void show_due_notes();
  void withdraw_notes();
  void show(const JobEvent& event);
  void apply_overrides();
  [[nodiscard]] double speed_reached(double override) const;

  const config::MachineConfig& config_;
  interp::Interpreter& interpreter_;
  const config::ParameterStore& parameters_;
  MotionFeed& feed_;
  MachineIo& io_;
  ProgramFiles& files_;
  MessageLog& log_;
  motion::Planner planner_;
  JobRunner runner_;

  Kind kind_ = Kind::job;
  bool active_ = false;
  WaitsFor waits_for_ = WaitsFor::nothing;
  std::function<Result<void>(const interp::StoreHeadOffset&)> keep_head_;
  bool home_is_estop_;
  AxisArray<bool> clamped_{};
  ProbeMotion probe_;
  Position probe_position_;  // of the last probe move that tripped
  HeightMap height_map_;
  std::optional<interp::UseSurfaceSpeed> surface_speed_;
  double wait_began_ = 0.0;    // board time at which an input or the spindle began to be waited for
  double speed_before_ = 0.0;  // of the spindle, rpm: a steady one does not change
  double speed_checked_ = 0.0;  // board time then
  Overrides overrides_;
  bool feed_override_enabled_ = true;
  bool speed_override_enabled_ = true;
  std::int32_t tool_ = 0;
  std::int32_t selected_tool_ = 0;
  std::uint32_t line_ = 0;
  ShownOffsets offsets_;
  std::deque<DueNote> notes_;
  std::deque<DueNote> notes_before_cut_;
  bool replan_wanted_ = false;  // once it is known what became of the cut under way
  std::optional<Error> error_;
};

}  // namespace cnc::server
