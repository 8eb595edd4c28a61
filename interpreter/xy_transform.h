// G68 rotation and G51 scaling of the XY plane (manual 3.4.13, 3.4.18): what a program writes,
// before work offset, G92 and tool length are added.
#pragma once

#include "config/axis.h"
#include "config/plane.h"

namespace cnc::interp {

/// p → point + turn(scale(p − point)). Rotation and scaling have one point; Z and the rotary axes
/// stay as they are.
class XyTransform {
 public:
  [[nodiscard]] bool is_identity() const { return is_identity_; }
  /// Whether an arc in `plane` is still an arc in that plane.
  [[nodiscard]] bool keeps_arcs(Plane plane) const;
  [[nodiscard]] double x_factor() const { return x_factor_; }
  [[nodiscard]] double x_point() const { return x_point_; }
  [[nodiscard]] double y_point() const { return y_point_; }

  [[nodiscard]] Position apply(const Position& programmed) const;
  [[nodiscard]] Position undo(const Position& transformed) const;
  /// A distance instead of a point.
  [[nodiscard]] Position apply_to_distance(Position distance) const;

  void set_point(double x, double y);
  /// Counter-clockwise, degrees.
  void set_rotation(double angle);
  /// Each above 0.
  void set_factors(double x, double y);

  friend bool operator==(const XyTransform&, const XyTransform&) = default;

 private:
  void note_identity();

  double x_point_ = 0.0;
  double y_point_ = 0.0;
  double cosine_ = 1.0;
  double sine_ = 0.0;
  double x_factor_ = 1.0;
  double y_factor_ = 1.0;
  bool is_identity_ = true;
};

}  // namespace cnc::interp
