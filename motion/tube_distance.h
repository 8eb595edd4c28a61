// How far a tube spline is from its program, over the tolerance.
//
// At the nodes and half-way between them it is measured. On the way e² is taken for the parabola
// through these three places, or, on a closer look, for two parabolas through the quarters as well.
// Between the nodes only what is across the program's direction counts.
#pragma once

#include <array>
#include <cstddef>

#include "motion/tube_nodes.h"

namespace cnc::motion {

class TubeDistance {
 public:
  /// X Y Z, or A B C: the weights are fetched only once for all three.
  static constexpr std::size_t kGroup = TubeNodes::kGroup;
  using GroupRows = std::array<NodeRow, kGroup>;

  /// Before anything else, once the nodes up to `last` are complete.
  void prepare(const TubeNodes& nodes, std::size_t last);
  void measure(const TubeNodes& nodes, std::size_t last);
  /// Behind measure(), up to any node.
  void look_closely(const TubeNodes& nodes, std::size_t last);

  /// The largest (e/P)² at each node and on the way to its neighbours; 0 at the ends of a run,
  /// which are met exactly.
  [[nodiscard]] const NodeRow& largest() const { return largest_; }
  /// q − r at the nodes.
  [[nodiscard]] const GroupRows& off(std::size_t group) const { return off_[group]; }

 private:
  /// Weights of the four control points around a span: where the path is half-way along it.
  struct MiddleStencils {
    std::array<NodeRow, 4> weight{};
  };
  /// e² at one place of each span: altogether, and along the program.
  struct Squares {
    NodeRow all{};
    NodeRow along{};
  };

  static void add_distances(const Stencils& e, const MiddleStencils& m,
                            const TubeNodes::AxisRows* axes, std::size_t last, GroupRows& off,
                            NodeRow& at_node, Squares& half_way);
  static void add_quarters(const TubeNodes& nodes, const TubeNodes::AxisRows* axes,
                           const GroupRows& off, std::size_t last, Squares& quarter,
                           Squares& three_quarters, NodeRow& bow);
  void collect_largest(std::size_t last);

  NodeRow per_tolerance_{};   // 1/P² at the nodes, 0 at the ends of a run
  NodeRow span_tolerance_{};  // P² on the way to the next node
  MiddleStencils middle_;

  std::array<GroupRows, kAxisCount / kGroup> off_{};
  NodeRow at_node_{};
  Squares half_way_;
  NodeRow peak_{};  // on the way to the next node
  NodeRow largest_{};
};

}  // namespace cnc::motion
