// The inside of the Interpreter: reads line after line, follows if, while, sub and gosub, and hands
// blocks to Execution.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "interpreter/execution.h"
#include "interpreter/interpreter.h"
#include "interpreter/line_cache.h"
#include "interpreter/parameter_access.h"

namespace cnc::interp {

class Runner {
 public:
  Runner(const InterpreterSettings& settings, config::ParameterStore& parameters,
         config::ToolTable& tools);

  void start(std::shared_ptr<const Program> program, const Position& position,
             const StartOptions& options);
  void stop();
  void reset();
  bool skip_failed_line();
  void set_block_delete(bool on) { settings_.block_delete = on; }

  [[nodiscard]] Progress next();
  [[nodiscard]] const Command& command() const;
  void answer(const Answer& answer);
  [[nodiscard]] Answer expected_answer() const;
  [[nodiscard]] const Diagnostic& diagnostic() const { return diagnostic_; }
  [[nodiscard]] MachineState& state() { return execution_.state(); }
  [[nodiscard]] std::uint32_t next_line() const { return cursor_.line; }
  [[nodiscard]] std::uint64_t lines_run() const { return lines_run_; }
  [[nodiscard]] bool ran_off_end() const { return ran_off_end_; }

 private:
  /// A gosub that has not returned yet.
  struct Call {
    Program::Cursor return_to;
    std::uint32_t line;
    std::string_view sub;
  };

  Progress hand_out();
  Accepted run_line();
  Accepted run_rest_of_line();
  void ask_for_live_values();
  Accepted run_parsed(const Line& line);
  Accepted run_block(const Line& line);
  Accepted check_and_execute(Block& block);
  [[nodiscard]] SourceLine here() const { return {0, line_number_}; }
  Accepted run_flow(const Line& line);
  Accepted run_condition(const Line& line, const FlowMark* partner);
  Accepted call_sub(const Line& line);
  Accepted return_from_sub();
  Accepted show_text(const Line& line);
  void end_at_end_of_file();

  [[nodiscard]] Parsed<const Line*> parsed_line();
  [[nodiscard]] bool is_skipped() const;
  void go_behind(const FlowMark& mark);
  Progress fail(const Refusal& refusal);

  InterpreterSettings settings_;
  Execution execution_;
  ParameterAccess access_;

  std::shared_ptr<const Program> program_;
  Program::Cursor cursor_;         ///< of the line to read next
  std::uint32_t line_number_ = 0;  ///< of the line that runs
  std::string_view line_text_;
  std::vector<Call> calls_;
  LineCache cache_;
  Line scratch_;  ///< a line that runs for the first time
  Evaluation evaluation_;

  RunMode mode_ = RunMode::run;
  const Line* line_ = nullptr;  ///< that runs
  Block* block_ = nullptr;      ///< of it, completed
  std::size_t taken_ = 0;       ///< commands of the queue that were handed out
  bool waits_ = false;          ///< the last of them waits for an answer
  bool runs_again_ = false;     ///< the line runs again, now that live values are known
  std::optional<Refusal> fails_after_commands_;
  bool failed_ = false;
  bool ran_off_end_ = false;
  std::uint64_t lines_run_ = 0;
  Diagnostic diagnostic_;
};

}  // namespace cnc::interp
