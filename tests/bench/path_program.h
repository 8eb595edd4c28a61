// Programs as the planner sees them: the moves of a file, for figures about motion.
//
// Tools, spindle, dwells and the like take no time here.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "motion/planner.h"

namespace cnc::bench {

struct ProgramMove {
  motion::MoveKind kind = motion::MoveKind::feed;
  double feed = 0.0;  ///< mm/s
  bool is_arc = false;
  motion::ArcShape shape;  ///< of a line only the end
};

struct PathProgram {
  std::string name;
  std::vector<ProgramMove> moves;
  std::size_t refused_lines = 0;  ///< which the interpreter refused; they were left out
  bool turns_rotary_axes = false;
};

/// Ends the process with a sentence when the file cannot be read.
[[nodiscard]] PathProgram read_program(const std::string& file);

/// How all moves of a program shall be driven.
struct Driving {
  double feed = 0.0;       ///< mm/s; 0: each move's own
  double tolerance = 0.0;  ///< G64 P, mm; 0: exact path
  double simplify = 0.0;   ///< Q, mm
};

/// Adds one move; false when it was refused.
bool add_move(motion::Planner& planner, const ProgramMove& move, const Driving& driving);

/// Feeds the moves to a planner, which `draw` empties.
template <typename Draw>
void drive(motion::Planner& planner, const PathProgram& program, const Driving& driving,
           Draw draw) {
  for (const ProgramMove& move : program.moves) {
    if (!add_move(planner, move, driving)) continue;
    while (planner.full()) draw(planner);
  }
  while (!planner.idle()) draw(planner);
}

}  // namespace cnc::bench
