// The nodes of a tube spline that are in hand: a window of the run and a little of what is behind
// it.
//
// One row of memory for each quantity, so that a loop over the nodes is arithmetic on neighbouring
// numbers, of which the processor does several at once.
#pragma once

#include <array>
#include <cstddef>

#include "config/axis.h"

namespace cnc::motion {

/// Nodes solved at once, and how many of them become final. Other sizes (40/20 … 400/200) change
/// the time of a job by 0.2 %.
inline constexpr std::size_t kTubeWindow = 100;
inline constexpr std::size_t kTubeCommit = 75;

/// The first node of a run; two ghosts stand before it.
inline constexpr std::size_t kFirstNode = 2;

/// The window, the ghosts at both ends of a run, and one node that becomes a row more when the
/// number of unknowns is odd.
inline constexpr std::size_t kMostNodes = 112;
static_assert(kMostNodes > kTubeWindow + 8);

/// One number for each node.
using NodeRow = std::array<double, kMostNodes>;

/// Weights of the control points before, at and behind each node.
struct Stencils {
  NodeRow before{};
  NodeRow at{};
  NodeRow behind{};
};

struct TubeNodes {
  /// What one axis does.
  struct AxisRows {
    NodeRow point{};           ///< r: where the program is
    NodeRow control{};         ///< c
    NodeRow middle{};          ///< the program half-way to the next node
    NodeRow middle_tangent{};  ///< its direction there
  };

  std::size_t count = 0;
  NodeRow step{};  ///< to the next node
  NodeRow tolerance{};
  std::array<bool, kMostNodes> fixed{};  ///< an end of the run

  // Filled in when both neighbours' steps are known; 0 before.
  NodeRow weight{};  ///< W: share of the length that belongs to the node
  Stencils position;
  Stencils bend;        ///< q''
  NodeRow stiffness{};  ///< λ, and its bounds
  NodeRow least_stiffness{};
  NodeRow most_stiffness{};

  AxisArray<AxisRows> axes;
  AxisArray<bool> moves{};  ///< in this run

  /// X Y Z, or A B C.
  static constexpr std::size_t kGroup = 3;
  [[nodiscard]] bool moves_in(std::size_t group) const {
    const bool* first = &moves.values[kGroup * group];
    return first[0] || first[1] || first[2];
  }
  [[nodiscard]] AxisRows* group(std::size_t group) { return &axes.values[kGroup * group]; }
  [[nodiscard]] const AxisRows* group(std::size_t group) const {
    return &axes.values[kGroup * group];
  }

  void clear() {
    count = 0;
    moves = {};
  }
  void push(const Position& point, double node_tolerance);
  /// Drops the nodes before number `i`.
  void drop_before(std::size_t i);
  /// Stencils, weight and first stiffness of node `i`.
  void complete(std::size_t i, double least);

  /// A stencil applied to the control points of an axis around node `i`.
  [[nodiscard]] double combine(const Stencils& stencils, Axis axis, std::size_t i) const {
    const NodeRow& c = axes[axis].control;
    return stencils.before[i] * c[i - 1] + stencils.at[i] * c[i] + stencils.behind[i] * c[i + 1];
  }
};

}  // namespace cnc::motion
