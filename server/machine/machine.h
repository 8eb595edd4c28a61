// The machine: the one owner of its state.
//
// Every command and every cycle runs on the executor thread (or in the simulator's loop); nothing
// here locks, sleeps or waits. Commands that take time answer through a completion, which is called
// exactly once, on the same thread. A command that the state does not allow is refused at once with
// the sentence of the state table and changes nothing.
//
//   cycle():  link status ─► faults ─► job / homing / jog ─► segments ─► snapshot
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/machine_config.h"
#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "server/job/job_analysis.h"
#include "server/job/job_control.h"
#include "server/machine/homing.h"
#include "server/machine/jog_control.h"
#include "server/machine/machine_io.h"
#include "server/machine/message_log.h"
#include "server/machine/motion_feed.h"
#include "server/machine/obstacle_watch.h"
#include "server/machine/persistence.h"
#include "server/machine/position_trust.h"
#include "server/machine/seldom.h"
#include "server/machine/snapshot.h"

namespace cnc::server {

using Completion = std::function<void(Result<void>)>;

struct MachineData {
  config::MachineConfig config;
  config::ParameterStore parameters;
  config::ToolTable tools;
  std::filesystem::path parameter_file;  ///< empty: nothing is saved
  std::filesystem::path tool_file;       ///< empty: tools are not saved
  std::filesystem::path config_file;     ///< empty: measured head offsets are not saved
  std::filesystem::path program_folder;  ///< what programs write goes here; empty: nowhere
  std::vector<std::filesystem::path> macro_files;  ///< macro.cnc, then user_macro.cnc
  interp::Library macros;                          ///< instead of files
  bool analyse_jobs = true;  ///< check and predict a loaded job in the background
  MotionFeed::Clock clock;   ///< what computing takes; none: it takes no time
};

struct WorkCoordinate {
  Axis axis = Axis::X;
  double value = 0.0;
};

class Machine {
 public:
  Machine(MachineData data, Link& link, MessageLog& log);
  ~Machine();

  /// To be called at a steady pace, every few milliseconds; `now` is a monotonic clock in seconds.
  void cycle(double now);

  void reset(Completion done);
  /// Homes `axes` one after the other; none given: all connected axes, Z first.
  void home(std::vector<Axis> axes, Completion done);
  void mdi(const std::string& line, Completion done);
  /// Runs a sub of the macro files, as a button does. Homing subs are allowed before homing.
  void run_sub(std::string_view name, Completion done);
  /// Answers the question with this number; `values` for its fields, or none to leave them.
  Result<void> answer(std::uint64_t question, bool confirmed, std::vector<double> values);
  void pause(Completion done);
  void stop(Completion done);
  Result<void> run();
  Result<void> resume();
  Result<void> rewind();
  Result<void> load(std::shared_ptr<const interp::Program> program, std::string path);
  /// Rates are parts of the maximum velocity, -1 … 1; the machine stops when `lease` seconds pass
  /// without another call.
  Result<void> jog(const Position& rates, double lease);
  Result<void> jog_step(Axis axis, double distance, double rate);
  void jog_stop();
  Result<Overrides> set_overrides(const Overrides& overrides);
  Result<void> set_work_zero(const std::vector<WorkCoordinate>& coordinates);
  /// The operator has checked where the axes stand; none given: all that are not trusted.
  Result<void> accept_position(const std::vector<Axis>& axes);
  /// Answers when parameters and offsets as they are now are on disk.
  void when_saved(Completion done);
  /// Blocks until what programs have written is on disk.
  void wait_for_files() { files_.wait(); }
  /// Brings everything to a standstill and saves; for the end of the program.
  void shut_down();
  [[nodiscard]] bool is_shut_down() const;

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const Overrides& overrides() const { return job_.overrides(); }
  [[nodiscard]] const config::MachineConfig& config() const { return data_.config; }
  [[nodiscard]] std::shared_ptr<const interp::Program> program() const { return program_; }
  [[nodiscard]] std::shared_ptr<const JobFindings> findings() const;
  /// Thread-safe.
  [[nodiscard]] const SnapshotBoard& snapshots() const { return snapshots_; }
  /// Where the machine stands when that is not where the last setpoint led.
  void set_restart_listener(std::function<void(const Position&)> listener) {
    feed_.set_restart_listener(std::move(listener));
  }
  /// Is called when the connection to the board is lost.
  void set_loss_listener(std::function<void()> listener) { loss_listener_ = std::move(listener); }
  /// Is called with "estop", "link_lost", "board_reset" … when the board has stopped by itself.
  void set_fault_listener(std::function<void(std::string_view)> listener) {
    fault_listener_ = std::move(listener);
  }
  /// The last so many setpoints were replaced before the board began them.
  void set_cut_listener(std::function<void(std::size_t)> listener) {
    feed_.set_cut_listener(std::move(listener));
  }
  /// What the motors get for each setpoint.
  void set_motor_listener(std::function<void(const motion::Setpoint&)> listener) {
    feed_.set_motor_listener(std::move(listener));
  }
  /// Every setpoint that leaves, for recorders.
  void set_setpoint_listener(std::function<void(const motion::Setpoint&)> listener) {
    feed_.set_listener(std::move(listener));
  }

