// The spline in its tube, without the planner around it.
#include "motion/tube_spline.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace cnc::motion::test {

namespace {

constexpr double kRadius = 100.0;
constexpr double kAngle = 0.25;  // of one span

Position on_arc(double angle) {
  Position point;
  point[Axis::X] = kRadius * std::cos(angle);
  point[Axis::Y] = kRadius * std::sin(angle);
  return point;
}

TubeSpan arc_span(int index, double tolerance) {
  const double begin = kAngle * index;
  const double middle = begin + 0.5 * kAngle;
  Position tangent;
  tangent[Axis::X] = -std::sin(middle);
  tangent[Axis::Y] = std::cos(middle);
  return {.length = kRadius * kAngle,
          .middle = on_arc(middle),
          .middle_tangent = tangent,
          .end = on_arc(begin + kAngle),
          .end_tolerance = tolerance};
}

struct Arcs {
  int spans = 0;
  int stops = 0;
  double off = 0.0;  ///< largest distance from the circle
};

Arcs along_arc(int spans, double tolerance) {
  TubeSpline spline;
  spline.begin(on_arc(0.0), tolerance);
  for (int i = 0; i < spans; ++i) spline.add(arc_span(i, tolerance));
  spline.finish();
  Arcs arcs;
  for (; spline.ready() > 0; spline.pop()) {
    const TubeSpline::Ready& span = spline.front();
    ++arcs.spans;
    arcs.stops += span.stop_at_end ? 1 : 0;
    for (int i = 0; i <= 20; ++i) {
      const Position q = span.curve.point(span.curve.length() * i / 20);
      const double radius = std::hypot(q[Axis::X], q[Axis::Y]);
      arcs.off = std::max(arcs.off, std::abs(radius - kRadius));
    }
  }
  return arcs;
}

/// A parabola through three points of an arc, at its ends ±a and its middle, leaves it by
/// y² (a² − y²) / 8R³ at the place y along the chord: a⁴ / 32R³ at most.
constexpr double kParabola = kRadius * kAngle * kAngle * kAngle * kAngle / (16.0 * 32.0);

}  // namespace

TEST_CASE("A run of a single span bends as its arc does", "[MOT-1][MOT-2]") {
  const Arcs arcs = along_arc(1, 0.01);
  CHECK(arcs.spans == 1);
  CHECK(arcs.stops == 1);
  CHECK(arcs.off < 1.01 * kParabola);
}

/// A cubic from end to end of a quarter circle leaves it by 2.0e-4 of its radius at best, one of a
/// shorter arc by the sixth power of that part: 100 mm * 2.0e-4 * (0.25 / (pi / 2))^6 = 3e-7 mm.
/// In a tube of 1e-9 mm nothing is left but to stop at every node, with a parabola in between.
TEST_CASE("A run on an arc is broken where no curve stays in the tube, and stays on the arc",
          "[MOT-1][MOT-2]") {
  const Arcs arcs = along_arc(12, 1e-9);
  CHECK(arcs.spans == 12);
  CHECK(arcs.stops == 12);
  CHECK(arcs.off < 1.01 * kParabola);
}

TEST_CASE("A run on an arc with room in its tube is one run", "[MOT-1][MOT-2]") {
  const Arcs arcs = along_arc(12, 1.0);
  CHECK(arcs.spans == 12);
  CHECK(arcs.stops == 1);
  CHECK(arcs.off < 1.0);
}

}  // namespace cnc::motion::test
