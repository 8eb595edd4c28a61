// Checking a whole program without a machine: every wrong line, the space that it needs, and all
// its commands for whoever draws or times it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "interpreter/interpreter.h"

namespace cnc::interp {

inline constexpr std::uint64_t kMaxLoopLines = 10'000'000;

/// How far a check has come.
struct CheckProgress {
  std::uint32_t line = 0;  ///< of the file that is read next
  std::uint64_t lines_run = 0;
  std::uint64_t lines_since_new = 0;  ///< 0 outside of loops and subs
};

struct CheckOptions {
  std::size_t max_errors = 100;
  /// Lines to run in loops and subs without coming to a new line of the program: seconds. A file of
  /// any length without loops is checked to its end. 0 = no limit.
  std::uint64_t max_loop_lines = kMaxLoopLines;
  /// What the program finds in force; the modes of power-up where it is not said.
  std::optional<MachineState> begins_with;
  /// Called with every command; empty = nobody wants them.
  std::function<void(const Command&)> sink;
  /// Set by another thread, or a signal, to give up.
  const std::atomic<bool>* cancel = nullptr;
  /// Called every few thousand lines; empty = nobody wants to know.
  std::function<void(const CheckProgress&)> progress;
};

/// Smallest and largest value of each axis, machine coordinates. Empty until something was added.
struct Extents {
  bool empty = true;
  Position lowest;
  Position highest;

  void add(const Position& position);
  void add(Axis axis, double value);
};

struct CheckReport {
  std::vector<Diagnostic> errors;  ///< in the order in which they were met; a line appears once
  std::vector<Diagnostic> warnings;
  Extents motion;                ///< of all moves, start point included; arcs exactly
  Extents cutting;               ///< of moves at feed rate
  std::uint32_t line_count = 0;  ///< of the file
  std::uint64_t commands = 0;
  bool complete = false;  ///< the program's end was reached
  bool cancelled = false;

  [[nodiscard]] bool ok() const { return complete && errors.empty(); }
};

/// Runs `program` with a copy of the parameters from `start` (machine coordinates) on, goes on
/// behind wrong lines, and reports. The real parameters and tools are not touched.
[[nodiscard]] CheckReport check(std::shared_ptr<const Program> program,
                                const InterpreterSettings& settings,
                                config::ParameterStore parameters, config::ToolTable tools,
                                const Position& start, const CheckOptions& options = {});

}  // namespace cnc::interp