 private:
  enum class WaitFor : std::uint8_t { reset, home, mdi, pause, rest };
  struct Waiter {
    WaitFor what;
    Completion done;
  };

  [[nodiscard]] Result<void> allow(CommandKind command) const;
  void analyse();
  void take_findings();
  [[nodiscard]] Result<void> interpret_now(std::string line);
  void run_text(std::string text, std::string name);
  [[nodiscard]] Result<void> check_clamp(Axis axis) const;
  void watch_home_switches();
  void load_macros();
  void use_macros(interp::Library macros);
  Result<void> keep_head(const interp::StoreHeadOffset& store);
  [[nodiscard]] std::optional<std::string> homing_subs(const std::vector<Axis>& axes,
                                                       bool all) const;
  [[nodiscard]] bool has_sub(std::string_view name) const;
  void wait_for(WaitFor what, Completion done);
  void settle(WaitFor what, const Result<void>& result);
  /// A good result is told when it is on disk: whoever hears of it may rely on it.
  void settle_when_saved(WaitFor what, const Result<void>& result);
  [[nodiscard]] std::vector<Completion> take_waiters(WaitFor what);
  void enter(State state) { state_ = state; }
  [[nodiscard]] State working_state() const { return single_line_ ? State::mdi : State::running; }
  [[nodiscard]] State resting_state() const;

  void watch_board();
  void take_board();
  void lose_board();
  void on_fault(hal::Faults faults);
  void on_further_fault(hal::Faults faults);
  void tell_fault(std::string_view name) const;
  void watch_guards();
  void watch_standstill();
  void watch_drives(bool on);
  void obey_guard();
  void watch_path_stop();
  void stop_at_once(Error error);
  void end_everything(Error error);
  void quick_stop();
  void lose_trust(TrustEvent event, const AxisArray<bool>& axes);
  void cycle_job();
  void on_job_signal(JobSignal signal);
  void wait_for_operator(State state);
  void home_for_job();
  void end_homing_for_job();
  void cycle_homing();
  void cycle_jog();
  void cycle_stop();
  void cycle_reset();
  [[nodiscard]] bool is_motionless() const;
  void begin_stop();
  void end_job(const Result<void>& result);
  void come_to_rest();
  void save_parameters() { saver_.save(data_.parameters, data_.tools); }
  void answer_saved();
  [[nodiscard]] MachineSnapshot take_snapshot();
  [[nodiscard]] JobSnapshot take_job_snapshot();
  [[nodiscard]] std::optional<QuestionSnapshot> take_question_snapshot() const;
  [[nodiscard]] double predicted_time_done(double rate) const;

  MachineData data_;
  MessageLog& log_;
  MotionFeed feed_;
  MachineIo io_;
  ProgramFiles files_;
  interp::Interpreter interpreter_;
  JobControl job_;
  Homing homing_;
  JogControl jog_;
  StateSaver saver_;
  SnapshotBoard snapshots_;

  State state_ = State::off;
  double now_ = 0.0;
  double last_cycle_ = 0.0;
  std::uint64_t sequence_ = 0;
  PositionTrust trust_;
  std::uint32_t session_ = 0;  // with the board; 0: it was never there
  std::array<std::uint8_t, config::kGuardRules> guard_counts_{};  // of it, as seen
  std::array<Seldom, config::kGuardRules> guard_messages_;
  hal::Faults faults_ = 0;           // the board's, as seen
  std::optional<Error> guard_stop_;  // why the board stops, until it stands
  double was_sane_at_ = 0.0;         // watch_standstill()
  AxisArray<bool> home_switches_{};  // as seen in the last cycle
  std::vector<Waiter> waiters_;
  std::vector<std::pair<StateSaver::Ticket, Completion>> waiting_for_disk_;
  bool single_line_ = false;                   // what job_ executes is an MDI line
  State waiting_state_ = State::program_stop;  // of the job that waits for the operator
  std::uint64_t question_ = 0;                 // number of the last question
  interp::Library macros_;
  std::vector<std::filesystem::file_time_type> macro_times_;
  bool reset_wanted_ = false;
  double reset_deadline_ = 0.0;
  bool reset_is_sent_ = false;
  bool shutting_down_ = false;
  std::function<void()> loss_listener_;
  ObstacleWatch obstacle_watch_;
  std::function<void(std::string_view)> fault_listener_;

  std::shared_ptr<const interp::Program> program_;
  std::string program_path_;
  std::unique_ptr<JobAnalysis> analysis_;
  std::shared_ptr<const JobFindings> findings_;
  std::string told_finding_;  // the last warning about the loaded job
  double elapsed_ = 0.0;
  std::uint64_t move_ = 0;   // of the job, in execution
  double move_began_ = 0.0;  // elapsed_ then
  std::uint64_t line_ = 0;
  std::uint64_t runs_ = 0;
  bool ended_well_ = false;
};

}  // namespace cnc::server
