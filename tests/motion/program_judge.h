// What a planner makes of a random program, judged: limits at every instant, and the distances
// between path and program, globally and both ways.
#pragma once

#include <cstddef>
#include <string>

#include "motion/limits.h"
#include "tests/motion/random_program.h"

namespace cnc::motion::test {

/// A part of a limit each; at most 1 where all is well.
struct Verdict {
  double velocity = 0.0;  ///< largest of any axis at any instant
  double acceleration = 0.0;
  double jerk = 0.0;
  /// The speed over the programmed one and the highest override since a standstill. With limits of
  /// jerk it may be above 1: a path that has to slow down cannot do it at once.
  double feed = 0.0;
  bool feed_may_wait = false;
  double path_to_program = 0.0;  ///< distance over what the moves nearby allow, X Y Z
  double program_to_path = 0.0;
  std::string fault;  ///< what else is wrong, in words
  double time = 0.0;
  std::size_t setpoints = 0;
  std::size_t refused = 0;  ///< moves, which were left out

  /// Rounding is no failure.
  [[nodiscard]] bool is_sound() const;
  [[nodiscard]] std::string to_string() const;
};

/// Drives the whole program and judges every cubic of it; the planner may be told of other limits
/// than it is judged by.
[[nodiscard]] Verdict judge(const RandomProgram& program);
[[nodiscard]] Verdict judge(const RandomProgram& program, const AxisLimits& planned_with);

/// The smallest program that is not sound, and its verdict, for a failing test's message.
[[nodiscard]] std::string smallest_failure(const RandomProgram& program);

}  // namespace cnc::motion::test
