// The G-code interpreter: program text in, canonical commands and diagnostics out.
//
// Pull interface: the caller asks for one command after the other and decides by the pace of its
// asking when the program goes on. The interpreter has no thread, no clock, opens no file, and
// knows nothing of motion. Running, checking and rendering a program differ only in who asks.
//
//   Interpreter interpreter(settings, parameters, tools);
//   interpreter.start(program, machine_position);
//   for (;;) switch (interpreter.next()) {
//     case Progress::command: use(interpreter.command()); break;
//     case Progress::working: break;                       // call again: the line budget ran out
//     case Progress::waiting: interpreter.answer(...);     // what became of the last command
//     case Progress::failed:  report(interpreter.diagnostic()); return;
//     case Progress::ended:   return;
//   }
//
// Not thread-safe; one object per thread. A plain motion line allocates nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "config/axis.h"
#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "interpreter/answer.h"
#include "interpreter/canonical.h"
#include "interpreter/diagnostic.h"
#include "interpreter/interpreter_settings.h"
#include "interpreter/machine_state.h"
#include "interpreter/modal_state.h"
#include "interpreter/program.h"

namespace cnc::interp {

enum class Progress : std::uint8_t {
  command,  ///< command() holds the next command
  working,  ///< nothing yet, call again; lets the caller bound the time of a call
  waiting,  ///< the last command waits for answer(); only in RunMode::run
  found,    ///< the line that was searched for runs next: resume_point(), leave_search()
  failed,   ///< diagnostic() says why; the program cannot go on, modal state is as before the line
  ended,    ///< after ProgramEnd, or nothing was started
};

enum class RunMode : std::uint8_t {
  run,     ///< the world answers what the program has to wait for
  render,  ///< #5397 = 1; everything goes as programmed: dialogs say OK, probes trip at the end
  search,  ///< as render, and without commands, up to StartOptions::search_line
};

struct StartOptions {
  RunMode mode = RunMode::run;
  std::uint32_t line = 1;         ///< of the program, from 1
  std::uint32_t search_line = 0;  ///< of RunMode::search: where to stop, from 1
  bool single_line = false;       ///< typed by the operator: needs no M30
};

/// Where a program goes on that was searched: everything that has to be true before its line runs.
/// Within a contour under cutter compensation the program goes on with the move before the line.
struct ResumePoint {
  std::uint32_t line = 0;
  Position position;  ///< machine coordinates; with these modes and offsets
  Position work_position;
  ModalState modal;  ///< tool, spindle, coolant, feed, work system …
  Position work_offset;
  Position g92_offset;
  Position tool_length;
  Position head_offset;
};

class Interpreter {
 public:
  /// `parameters` and `tools` outlive the interpreter and are written and read while it runs.
  Interpreter(const InterpreterSettings& settings, config::ParameterStore& parameters,
              config::ToolTable& tools);
  ~Interpreter();

  /// Begins `program`, the machine standing at `machine_position`. Modal state is kept from what
  /// ran before.
  void start(std::shared_ptr<const Program> program, const Position& machine_position,
             const StartOptions& options = {});
  /// After `found`: what has to be done before the line runs. The machine then stands at
  /// `machine_position`, and next() goes on with commands.
  [[nodiscard]] ResumePoint resume_point() const;
  void leave_search(const Position& machine_position);
  /// Loads macro files, the system's first: their subs can be called, change_tool and subs named
  /// like M codes stand for these. Lines outside of subs that only set parameters are executed now;
  /// library_warnings() tells what else stands there. Stops a running program.
  void set_library(const Library& library);
  [[nodiscard]] const std::vector<Diagnostic>& library_warnings() const;
  /// Gives up the running program; modal state is kept.
  void stop();
  /// A program was ended in its middle: its cutter compensation must not act on the next one.
  void cancel_cutter_compensation();
  /// Modal state as after power-up.
  void reset();

  [[nodiscard]] Progress next();
  [[nodiscard]] const Command& command() const;
  /// While next() says `waiting`: what became of command(). Ignored at any other time. What
  /// refusal_of() refuses fails the program.
  void answer(const Answer& answer);
  /// Why answer() cannot take it: a value that its parameter cannot have, a position that is none.
  [[nodiscard]] std::optional<Error> refusal_of(const Answer& answer) const;
  /// The answer to command() if everything goes as programmed.
  [[nodiscard]] Answer expected_answer() const;
  [[nodiscard]] const Diagnostic& diagnostic() const;
  /// What was accepted since start() although the manual does not allow it, each kind once.
  [[nodiscard]] const std::vector<Diagnostic>& warnings() const;
  /// Name of a file of SourceLine: 0 is the job, then the macro files.
  [[nodiscard]] std::string_view file_name(std::uint16_t file) const;
  /// After `failed`, for checking a program only: goes on with the next line. Modes, feed and end
  /// point of the wrong one hold as far as they are known. False when nothing has failed.
  bool skip_failed_line();

  /// Machine position that the program has reached in the interpreter, and after the world moved it
  /// (jog in a pause, homing).
  /// Under cutter compensation that of the tool, which an inside corner may still shorten.
  [[nodiscard]] Position position() const;
  void set_position(const Position& machine_position);

  [[nodiscard]] const ModalState& modal() const;
  /// All that the next program finds in force: to be given to an interpreter that shall do the same.
  /// Between programs only.
  [[nodiscard]] const MachineState& state() const;
  void set_state(const MachineState& state);
  void set_block_delete(bool on);
  /// The tool that is in the spindle, 0 … 99, when the world knows better (start-up, change by
  /// hand).
  void set_tool_in_spindle(std::int32_t tool);
  /// What is added to rotated and scaled work coordinates: work offset, G92, tool length and the
  /// offset of the head. Without G68, G51 and diameter programming work coordinates are machine
  /// coordinates − this; to_work() is right always.
  [[nodiscard]] Position total_offset() const;
  /// Work coordinates of a machine position, as a program would write them: X as a diameter under
  /// diameter programming. Lengths in mm.
  [[nodiscard]] Position to_work(const Position& machine) const;
  [[nodiscard]] Position work_position() const { return to_work(position()); }
  /// The line that next() will read next, from 1.
  [[nodiscard]] std::uint32_t next_line() const;
  /// Lines read since start(), every round of a loop counted.
  [[nodiscard]] std::uint64_t lines_run() const;
  /// Lines run in loops and subs since the program last came to a line that had not run before: a
  /// program without end is known by it, however long one without loops may be.
  [[nodiscard]] std::uint64_t lines_since_new() const;
  /// The program has ended at the end of its file, without M2 or M30.
  [[nodiscard]] bool ran_off_end() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cnc::interp
