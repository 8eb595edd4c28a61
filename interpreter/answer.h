// What the world says after a command that a program has to wait for (waits_for_answer()).
//
// The interpreter runs ahead of the machine. Where the program needs to know what happened (did the
// probe trip, what did the operator type, where did he jog to) it stops until the machine has
// caught up and the answer is there.
#pragma once

#include <vector>

#include "config/axis.h"

namespace cnc::interp {

/// Values that change by themselves: what they were when the machine stood still for the program.
struct LiveValues {
  bool probe = false;          ///< #5068
  double hand_wheel = 0.0;     ///< #5069, counts
  double spindle_speed = 0.0;  ///< #5070, measured, turns per second
  bool height_map = false;     ///< #5151

  friend bool operator==(const LiveValues&, const LiveValues&) = default;
};

struct Answer {
  Position position;  ///< where the machine stands now, machine coordinates
  LiveValues live;

  bool probe_tripped = false;  ///< ProbeMove
  Position probe_position;     ///< ProbeMove: where it tripped, else where the move ended
  double input = 0.0;          ///< ReadInput: 0, 1, or the analog value; #5399
  bool confirmed = true;       ///< AskOperator: OK, not Cancel
  std::vector<double> values;  ///< AskOperator: the fields in their order; none = unchanged
};

}  // namespace cnc::interp
