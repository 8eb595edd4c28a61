// What moves that follow the spindle have in common: G33, G33.1, G74, G76, G84.
#pragma once

#include "interpreter/execution.h"

namespace cnc::interp {

[[nodiscard]] constexpr SpindleDirection reversed(SpindleDirection direction) {
  switch (direction) {
    case SpindleDirection::clockwise:
      return SpindleDirection::counterclockwise;
    case SpindleDirection::counterclockwise:
      return SpindleDirection::clockwise;
    case SpindleDirection::off:
      break;
  }
  return SpindleDirection::off;
}

/// Refuses when the program has not switched the spindle on, or lets its speed follow X (G96). How
/// fast it really turns, and whether the axes can follow, only the machine knows.
[[nodiscard]] Accepted check_spindle_leads(const Execution& x);

/// `pitch` mm of way per revolution.
void move_with_spindle(Execution& x, const Position& end, double pitch);

}  // namespace cnc::interp
