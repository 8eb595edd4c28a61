#include "motion/pitch_curve.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

PitchCurve::PitchCurve(std::span<const config::PitchPoint> points) {
  for (const config::PitchPoint& point : points)
    knots_.push_back({point.calibrated, point.machine - point.calibrated, 0.0});
  choose_slopes();
  measure();
}

/// At both ends the slope is 0: it goes on like that beyond them.
void PitchCurve::choose_slopes() {
  for (std::size_t i = 1; i + 1 < knots_.size(); ++i) {
    const auto secant = [this](std::size_t k) {
      return (knots_[k + 1].correction - knots_[k].correction) /
             (knots_[k + 1].position - knots_[k].position);
    };
    const double before = secant(i - 1);
    const double behind = secant(i);
    if (before * behind <= 0.0) continue;
    const double w = knots_[i].position - knots_[i - 1].position;
    const double next_w = knots_[i + 1].position - knots_[i].position;
    const double first = 2.0 * next_w + w;
    const double second = next_w + 2.0 * w;
    knots_[i].slope = (first + second) / (first / before + second / behind);
  }
}

/// Between two knots the slope is a parabola and its change linear.
void PitchCurve::measure() {
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
    const Knot& a = knots_[i];
    const Knot& b = knots_[i + 1];
    const double w = b.position - a.position;
    const double secant = (b.correction - a.correction) / w;
    const double at_a = (6.0 * secant - 4.0 * a.slope - 2.0 * b.slope) / w;
    const double at_b = (-6.0 * secant + 2.0 * a.slope + 4.0 * b.slope) / w;
    most_curved_ = std::max({most_curved_, std::abs(at_a), std::abs(at_b)});
    steepest_ = std::max({steepest_, std::abs(a.slope), std::abs(b.slope)});
    if (at_a * at_b >= 0.0) continue;
    const double top = w * at_a / (at_a - at_b);
    steepest_ = std::max(steepest_, std::abs(a.slope + 0.5 * at_a * top));
  }
}

PitchCurve::Value PitchCurve::at(double position) const {
  if (knots_.empty()) return {};
  const auto next = std::ranges::upper_bound(knots_, position, {}, &Knot::position);
  if (next == knots_.begin()) return {knots_.front().correction, 0.0};
  if (next == knots_.end()) return {knots_.back().correction, 0.0};
  const Knot& a = *std::prev(next);
  const Knot& b = *next;
  const double w = b.position - a.position;
  const double t = position - a.position;
  const double secant = (b.correction - a.correction) / w;
  const double bend = (3.0 * secant - 2.0 * a.slope - b.slope) / w;
  const double twist = (a.slope + b.slope - 2.0 * secant) / (w * w);
  return {a.correction + t * (a.slope + t * (bend + t * twist)),
          a.slope + t * (2.0 * bend + 3.0 * t * twist)};
}

/// The correction is flat, so that repeating it converges: each time at least tenfold.
double PitchCurve::undone(double motor) const {
  constexpr int kRepetitions = 12;
  double position = motor;
  for (int i = 0; i < kRepetitions; ++i) position = motor - at(position).correction;
  return position;
}

double PitchCurve::largest() const {
  double largest = 0.0;
  for (const Knot& knot : knots_) largest = std::max(largest, std::abs(knot.correction));
  return largest;
}

}  // namespace cnc::motion
