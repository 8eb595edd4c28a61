// The correction of a motor's pitch as a smooth function of position.
//
// Through the measured points goes a monotone cubic (Fritsch and Carlson, SIAM J. Numer. Anal. 17,
// 1980, with the harmonic mean of the slopes on both sides): velocity stays continuous, and between
// two points the correction never leaves what was measured there. Beyond the table it is constant.
#pragma once

#include <span>
#include <vector>

#include "config/machine_config.h"

namespace cnc::motion {

class PitchCurve {
 public:
  /// Corrects nothing.
  PitchCurve() = default;
  /// At least two points, both columns rising.
  explicit PitchCurve(std::span<const config::PitchPoint> points);

  struct Value {
    double correction = 0.0;  ///< to be added to the true position
    double slope = 0.0;       ///< per unit of way
  };
  /// What the motor has to do more to be at `position` in truth.
  [[nodiscard]] Value at(double position) const;
  /// The true position of a motor that stands at `motor`.
  [[nodiscard]] double undone(double motor) const;

  [[nodiscard]] double steepest() const { return steepest_; }        ///< largest |slope|
  [[nodiscard]] double most_curved() const { return most_curved_; }  ///< largest |change of slope|
  [[nodiscard]] double largest() const;                              ///< largest |correction|

 private:
  struct Knot {
    double position;
    double correction;
    double slope;
  };
  void choose_slopes();
  void measure();

  std::vector<Knot> knots_;
  double steepest_ = 0.0;
  double most_curved_ = 0.0;
};

}  // namespace cnc::motion
