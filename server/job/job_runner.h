// From a program to setpoints: the only translator between the interpreter and the planner.
//
// A plain object that is pulled, with no thread and no clock. next() says what comes next in the
// order of execution: a setpoint; an action that has to wait until the machine stands still
// (spindle on or off, tool change, stop, end); or a note that belongs to that instant but stops
// nothing (a message, coolant, a new speed or work offset). The real run, the prediction of job
// time and the simulator use this same object and differ only in what they do with the answers.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "config/machine_config.h"
#include "interpreter/interpreter.h"
#include "motion/extents.h"
#include "motion/planner.h"

namespace cnc::server {

/// A canonical command to be acted on outside the planner. `text` is the message's own copy.
struct JobEvent {
  interp::Command command;
  std::string text;
};

class JobRunner {
 public:
  enum class Next : std::uint8_t {
    setpoint,  ///< setpoint()
    note,      ///< event(): show it, go on
    action,    ///< event(): perform it once the machine stands still, then call action_done()
    busy,      ///< the interpreter's line budget ran out, call again
    held,      ///< standing still after hold(), or because an override is 0
    ended,     ///< every setpoint and action has been handed out
    failed,    ///< error(); everything before the faulty line has been handed out
  };

  /// Whether setpoints are whole, or have their duration and their tag only: whoever predicts times
  /// needs no more, and gets them along the same plan much faster.
  enum class Detail : std::uint8_t { whole, times };

  /// All references outlive the runner.
  JobRunner(const config::MachineConfig& config, interp::Interpreter& interpreter,
            motion::Planner& planner, Detail detail = Detail::whole);

  /// Starts a program; the machine stands at `position`, its spindle turns as `spindle` says.
  void start(std::shared_ptr<const interp::Program> program, const Position& position,
             interp::SpindleDirection spindle = interp::SpindleDirection::off,
             interp::RunMode mode = interp::RunMode::run);

  [[nodiscard]] Next next();
  [[nodiscard]] const motion::Setpoint& setpoint() const { return setpoint_; }
  [[nodiscard]] const JobEvent& event() const { return event_; }
  /// The feed of a probe move that is in hand, mm/s.
  [[nodiscard]] double feed_of(const interp::ProbeMove& move) const {
    return feed_of_line(move.end);
  }
  [[nodiscard]] const Error& error() const { return *error_; }
  /// The speed that the spindle was measured to turn at, rpm: for the synchronised move in hand.
  void set_measured_speed(double rpm) { measured_speed_ = rpm; }
  /// With `answer`: what became of a command that waits for one, and where the machine stands now.
  /// Without: everything went as programmed.
  void action_done(const std::optional<interp::Answer>& answer = std::nullopt);

  /// Brakes along the path; next() answers `held` once everything until standstill is handed out.
  /// A dwell stands still as it is and goes on where it was interrupted.
  void hold();
  void resume();

  // What the controller has not begun can be taken back and is then handed out anew: setpoints
  // after hold(), resume() or new overrides of the planner, each dwell for as long as it has left,
  // and notes at their place. Setpoints only until it is known whether the controller has dropped
  // the old ones (motion/planner.h). Never back over an action.

  /// Only the last `count` setpoints may still be taken back.
  void forget_all_but(std::size_t count);
  /// False, and nothing changed, when they are not known any more.
  bool take_back(std::size_t count);
  void confirm_take_back();
  [[nodiscard]] bool unconfirmed() const { return unconfirmed_; }
  void revoke_take_back();

  /// Drops what is left of the program. Only when standing still.
  void abandon();
  /// What a height map may add to Z: moves stay as far away from the ends of its travel.
  void set_height_range(double lowest, double highest) {
    lowest_added_ = lowest;
    highest_added_ = highest;
  }
  [[nodiscard]] bool running() const { return running_; }

