#include "interpreter/xy_transform.h"

#include <cmath>
#include <numbers>

namespace cnc::interp {
namespace {

/// Exact at quarter turns, so that G68 R90 leaves no trace of X in Y.
[[nodiscard]] double sine_of(double degrees) {
  const double angle = std::remainder(degrees, 360.0);
  if (angle == 0.0 || std::abs(angle) == 180.0) return 0.0;
  if (std::abs(angle) == 90.0) return angle / 90.0;
  return std::sin(angle * std::numbers::pi / 180.0);
}

}  // namespace

bool XyTransform::keeps_arcs(Plane plane) const {
  return is_identity_ || (plane == Plane::xy && x_factor_ == y_factor_);
}

Position XyTransform::apply_to_distance(Position distance) const {
  if (is_identity_) return distance;
  const double x = distance[Axis::X] * x_factor_;
  const double y = distance[Axis::Y] * y_factor_;
  distance[Axis::X] = cosine_ * x - sine_ * y;
  distance[Axis::Y] = sine_ * x + cosine_ * y;
  return distance;
}

Position XyTransform::apply(const Position& programmed) const {
  if (is_identity_) return programmed;
  Position result = programmed;
  result[Axis::X] -= x_point_;
  result[Axis::Y] -= y_point_;
  result = apply_to_distance(result);
  result[Axis::X] += x_point_;
  result[Axis::Y] += y_point_;
  return result;
}

Position XyTransform::undo(const Position& transformed) const {
  if (is_identity_) return transformed;
  const double x = transformed[Axis::X] - x_point_;
  const double y = transformed[Axis::Y] - y_point_;
  Position result = transformed;
  result[Axis::X] = x_point_ + (cosine_ * x + sine_ * y) / x_factor_;
  result[Axis::Y] = y_point_ + (cosine_ * y - sine_ * x) / y_factor_;
  return result;
}

void XyTransform::set_point(double x, double y) {
  x_point_ = x;
  y_point_ = y;
}

void XyTransform::set_rotation(double angle) {
  sine_ = sine_of(angle);
  cosine_ = sine_of(angle + 90.0);
  note_identity();
}

void XyTransform::set_factors(double x, double y) {
  x_factor_ = x;
  y_factor_ = y;
  note_identity();
}

void XyTransform::note_identity() {
  is_identity_ = sine_ == 0.0 && cosine_ == 1.0 && x_factor_ == 1.0 && y_factor_ == 1.0;
}

}  // namespace cnc::interp
