#include "motion/extents.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cnc::motion {

void Extents::include(const Position& point) {
  for (const Axis axis : kAllAxes) {
    min[axis] = std::min(min[axis], point[axis]);
    max[axis] = std::max(max[axis], point[axis]);
  }
}

Extents extents_of_line(const Position& start, const Position& end) {
  Extents extents{start, start};
  extents.include(end);
  return extents;
}

Extents extents_of_arc(const Arc& arc) {
  Extents extents = extents_of_line(arc.point(0.0), arc.end());
  // The plane's axes are extreme at multiples of 90°, on a spiral later by its pitch. Of more than
  // one turn the first and the last suffice: the radius grows or shrinks all the way.
  constexpr double kQuarter = std::numbers::pi / 2.0;
  const double sense = arc.sweep() > 0.0 ? 1.0 : -1.0;
  const double total = std::abs(arc.sweep());
  const double start = sense * (arc.angle(0.0) - arc.pitch());
  const double to_first = std::ceil(start / kQuarter) * kQuarter - start;
  const auto include_quarters_from = [&](double turned) {
    for (int i = 0; i < 4 && turned <= total; ++i, turned += kQuarter) {
      extents.include(arc.point(arc.place_of_turn(turned)));
    }
  };
  include_quarters_from(to_first);
  const double quarters = std::floor((total - to_first) / kQuarter);
  if (quarters > 3.0) include_quarters_from(to_first + (quarters - 3.0) * kQuarter);
  return extents;
}

}  // namespace cnc::motion
