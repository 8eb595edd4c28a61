// The exact bounding box of a curve, for checking soft limits before a move is queued.
#pragma once

#include "config/axis.h"
#include "motion/curve.h"

namespace cnc::motion {

struct Extents {
  Position min;
  Position max;

  void include(const Position& point);
};

[[nodiscard]] Extents extents_of_line(const Position& start, const Position& end);
/// Start, end, and the extremes of the plane's axes in between.
[[nodiscard]] Extents extents_of_arc(const Arc& arc);

}  // namespace cnc::motion
