// Any bytes as a program: checked with small bounds, every command printed, every error described.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "interpreter/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cnc::interp;
  const auto program = Program::from_text(std::string(data, data + size), "fuzz");
  if (!program) return 0;
  std::size_t printed = 0;
  CheckOptions options;
  options.max_errors = 20;
  options.line_budget = 1'000;
  options.sink = [&](const Command& command) { printed += text_of(command).size(); };
  InterpreterSettings settings;
  settings.lines_per_call = 100;
  settings.absolute_arc_centres = size % 2 == 1;
  settings.block_delete = size % 3 == 1;
  const CheckReport report = check(*program, settings, {}, {}, {}, options);
  for (const Diagnostic& error : report.errors) printed += error.to_string().size();
  // An error that names no line of the program is a bug.
  for (const Diagnostic& error : report.errors) {
    if (error.line == 0 || error.line > report.line_count) std::abort();
  }
  return 0;
}
