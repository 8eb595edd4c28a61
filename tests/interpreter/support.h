// Running a program text to its end, as the tests of this folder do it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "interpreter/check.h"
#include "interpreter/interpreter.h"

namespace cnc::interp::test {

/// What a program did: its commands as text, and the diagnostic if it failed.
struct Outcome {
  std::vector<std::string> lines;
  bool failed = false;
  Diagnostic diagnostic;
  ModalState modal;
  Position position;
  Position total_offset;
  std::vector<Diagnostic> warnings;
  std::vector<Diagnostic> library_warnings;
};

/// The machine that a program runs on; defaults to a metric one that stands at 0.
struct Bench {
  InterpreterSettings settings;
  config::ParameterStore parameters;
  config::ToolTable tools;
  Position start;
  RunMode mode = RunMode::run;
  std::int32_t tool_in_spindle = 0;
  /// What the world says; as expected where this is empty.
  std::function<Answer(const Command&, Answer expected)> world;

  /// Adds a macro file.
  void add_macros(std::string_view text, std::string name = "macro.cnc");
  /// Runs `text` in a new interpreter until it ends, fails, or has given `max_commands`.
  Outcome run(std::string_view text, std::size_t max_commands = 100'000);
};

Outcome run(std::string_view text);

/// The commands of `text` without the trailing PROGRAM_END() and without mode lines before the
/// first of interest; joined by "; ".
std::string commands_of(std::string_view text);
/// The commands of an outcome, or its diagnostic; as commands_of().
std::string text_of(const Outcome& outcome);
/// What moves, in short, machine coordinates: "rapid 1 2 3; feed 1 2 0; arc 10 16 9 around 10 11 cw
/// (the centre along the axes of the plane); thread 1 2 0 by 1.5; probe 1 2 0; dwell 1; spindle cw;
/// orient; stop". The first error if there is one.
std::string moves_of(std::string_view text);
std::string moves_of(Bench& bench, std::string_view text);
/// "name@column" of the refusal, or "" when the program runs.
std::string refusal_of(std::string_view text);
std::string refusal_of(const Outcome& outcome);

/// The end point of the last move of `text`.
Position end_of(std::string_view text);

/// Contents of a file; empty if there is none.
std::string read_file(const std::string& path);

}  // namespace cnc::interp::test
