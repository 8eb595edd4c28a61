// Two functions of a slack s, the part of a limit that is not used: what makes an optimiser keep
// away from the limit.
#pragma once

#include <cmath>

namespace cnc::motion {

struct Barrier {
  double slope;  ///< by s
  double bend;
};

/// −log s, continued as a parabola below `least`, so that a plan may break the limit on its way to
/// keeping it (relaxed barrier: Feller & Ebenbauer, "Relaxed logarithmic barrier function based
/// model predictive control of linear systems", IEEE TAC 62, 2017).
struct HardBarrier {
  double least;

  [[nodiscard]] double value(double s) const {
    if (s > least) return -std::log(s);
    const double below = (s - 2.0 * least) / least;
    return 0.5 * (below * below - 1.0) - std::log(least);
  }
  [[nodiscard]] Barrier at(double s) const {
    if (s > least) return {-1.0 / s, 1.0 / (s * s)};
    return {(s - 2.0 * least) / (least * least), 1.0 / (least * least)};
  }
};

/// −log s, continued as a straight line below `least`: a wish that gives way to hard limits.
struct SoftBarrier {
  double least;

  [[nodiscard]] double value(double s) const {
    return s > least ? -std::log(s) : 1.0 - s / least - std::log(least);
  }
  [[nodiscard]] Barrier at(double s) const {
    if (s > least) return {-1.0 / s, 1.0 / (s * s)};
    return {-1.0 / least, 0.0};
  }
};

}  // namespace cnc::motion
