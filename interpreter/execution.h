// Carrying out one checked block: its items in the order of table 3-7, all or nothing.
//
// Execution is what a handler sees: the block, the state to change, the tables to read and the
// queue of commands. A refusal in any item puts state, queue and parameters back. Behind an item
// whose command waits for an answer (a stop, a tool change, a probe move) execution pauses: what
// follows on the line begins where the machine then stands.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "interpreter/answer.h"
#include "interpreter/block.h"
#include "interpreter/canonical.h"
#include "interpreter/interpreter_settings.h"
#include "interpreter/machine_state.h"
#include "interpreter/parameter_names.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

/// Commands that may wait in the queue behind a held-back move (cutter_compensation.h): they tell
/// nothing of where the machine is and hold no text of their own.
template <typename Body, typename... Bodies>
inline constexpr bool kIsOneOf = (std::is_same_v<Body, Bodies> || ...);
template <typename Body>
inline constexpr bool kMayBeHeldBack =
    kIsOneOf<Body, RapidMove, FeedMove, ArcMove, Dwell, SetFeedRate, SetPathMode, SelectPlane,
             UseLengthUnit, UseToolLength, SetSpindleSpeed, UseSurfaceSpeed, TurnSpindle,
             SetCoolant, SelectTool, EnableOverrides, Message>;

class Execution {
 public:
  Execution(const InterpreterSettings& settings, config::ParameterStore& parameters,
            config::ToolTable& tools, ParameterNames& names);

  /// Executes those `steps` of `block`, which check_block() has accepted. steps_left() tells where
  /// it has paused; run() with these once the answer is there.
  Accepted run(const Block& block, SourceLine source, StepSet steps);
  [[nodiscard]] StepSet steps_left() const { return steps_left_; }
  /// Whether the last line that did anything ended with a stop: M0.
  [[nodiscard]] bool stopped_last() const { return stopped_last_; }
  void forget_steps() { steps_left_ = 0; }
  /// Takes over what a refused line has meant: its modes, its feed and the end of its move, as far
  /// as each of them can be carried out. Gives no commands.
  void assume_done(const Block& block, SourceLine source);
  /// What tolerate() has let pass in the last run().
  [[nodiscard]] Habit habit() const { return habit_; }
  [[nodiscard]] Span habit_span() const { return habit_span_; }

  // --- for the handlers ---
  [[nodiscard]] const Block& block() const { return *block_; }
  /// Ten times the G number, or the M number, of the code that is being executed.
  [[nodiscard]] std::int32_t code() const { return code_->number; }
  [[nodiscard]] Step step() const { return code_->step; }
  [[nodiscard]] std::string_view code_name() const { return code_->name; }
  [[nodiscard]] Span code_span() const { return code_span_; }

  [[nodiscard]] MachineState& state() { return state_; }
  [[nodiscard]] const MachineState& state() const { return state_; }
  [[nodiscard]] const config::ToolTable& tools() const { return tools_; }
  [[nodiscard]] const InterpreterSettings& settings() const { return settings_; }

  template <typename Body>
  void emit(const Body& body) {
    if constexpr (!kMayBeHeldBack<Body>) release_held();
    if constexpr (kWaitsForAnswer<Body>) waits_ = true;
    commands_.emplace_back(body, source_);
  }

  /// Asks the operator; waits for the answer.
  void ask(Dialog dialog);
  /// A parameter as the program sees it.
  [[nodiscard]] double parameter(std::int32_t number) const;
  /// Writes a parameter at once, in the program's unit.
  void set_now(std::int32_t number, double value);
  [[nodiscard]] const config::ParameterStore& parameters() const { return parameters_; }
  /// Written when the whole line has succeeded.
  void set_six(std::int32_t first, const Position& position);
  void set_parameter(std::int32_t number, double value) { writes_.push_back({number, value}); }

  /// The line has something that the manual does not allow: refused where the settings are strict.
  Accepted tolerate(Habit habit, Span span);
  /// The line ends with a stop.
  void note_stop() { stopped_last_ = true; }

  /// From the first spindle, which has none.
  [[nodiscard]] const Position& head_offset(Head head) const {
    return head_offsets_.at(static_cast<std::size_t>(head));
  }
  /// The offset of a head as it has been measured, kept when the whole line has succeeded.
  void keep_head_offset(const StoreHeadOffset& measured);

  /// Marks the program as ended after this line.
  void end_program() { program_ended_ = true; }

  // --- for the interpreter ---
  [[nodiscard]] std::vector<Command>& commands() { return commands_; }
  [[nodiscard]] const std::vector<Command>& commands() const { return commands_; }
  /// Commands of the queue that can be handed out; the others wait for the next move of a contour.
  [[nodiscard]] std::size_t ready_count() const {
    return state_.compensation.held.value_or(commands_.size());
  }
  /// Those that were handed out.
  void drop_commands(std::size_t count);
  /// The held-back move ends where it would without a corner.
  void release_held() { state_.compensation.held.reset(); }
  [[nodiscard]] bool program_ended() const { return program_ended_; }
  /// The line of commands that are emitted outside of run(); the program goes on.
  void begin(SourceLine source) {
    source_ = source;
    program_ended_ = false;
  }
  /// What the world says about `command`, the last one of the queue that it has seen.
  void take(const Answer& answer, const CommandBody& command);
  /// Why `answer` cannot be taken: a value that its parameter cannot have.
  [[nodiscard]] Accepted check(const Answer& answer, const CommandBody& command) const;
  /// What it would say if everything went as programmed.
  [[nodiscard]] Answer expected_answer(const CommandBody& command) const;
  /// Reads work system and offsets from the parameters again; emits what has changed.
  void reload_offsets();
  /// Looks up the tool length in force again; emits it when it has changed.
  void reload_tool_length();
  /// Along X and Z, mm; emits it when it has changed.
  void use_tool_length(double x, double z);

 private:
  struct ParameterWrite {
    std::int32_t number;
    double value;
  };

  /// What undo() needs.
  struct Before {
    std::variant<PlainState, MachineState> state;
    std::size_t commands = 0;
  };

  /// Whether those steps of the block can change nothing but a PlainState.
  [[nodiscard]] bool is_plain(StepSet steps) const;
  [[nodiscard]] Before remember(StepSet steps);
  Accepted run_steps(StepSet steps);
  /// Refuses commands from `first` on that would turn A against its brake.
  [[nodiscard]] Accepted check_clamp(double a, std::size_t first) const;
  [[nodiscard]] Accepted check_settings() const;
  void undo(const Before& before);
  void apply_settings();
  void apply_writes();

  const InterpreterSettings& settings_;
  config::ParameterStore& parameters_;
  config::ToolTable& tools_;
  ParameterNames& names_;

  MachineState state_;
  std::vector<Command> commands_;
  std::vector<Command> held_before_;  ///< for undo(): the next move may change held-back ones
  std::vector<ParameterWrite> writes_;
  std::array<Position, kHeadCount> head_offsets_;
  std::optional<StoreHeadOffset> measured_head_;
  bool program_ended_ = false;
  bool waits_ = false;  ///< a command of this run() waits for an answer
  StepSet steps_left_ = 0;
  bool stopped_last_ = false;
  Habit habit_ = Habit::none;
  Span habit_span_;
  Dialog dialog_;

  const Block* block_ = nullptr;
  const Code* code_ = nullptr;
  Span code_span_;
  SourceLine source_;
};

}  // namespace cnc::interp