 private:
  void take_modes(const interp::ModalState& modal);
  void fill_planner();
  [[nodiscard]] std::optional<motion::Setpoint> draw();
  [[nodiscard]] std::optional<motion::Setpoint> draw(motion::Supply supply);
  [[nodiscard]] bool ought_to_move() const;
  Next fail_without_motion();
  [[nodiscard]] bool notes_are_many() const;
  void take(const interp::Command& command);
  [[nodiscard]] Next give_note();
  [[nodiscard]] Next give_dwell();
  [[nodiscard]] bool waits_for_dwell() const;
  void forget_given();
  [[nodiscard]] std::size_t dwells_behind(std::uint64_t number) const;
  [[nodiscard]] bool is_motion(const interp::CommandBody& body) const;
  [[nodiscard]] Result<void> queue_motion(const interp::Command& command);
  [[nodiscard]] Result<void> queue_line(const Position& end, const motion::MoveOptions& options);
  [[nodiscard]] Result<void> queue_feed_line(const interp::Command& command, const Position& end);
  [[nodiscard]] Result<void> queue_arc(const motion::ArcShape& shape, motion::MoveOptions options);
  [[nodiscard]] motion::MoveOptions options_for(const interp::Command& command,
                                                motion::MoveKind kind);
  void take_sync_move(const interp::Command& command);
  void queue_thread(bool goes_on);
  [[nodiscard]] Result<void> queue_sync_move(const interp::Command& command, bool goes_on);
  [[nodiscard]] motion::MoveOptions beside_limits(motion::MoveOptions options,
                                                  const motion::Extents& extents) const;
  [[nodiscard]] Result<void> check_space(const motion::Extents& extents) const;
  [[nodiscard]] double feed_of_line(const Position& end) const;
  [[nodiscard]] bool feed_depends_on_way() const;
  [[nodiscard]] double feed_along(const motion::Curve& curve, const motion::Extents& extents) const;
  [[nodiscard]] double tip_way(const motion::Curve& curve) const;
  [[nodiscard]] double turns_per_second(const motion::Extents& extents) const;
  [[nodiscard]] bool feed_depends_on_radius() const;
  [[nodiscard]] motion::Extents with_height_map(motion::Extents extents) const;
  void fail_with(Error error, interp::SourceLine source);
  [[nodiscard]] bool item_is_due() const;

  const config::MachineConfig& config_;
  interp::Interpreter& interpreter_;
  motion::Planner& planner_;

  bool running_ = false;
  bool program_over_ = false;
  std::uint64_t last_move_ = 0;
  interp::SetFeedRate feed_;
  interp::SetPathMode path_mode_;
  interp::RunMode mode_ = interp::RunMode::run;
  bool guards_machine_ = true;
  bool guards_tool_change_ = true;
  double lowest_added_ = 0.0;  // to Z, by a height map
  double highest_added_ = 0.0;
  double spindle_speed_ = 0.0;                            // programmed, rpm
  std::optional<interp::UseSurfaceSpeed> surface_speed_;  // instead of it

  /// A note, or a dwell (G4, or a spindle that runs up) of so many seconds.
  struct DueItem {
    std::uint64_t after_move = 0;
    std::variant<JobEvent, double> what;
  };
  struct GivenItem {
    std::uint64_t number = 0;  ///< of the setpoint before the note, or of the dwell's own
    DueItem item;
  };
  struct TakenBack {
    std::uint64_t number = 0;
    std::uint64_t last = 0;  ///< number of the last setpoint that was kept
    std::deque<DueItem> due;
    std::deque<GivenItem> given;
    std::optional<motion::Setpoint> drawn;
  };
  std::deque<DueItem> due_;                 ///< in the order of the program
  std::deque<GivenItem> given_;             ///< what may be taken back
  std::uint64_t number_ = 0;                ///< of the last setpoint handed out
  TakenBack taken_back_;                    ///< as it was before
  bool unconfirmed_ = false;                ///< it is not known yet what becomes of it
  std::optional<JobEvent> pending_action_;  ///< the planner runs empty, then it is handed out
  bool held_ = false;
  /// A thread's move waits for the next command: only the last one of a thread ends at rest.
  std::optional<interp::Command> thread_move_;
  bool in_thread_ = false;       // the first move of the thread has been queued or waits
  double measured_speed_ = 0.0;  // rpm
  bool begins_at_index_ = false;
  interp::SpindleDirection spindle_ = interp::SpindleDirection::off;
  bool more_to_come_ = false;  // the planner is not full, but the rest takes another call
  Detail detail_;
  std::optional<motion::Setpoint> drawn_;  ///< drawn from the planner, a note or dwell goes first
  Position before_drawn_;
  motion::Setpoint setpoint_;
  JobEvent event_;
  std::optional<Error> error_;
  std::shared_ptr<const interp::Program> program_;
};

}  // namespace cnc::server
