// Motion in time through a cell whose x = (du/dt)² is a quadratic of u: its acceleration is linear
// in u, d²u/dt² = w + c u, so that u(t) is made of cosh and sinh, or cos and sin where c < 0.
#pragma once

#include <algorithm>
#include <cmath>

namespace cnc::motion {

/// Distance, du/dt and d²u/dt².
struct MotionState {
  double s = 0.0;
  double v = 0.0;
  double w = 0.0;
  double dw = 0.0;  ///< dw/ds; infinite at a standstill
};

class CellMotion {
 public:
  /// From v0² = x0 and w0 at s = 0 with w' = c.
  CellMotion(double v0, double w0, double c) : v0_(v0), w0_(w0), c_(c) {}

  [[nodiscard]] MotionState after(double t) const {
    const double z = c_ * t * t;
    // sinh(r)/r and (cosh(r) − 1)/r² with r² = z.
    double one = 1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0));
    double two = 0.5 * (1.0 + z / 12.0 * (1.0 + z / 30.0 * (1.0 + z / 56.0)));
    if (const double r = std::sqrt(std::abs(z)); r > 0.1) {
      one = (z > 0.0 ? std::sinh(r) : std::sin(r)) / r;
      two = ((z > 0.0 ? std::cosh(r) : std::cos(r)) - 1.0) / z;
    }
    const double s = t * (v0_ * one + t * w0_ * two);
    return {s, v0_ * (1.0 + z * two) + w0_ * t * one, w0_ + c_ * s, c_};
  }

  /// Time to `s`, where du/dt is `v`: s = (v0 + v) tanh(r/2)/√c with r² = c t².
  [[nodiscard]] double time_to(double s, double v) const {
    const double mean = 0.5 * (v0_ + v);
    const double z = c_ * s * s / (4.0 * mean * mean);
    const double root = std::sqrt(std::abs(z));
    if (root < 0.05) return s / mean * (1.0 + z * (1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0))));
    return s / mean * (z > 0.0 ? std::atanh(std::min(root, 1.0 - 1e-15)) : std::atan(root)) / root;
  }

 private:
  double v0_;
  double w0_;
  double c_;
};

/// A start from rest with constant d³u/dt³ that reaches `speed` after `length`: u = length · τ³.
struct StandstillMotion {
  double length = 0.0;
  double speed = 0.0;

  [[nodiscard]] double duration() const { return 3.0 * length / speed; }
  /// `time` after the start.
  [[nodiscard]] MotionState after_start(double time) const {
    const double part = std::min(1.0, time / duration());
    return {length * part * part * part, speed * part * part,
            2.0 / 3.0 * speed * speed / length * part,
            2.0 / 9.0 * (speed / length) * (speed / length) / (part * part)};
  }
  /// The mirror image, `time` after the stop has begun.
  [[nodiscard]] MotionState after_stop_began(double time) const {
    const MotionState mirrored = after_start(duration() - std::min(time, duration()));
    return {length - mirrored.s, mirrored.v, -mirrored.w, mirrored.dw};
  }
};

}  // namespace cnc::motion
