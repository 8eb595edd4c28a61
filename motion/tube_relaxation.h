// The iteration of the tube spline (tube_spline.h): measure, stiffen, correct.
#pragma once

#include <array>
#include <cstddef>

#include "motion/five_diagonals.h"
#include "motion/tube_nodes.h"

namespace cnc::motion {

/// Weights of the four control points around a span: where the path is half-way along it.
struct MiddleStencils {
  std::array<NodeRow, 4> weight{};
};

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

  /// Whether the path left the tube at the node, or half-way to one of its neighbours, when it was
  /// measured last. Never at the ends of a run, which are met exactly.
  [[nodiscard]] bool is_outside(std::size_t node) const { return off_[node] > kOutside; }

  /// X Y Z, or A B C: what is done with the rows of one is done with those of all three, so that
  /// the weights are fetched only once.
  static constexpr std::size_t kGroup = TubeNodes::kGroup;
  struct Path {
    NodeRow off{};         ///< q − r
    NodeRow correction{};  ///< of the control points
  };
  using GroupPath = std::array<Path, kGroup>;

 private:
  /// The iteration aims at this part of the tolerance at the nodes; what is left is for the path
  /// between them.
  static constexpr double kTarget = 0.93;
  static constexpr double kOutside = 1.0 / (kTarget * kTarget);

  void prepare(const TubeNodes& nodes, std::size_t last);
  void measure(const TubeNodes& nodes, std::size_t last);
  [[nodiscard]] bool within(double part, std::size_t first, std::size_t last) const;
  void correct(TubeNodes& nodes, std::size_t free, std::size_t last, bool in_balance);

  // Does not change from round to round:
  NodeRow scale_{};  // 1 / target², 0 at the ends of a run
  MiddleStencils middle_;
  FiveDiagonals bending_;
  StiffnessShares share_;

  // Of the present control points:
  std::array<GroupPath, kAxisCount / kGroup> path_{};
  NodeRow off_{};      // largest distance at and beside a node, over the target, squared
  NodeRow balance_{};  // the stiffnesses that they are the solution for

  FiveDiagonals matrix_;
  FiveDiagonalFactors factors_;
  // scratch
  NodeRow at_node_{};
  NodeRow half_way_{};
  NodeRow along_{};
};

}  // namespace cnc::motion
