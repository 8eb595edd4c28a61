// A curve with what the program wants of it, on its way from the planner's queue to the track.
#pragma once

#include <cstdint>

#include "motion/curve.h"
#include "motion/overrides.h"
#include "motion/setpoint.h"

namespace cnc::motion {

/// How the path comes to a piece.
enum class Entry : std::uint8_t {
  vertex,      ///< as the angle to the piece before it demands
  smooth,      ///< as a span that goes on where the span before it ends
  standstill,  ///< as the first span of a run
};

/// What the program wants of a move.
struct Wishes {
  MoveKind kind = MoveKind::feed;
  Override override = Override::feed;
  double feed = 0.0;
  double laf_angle = 0.0;
  double tolerance = 0.0;  ///< mm the path may leave it by (G64 P); 0: exact path
  double simplify = 0.0;   ///< mm within which lines may be joined (Q)
  bool stop_at_end = false;
  MoveTag tag;
};

/// The range [begin, end] of the curve is driven; blends have taken the rest.
struct Piece : Wishes {
  Curve curve;
  double begin = 0.0;
  double end = 0.0;
  double stepped = 0.0;  ///< up to here it has been cut into steps
  double grid = 0.0;     ///< longest step
  Entry entry = Entry::vertex;
};

}  // namespace cnc::motion
