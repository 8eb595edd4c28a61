// The exact curves of a path: straight line, arc (helix, spiral) and cubic.
//
// Each maps a parameter s in [0, length] to a position of all six axes. s is the distance travelled
// in X Y Z, in mm; a move that turns rotary axes only has its distance in degrees. |q'(s)| over the
// axes that define s is 1 all along lines and arcs and at both ends of corner blends, so that ds/dt
// is continuous where they meet. The spans of a smoothed path have the parameter of the program
// that they smooth: where they cut a corner, |q'| is less than 1, but continuous from span to span.
#pragma once

#include <cmath>
#include <cstdint>
#include <variant>

#include "config/axis.h"
#include "config/error.h"
#include "config/plane.h"

namespace cnc::motion {

/// Moves shorter than this (mm or degrees) are no motion, and an arc whose end lies this close to
/// its start, seen in the plane, is a full turn. A nanometre is far below any step and far above
/// the rounding of positions on a large machine.
inline constexpr double kShortest = 1e-6;

/// An arc as programmed, from wherever the path is. First and second axis of the plane as in
/// axes_of(); `turns` counts as in NIST ARC_FEED: positive counter-clockwise, negative clockwise, 1
/// for at most one full turn, 2 for one full turn more, …
struct ArcShape {
  Position end;
  Plane plane = Plane::xy;
  double first_centre = 0.0;
  double second_centre = 0.0;
  std::int32_t turns = 1;
};

/// What the length of a curve measures.
enum class Measure : std::uint8_t { linear, rotary };

class Line {
 public:
  Line() = default;
  Line(const Position& start, const Position& end);

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] Measure measure() const { return measure_; }
  [[nodiscard]] Position point(double s) const;
  [[nodiscard]] const Position& direction() const { return direction_; }
  [[nodiscard]] const Position& end() const { return end_; }

 private:
  Position start_;
  Position end_;
  Position direction_;
  double length_ = 0.0;
  Measure measure_ = Measure::linear;
};

/// Arc or helix. When the distances of start and end from the centre differ a little (rounded
/// programs), the radius changes along the way so that the end is met exactly: with the radius
/// linear in s and the tangential speed constant this is a piece of a logarithmic spiral, the only
/// spiral whose speed |q'| is constant.
class Arc {
 public:
  Arc() = default;

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] Position point(double s) const;
  [[nodiscard]] Position tangent(double s) const;
  [[nodiscard]] Position bend(double s) const;
  [[nodiscard]] const Position& end() const { return end_; }

  /// Signed angle from start to end, radians; radius at s; angle at s.
  [[nodiscard]] double sweep() const { return sweep_; }
  [[nodiscard]] double radius(double s) const { return start_radius_ + radial_rate_ * s; }
  [[nodiscard]] double angle(double s) const;
  /// Angle by which the tangent leans out of the circle; 0 unless the radius changes.
  [[nodiscard]] double pitch() const;
  /// Parameter at which `turned` radians of the sweep (0 … |sweep|) are done.
  [[nodiscard]] double place_of_turn(double turned) const;

 private:
  friend Result<Arc> make_arc(const Position& start, const ArcShape& shape);

  PlaneAxes axes_{};
  Position start_;
  Position end_;
  Position drift_;  ///< dq/ds of the axes outside the plane; 0 for the two within
  double first_centre_ = 0.0;
  double second_centre_ = 0.0;
  double start_angle_ = 0.0;
  double sweep_ = 0.0;
  double start_radius_ = 0.0;
  double radial_rate_ = 0.0;      ///< d radius / ds
  double tangential_rate_ = 0.0;  ///< radius * d angle / ds, signed
  double log_growth_ = 0.0;       ///< ln(end radius / start radius)
  double length_ = 0.0;
};

/// Refused: a radius of (nearly) zero, no turns at all, or radii at start and end that differ by
/// more than rounding explains (kRadiusMismatch mm and kRadiusMismatchRatio of the larger).
[[nodiscard]] Result<Arc> make_arc(const Position& start, const ArcShape& shape);
inline constexpr double kRadiusMismatch = 0.05;
inline constexpr double kRadiusMismatchRatio = 0.001;

/// A cubic polynomial: a corner blend, or a span of a smoothed path (tube_spline.h).
class Cubic {
 public:
  Cubic() = default;
  /// q = start + c1 s + c2 s² + c3 s³ for s in [0, length]; `end` is what that comes to.
  Cubic(const Position& start, const Position& c1, const Position& c2, const Position& c3,
        const Position& end, double length)
      : start_(start), end_(end), c1_(c1), c2_(c2), c3_(c3), length_(length) {}

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] Position point(double s) const {
    return s >= length_ ? end_ : start_ + s * (c1_ + s * (c2_ + s * c3_));
  }
  [[nodiscard]] Position tangent(double s) const { return c1_ + s * (2.0 * c2_ + (3.0 * s) * c3_); }
  [[nodiscard]] Position bend(double s) const { return 2.0 * c2_ + (6.0 * s) * c3_; }
  [[nodiscard]] Position third() const { return 6.0 * c3_; }  ///< q'''
  [[nodiscard]] const Position& end() const { return end_; }

 private:
  Position start_;
  Position end_;
  Position c1_;
  Position c2_;
  Position c3_;
  double length_ = 0.0;
};

/// The cubic with given positions and tangents at both ends (Hermite). Between two straight lines,
/// cut back equally, it is a parabola with constant q''.
[[nodiscard]] Cubic hermite_cubic(const Position& start, const Position& start_tangent,
                                  const Position& end, const Position& end_tangent, double length);

using Curve = std::variant<Line, Arc, Cubic>;

[[nodiscard]] double length_of(const Curve& curve);
[[nodiscard]] Measure measure_of(const Curve& curve);
[[nodiscard]] bool is_straight(const Curve& curve);
/// At or beyond the length, point_of() is the programmed end to the last bit.
[[nodiscard]] Position point_of(const Curve& curve, double s);
[[nodiscard]] Position tangent_of(const Curve& curve, double s);  ///< q'(s)
[[nodiscard]] Position bend_of(const Curve& curve, double s);     ///< q''(s)

/// Euclidean length over all six axes, mm and degrees alike.
[[nodiscard]] inline double norm(const Position& p) { return std::sqrt(dot(p, p)); }

}  // namespace cnc::motion
