#include "motion/curve.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <numbers>

namespace cnc::motion {

// --- Line ----------------------------------------------------------------------------------------

Line::Line(const Position& start, const Position& end) : start_(start), end_(end) {
  const Position way = end - start;
  measure_ = linear_length(way) < kShortest ? Measure::rotary : Measure::linear;
  length_ = measure_ == Measure::linear ? linear_length(way) : rotary_length(way);
  if (length_ > 0.0) direction_ = way * (1.0 / length_);
}

Position Line::point(double s) const { return s >= length_ ? end_ : start_ + s * direction_; }

// --- Arc -----------------------------------------------------------------------------------------

namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// Angle to turn: in (0, one turn] in the sense of `turns`, plus the further full turns. `nothing`
/// is the angle that is too small to have been meant.
double sweep_of(double start_angle, double end_angle, double nothing, std::int32_t turns) {
  const double sense = turns > 0 ? 1.0 : -1.0;
  double part = std::fmod(sense * (end_angle - start_angle), kFullTurn);
  if (part < 0.0) part += kFullTurn;
  if (part < nothing) part += kFullTurn;
  return sense * (part + kFullTurn * (std::abs(static_cast<double>(turns)) - 1.0));
}

Result<void> check_radii(double start_radius, double end_radius) {
  if (std::min(start_radius, end_radius) < kShortest) {
    return fail(ErrorCode::arc_impossible,
                fmt::format("The radius of the arc is {:.6f} mm; it must be greater than 0.",
                            std::min(start_radius, end_radius)));
  }
  const double larger = std::max(start_radius, end_radius);
  const double allowed = std::max(kRadiusMismatch, kRadiusMismatchRatio * larger);
  if (std::abs(start_radius - end_radius) > allowed) {
    return fail(ErrorCode::arc_impossible,
                fmt::format("The start of the arc is {:.4f} mm from its centre and the end {:.4f} "
                            "mm; they may differ by {:.4f} mm at most.",
                            start_radius, end_radius, allowed));
  }
  return {};
}

}  // namespace

Result<Arc> make_arc(const Position& start, const ArcShape& shape) {
  if (shape.turns == 0) {
    return fail(ErrorCode::arc_impossible,
                "The arc has no turns; 1 (counter-clockwise) or -1 (clockwise) is the least.");
  }
  const PlaneAxes axes = axes_of(shape.plane);
  const double x0 = start[axes.first] - shape.first_centre;
  const double y0 = start[axes.second] - shape.second_centre;
  const double x1 = shape.end[axes.first] - shape.first_centre;
  const double y1 = shape.end[axes.second] - shape.second_centre;
  const double start_radius = std::hypot(x0, y0);
  const double growth = std::hypot(x1, y1) - start_radius;
  if (auto good = check_radii(start_radius, start_radius + growth); !good) {
    return std::unexpected(good.error());
  }

  Arc arc;
  arc.axes_ = axes;
  arc.start_ = start;
  arc.end_ = shape.end;
  arc.first_centre_ = shape.first_centre;
  arc.second_centre_ = shape.second_centre;
  arc.start_radius_ = start_radius;
  arc.start_angle_ = std::atan2(y0, x0);
  arc.sweep_ =
      sweep_of(arc.start_angle_, std::atan2(y1, x1), kShortest / start_radius, shape.turns);

  // Along the spiral d(radius)/d(angle) is proportional to the radius, so the length of its
  // projection is angle times the logarithmic mean of the radii.
  arc.log_growth_ = std::log1p(growth / start_radius);
  const double mean_radius = arc.log_growth_ == 0.0 ? start_radius : growth / arc.log_growth_;
  const double turning = arc.sweep_ * mean_radius;
  Position drift = shape.end - start;
  drift[axes.first] = drift[axes.second] = 0.0;
  arc.length_ = std::hypot(turning, growth, drift[axes.third]);
  arc.tangential_rate_ = turning / arc.length_;
  arc.radial_rate_ = growth / arc.length_;
  arc.drift_ = drift * (1.0 / arc.length_);
  return arc;
}

double Arc::angle(double s) const {
  const double part =
      log_growth_ == 0.0 ? s / length_ : std::log1p(radial_rate_ * s / start_radius_) / log_growth_;
  return start_angle_ + sweep_ * part;
}

double Arc::pitch() const { return std::atan(radial_rate_ / tangential_rate_); }

double Arc::place_of_turn(double turned) const {
  const double part = turned / std::abs(sweep_);
  return log_growth_ == 0.0 ? length_ * part
                            : std::expm1(part * log_growth_) * start_radius_ / radial_rate_;
}

Position Arc::point(double s) const {
  if (s >= length_) return end_;
  if (s <= 0.0) return start_;
  const double phi = angle(s);
  Position result = start_ + s * drift_;
  result[axes_.first] = first_centre_ + radius(s) * std::cos(phi);
  result[axes_.second] = second_centre_ + radius(s) * std::sin(phi);
  return result;
}

Position Arc::tangent(double s) const {
  const double phi = angle(s);
  Position result = drift_;
  result[axes_.first] = radial_rate_ * std::cos(phi) - tangential_rate_ * std::sin(phi);
  result[axes_.second] = radial_rate_ * std::sin(phi) + tangential_rate_ * std::cos(phi);
  return result;
}

Position Arc::bend(double s) const {
  const double phi = angle(s);
  const double angle_rate = tangential_rate_ / radius(s);
  Position result;
  result[axes_.first] =
      angle_rate * (-radial_rate_ * std::sin(phi) - tangential_rate_ * std::cos(phi));
  result[axes_.second] =
      angle_rate * (radial_rate_ * std::cos(phi) - tangential_rate_ * std::sin(phi));
  return result;
}

// --- Cubic ---------------------------------------------------------------------------------------

Cubic hermite_cubic(const Position& start, const Position& start_tangent, const Position& end,
                    const Position& end_tangent, double length) {
  const Position chord = (end - start) * (1.0 / length);
  const Position c2 = (3.0 * chord - 2.0 * start_tangent - end_tangent) * (1.0 / length);
  const Position c3 = (start_tangent + end_tangent - 2.0 * chord) * (1.0 / (length * length));
  return {start, start_tangent, c2, c3, end, length};
}

// --- Curve ---------------------------------------------------------------------------------------

double length_of(const Curve& curve) {
  return std::visit([](const auto& c) { return c.length(); }, curve);
}

Measure measure_of(const Curve& curve) {
  const auto* line = std::get_if<Line>(&curve);
  return line ? line->measure() : Measure::linear;
}

bool is_straight(const Curve& curve) { return std::holds_alternative<Line>(curve); }

Position point_of(const Curve& curve, double s) {
  return std::visit([s](const auto& c) { return c.point(s); }, curve);
}

Position tangent_of(const Curve& curve, double s) {
  if (const auto* line = std::get_if<Line>(&curve)) return line->direction();
  if (const auto* arc = std::get_if<Arc>(&curve)) return arc->tangent(s);
  return std::get<Cubic>(curve).tangent(s);
}

Position bend_of(const Curve& curve, double s) {
  if (std::holds_alternative<Line>(curve)) return {};
  if (const auto* arc = std::get_if<Arc>(&curve)) return arc->bend(s);
  return std::get<Cubic>(curve).bend(s);
}

}  // namespace cnc::motion
