#include "interpreter/arc_geometry.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/modal_state.h"

namespace cnc::interp {
namespace {

constexpr double kToleranceMillimetres = 0.002;
constexpr double kToleranceInches = 0.0002;
constexpr double kRelativeTolerance = 0.001;

}  // namespace

Position with_plane_point(Position position, Plane plane, PlanePoint point) {
  const PlaneAxes axes = axes_of(plane);
  position[axes.first] = point.first;
  position[axes.second] = point.second;
  return position;
}

double radius_tolerance(LengthUnit unit, double radius) {
  const double absolute =
      unit == LengthUnit::inch ? kToleranceInches * kMillimetresPerInch : kToleranceMillimetres;
  return std::max(absolute, kRelativeTolerance * radius);
}

Accepted check_centre(PlanePoint start, PlanePoint end, PlanePoint centre, LengthUnit unit,
                      Span span) {
  const double at_start = distance(centre, start);
  const double at_end = distance(centre, end);
  const double larger = std::max(at_start, at_end);
  if (larger < kSamePoint) {
    return refuse(ErrorCode::arc_radius_zero, span, "The centre of this arc is its start point.",
                  "I J K so that the radius is not 0.");
  }
  if (std::abs(at_start - at_end) <= radius_tolerance(unit, larger)) return {};
  return refuse(
      ErrorCode::arc_radius_mismatch, span,
      fmt::format("The radius is {:.6g} mm at the start of this arc and {:.6g} mm at its end.",
                  at_start, at_end),
      fmt::format("A difference of at most {:.4g} mm.", radius_tolerance(unit, larger)));
}

Parsed<PlanePoint> centre_of_radius(PlanePoint start, PlanePoint end, double radius, bool clockwise,
                                    LengthUnit unit, ShortRadius short_radius, Span span) {
  if (radius == 0.0) {
    return refuse(ErrorCode::arc_radius_zero, span, "R is 0.", "A radius that is not 0.");
  }
  if (distance(start, end) < kSamePoint) {
    return refuse(ErrorCode::arc_radius_end_is_start, span,
                  "An arc with R must end at another point than it starts from.",
                  "A full circle with I J K.");
  }
  const double half_chord = distance(start, end) / 2.0;
  const double size = std::abs(radius);
  if (short_radius == ShortRadius::refused && half_chord > size + radius_tolerance(unit, size)) {
    return refuse(
        ErrorCode::arc_radius_too_small, span,
        fmt::format("R is {:.6g} mm; the end point is {:.6g} mm away.", size, 2.0 * half_chord),
        fmt::format("R of at least {:.6g} mm.", half_chord));
  }
  // The centre lies on the perpendicular through the middle of the chord: on its left when a
  // counter-clockwise arc turns less than half a turn. A chord a little too long for R (rounding)
  // is a half circle.
  const double height = std::sqrt(std::max(0.0, (size - half_chord) * (size + half_chord)));
  const double side = (clockwise != (radius < 0.0)) ? -1.0 : 1.0;
  const double factor = side * height / (2.0 * half_chord);
  return PlanePoint{(start.first + end.first) / 2.0 - factor * (end.second - start.second),
                    (start.second + end.second) / 2.0 + factor * (end.first - start.first)};
}

}  // namespace cnc::interp
