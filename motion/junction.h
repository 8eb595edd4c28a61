// What happens where two curves of a path meet.
#pragma once

#include "motion/curve.h"

namespace cnc::motion {

enum class JunctionKind : std::uint8_t {
  smooth,  ///< the direction does not change: passed at speed
  corner,  ///< the machine stands still at the vertex
  blend,   ///< passed at speed on a blend that replaces the surroundings of the vertex
};

struct Junction {
  JunctionKind kind = JunctionKind::corner;
  double cut = 0.0;  ///< for a blend: how much it takes of each curve, mm
};

/// A blend leaves the programmed path by at most this, mm: 0.1 µm, below a step of any machine.
inline constexpr double kExactPathTolerance = 1e-4;

/// Largest deviation, largest angle (degrees) and how much of either curve a blend may use, mm.
struct BlendLimits {
  double tolerance = kExactPathTolerance;
  double angle = 1.0;
  double free_before = 0.0;
  double free_after = 0.0;
};

/// `before` ends at its parameter `before_end`; `after` begins at 0.
[[nodiscard]] Junction judge_junction(const Curve& before, double before_end, const Curve& after,
                                      const BlendLimits& limits);

/// The blend from `cut` before the end of `before` to `cut` after the begin of `after`.
[[nodiscard]] Cubic make_blend(const Curve& before, double before_end, const Curve& after,
                               double cut);

}  // namespace cnc::motion
