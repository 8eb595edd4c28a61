// The inside of the Interpreter: reads line after line, follows if, while, sub and gosub through
// the job and the macro files, and hands blocks to Execution.
#pragma once

#include <bitset>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "interpreter/execution.h"
#include "interpreter/interpreter.h"
#include "interpreter/line_cache.h"
#include "interpreter/parameter_access.h"
#include "interpreter/sources.h"

namespace cnc::interp {

class Runner {
 public:
  Runner(const InterpreterSettings& settings, config::ParameterStore& parameters,
         config::ToolTable& tools);

  void set_library(const Library& library);
  void start(std::shared_ptr<const Program> program, const Position& position,
             const StartOptions& options);
  void stop();
  void reset();
  bool skip_failed_line();
  [[nodiscard]] ResumePoint resume_point() const;
  void leave_search(const Position& position);
  void set_block_delete(bool on) { settings_.block_delete = on; }

  [[nodiscard]] Progress next();
  [[nodiscard]] const Command& command() const;
  void answer(const Answer& answer);
  [[nodiscard]] std::optional<Error> refusal_of(const Answer& answer) const;
  void cancel_cutter_compensation() { end_compensation(execution_); }
  [[nodiscard]] Answer expected_answer() const;
  [[nodiscard]] const Diagnostic& diagnostic() const { return diagnostic_; }
  [[nodiscard]] const std::vector<Diagnostic>& warnings() const { return warnings_; }
  [[nodiscard]] const std::vector<Diagnostic>& library_warnings() const {
    return library_warnings_;
  }
  [[nodiscard]] std::string_view file_name(std::uint16_t file) const;
  [[nodiscard]] MachineState& state() { return execution_.state(); }
  [[nodiscard]] const MachineState& state() const { return execution_.state(); }
  [[nodiscard]] std::uint32_t next_line() const { return cursor_.line; }
  [[nodiscard]] std::uint64_t lines_run() const { return lines_run_; }
  [[nodiscard]] std::uint64_t lines_since_new() const { return lines_since_new_; }
  [[nodiscard]] bool ran_off_end() const { return ran_off_end_; }

 private:
  /// What is left of a line that called a sub in its middle.
  struct Rest {
    Block block;
    StepSet steps = 0;
  };
  /// A sub that has not returned yet.
  struct Call {
    std::uint16_t file = 0;  ///< to return to
    Program::Cursor return_to;
    std::uint32_t line = 0;  ///< that called
    Sources::Sub sub;
    std::int32_t m_code = -1;    ///< that the sub stands for
    std::unique_ptr<Rest> rest;  ///< to execute after the return
  };

  // runner.cpp: one line after the other
  void prepare(Line& line);
  void hand_out();
  [[nodiscard]] bool search_is_over() const;
  void pass_by(const CommandBody& command);
  Accepted run_line();
  Accepted run_again();
  Accepted run_rest_of_line();
  Accepted run_parsed(const Line& line);
  Accepted run_block(const Line& line);
  Accepted start_block(Block& block);
  Accepted execute(Block& block, StepSet steps);
  Accepted run_special(const Line& line);
  Accepted show_text(const Line& line);
  /// Computes the values of a line. False: the program has to wait for some of them first.
  Parsed<bool> evaluate_line(const Line& line);
  Accepted end_at_end_of_file();
  Accepted refuse_truncated();
  void assume_done(const Line& line);
  [[nodiscard]] Parsed<const Line*> parsed_line();
  [[nodiscard]] bool is_skipped() const;
  [[nodiscard]] SourceLine here() const { return {file_, line_number_}; }
  void enter_file(std::uint16_t file);

  // runner_flow.cpp: where the program goes on
  Accepted run_flow(const Line& line);
  Accepted run_condition(const Line& line, const FlowMark* partner);
  Accepted run_gosub(const Line& line);
  Accepted call(const Sources::Sub& sub, Span span, std::int32_t m_code,
                std::unique_ptr<Rest> rest);
  Accepted return_from_sub();
  void go_behind(const FlowMark& mark);
  /// The sub that stands for an M code of the block, if any and if it is not running already.
  [[nodiscard]] std::optional<Sources::Sub> sub_instead_of_m(const Block& block) const;
  [[nodiscard]] std::optional<Sources::Sub> sub_for_tool_change(const Block& block) const;
  [[nodiscard]] bool is_running(std::int32_t m_code) const;
  Accepted call_instead_of_m(const Block& block, const Sources::Sub& sub);
  Accepted call_for_tool_change(Block& block, const Sources::Sub& sub);
  void initialise(std::uint16_t file);
  Accepted initialise_line();

  // runner_diagnostics.cpp
  Progress fail(const Refusal& refusal);
  [[nodiscard]] Diagnostic diagnostic_of(const Refusal& refusal, Severity severity) const;
  /// Warns of a habit, or refuses it where the settings are strict.
  Accepted tolerate(Habit habit, Span span);
  void note_library(const Refusal& refusal);
  [[nodiscard]] CallSite site_of(const Call& call) const;

  InterpreterSettings settings_;
  ParameterNames names_;
  Execution execution_;
  ParameterAccess access_;
  Sources sources_;

  RunMode mode_ = RunMode::run;
  bool single_line_ = false;
  std::uint32_t search_line_ = 0;
  Position searched_;  ///< where the commands that a search has passed take the machine
  SetFeedRate searched_feed_;
  const Program* program_ = nullptr;  ///< that is being read; nullptr: nothing was started
  std::uint16_t file_ = Sources::kJob;
  Program::Cursor cursor_;         ///< of the line to read next
  std::uint32_t line_number_ = 0;  ///< of the line that runs
  std::string_view line_text_;
  std::vector<Call> calls_;
  LineCache cache_;
  Line scratch_;  ///< a line that runs for the first time
  Evaluation evaluation_;

  const Line* line_ = nullptr;  ///< that was parsed last
  Block* block_ = nullptr;      ///< of it, completed
  std::unique_ptr<Rest> rest_;  ///< owner of the block, after a sub in the middle of a line
  std::size_t taken_ = 0;       ///< commands of the queue that were handed out
  bool waits_ = false;          ///< the last of them waits for an answer
  bool runs_again_ = false;     ///< the line runs again, now that live values are known
  std::optional<Refusal> fails_after_commands_;
  bool failed_ = false;
  bool ran_off_end_ = false;
  bool end_was_missed_ = false;  ///< said once that M00 or M30 is missing
  std::uint64_t lines_run_ = 0;
  std::uint64_t lines_since_new_ = 0;  ///< run in loops and subs
  Diagnostic diagnostic_;
  std::bitset<32> habits_seen_;
  std::vector<Diagnostic> warnings_;
  std::vector<Diagnostic> library_warnings_;
};

}  // namespace cnc::interp
