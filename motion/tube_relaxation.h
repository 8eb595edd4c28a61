// The iteration of the tube spline (tube_spline.h): measure, stiffen, correct.
#pragma once

#include <cstddef>

#include "motion/five_diagonals.h"
#include "motion/tube_distance.h"
#include "motion/tube_nodes.h"

namespace cnc::motion {

/// What a stiffness of 1 at a node adds to the matrix: products of its stencil's weights.
struct StiffnessShares {
  NodeRow before{};
  NodeRow at{};
  NodeRow behind{};
  NodeRow before_at{};
  NodeRow at_behind{};
  NodeRow before_behind{};
};

class TubeRelaxation {
 public:
  /// Moves the control points from `free` to the one behind node `last` so that the path comes into
  /// the tube; the nodes are all complete. Whether it is inside up to node `last_checked`.
  [[nodiscard]] bool relax(TubeNodes& nodes, std::size_t free, std::size_t last,
                           std::size_t last_checked);

  /// Whether the path was too near to the tube's wall at the node, or on the way to one of its
  /// neighbours, when it was measured last. Never at the ends of a run, which are met exactly.
  [[nodiscard]] bool is_outside(std::size_t node) const;

 private:
  void prepare(const TubeNodes& nodes, std::size_t last);
  [[nodiscard]] bool within(double part, std::size_t first, std::size_t last) const;
  void correct(TubeNodes& nodes, std::size_t free, std::size_t last, bool in_balance);

  TubeDistance distance_;

  // Does not change from round to round:
  FiveDiagonals bending_;
  StiffnessShares share_;

  NodeRow balance_{};  // the stiffnesses that the present control points are the solution for
  FiveDiagonals matrix_;
  FiveDiagonalFactors factors_;
  TubeDistance::GroupRows correction_{};  // scratch
};

}  // namespace cnc::motion
