// The smoothest path inside a tube around the program.
//
// Of all curves that stay within the tolerance of the programmed path, the fastest is close to the
// one with the least bending ∫|q''|² dt, with t the length along the program: what an axis has to
// accelerate at speed v is q'' v². The curve is a cubic B-spline with one control point per node,
// so it is C²; nodes are points of the program, the path passes each within its tolerance.
//
// The optimality condition of that problem is a smoothing spline: (DᵀWD + EᵀΛE) c = EᵀΛ r, with one
// stiffness λ ≥ 0 per node (Reinsch, "Smoothing by Spline Functions", Numer. Math. 10, 1967). E and
// D give position and second derivative at the nodes from the control points c, r are the program's
// points. The matrix is pentadiagonal and the same for all axes. The λ are found by iteration: up
// where the path leaves the tube, down where it has room.
//
// It streams: a window of nodes is solved, its front is committed and never changes again, its tail
// is solved once more together with what comes. Committed control points enter the stencils of the
// next window as data, so the curve is exactly C² across windows.
#pragma once

#include <cstddef>
#include <vector>

#include "config/axis.h"
#include "motion/curve.h"
#include "motion/tube_nodes.h"
#include "motion/tube_relaxation.h"

namespace cnc::motion {

/// The way from one node to the next.
struct TubeSpan {
  double length = 0.0;         ///< along the program, > 0
  Position middle;             ///< of the program, at half the length
  Position middle_tangent;     ///< there, of unit length over all six axes
  Position end;                ///< the next node
  double end_tolerance = 0.0;  ///< how far the path may pass from it
};

class TubeSpline {
 public:
  /// `least_stiffness`: smallest λ in units of a node's natural one, 1e-4 … 1. With 1e-4 the path
  /// uses all of the tube; more brings it nearer to the program on average and costs time.
  explicit TubeSpline(double least_stiffness = 1e-4);

  /// A new run from standstill at `start`. Only when nothing is left of the last.
  void begin(const Position& start, double tolerance);
  /// Extends the run by a span.
  void add(const TubeSpan& span);
  /// The run ends at its last node; everything becomes ready.
  void finish();

  /// A span that is final; spans come out in the order in which they went in.
  struct Ready {
    Cubic curve;
    bool stop_at_end = false;  ///< the run had to be broken here, or ends
  };
  [[nodiscard]] std::size_t ready() const { return ready_.size() - taken_; }
  [[nodiscard]] const Ready& front() const { return ready_[taken_]; }
  void pop();

  /// Drops everything.
  void clear();
  /// Spans that went in and have not come out.
  [[nodiscard]] std::size_t pending() const { return pending_; }

 private:
  void start(const Position& point, double tolerance);
  void complete(std::size_t last);
  void place_control(std::size_t i);

  void solve_window(std::size_t last_node, std::size_t commit, bool run_ends);
  void close();
  void break_run(std::size_t node, std::size_t last_node, bool run_ends);
  void meet_start();
  void meet_end(std::size_t last_node);
  void emit(std::size_t last_node, bool stop);
  [[nodiscard]] Position bend_of_program() const;
  void drop_before(std::size_t i);
  [[nodiscard]] std::size_t first_row() const;

  double least_stiffness_;
  TubeNodes nodes_;  // two ghosts before the run's first node
  TubeRelaxation relaxation_;
  std::size_t free_ = 0;       // first control point that may still change
  std::size_t completed_ = 0;  // nodes before this one have stencils and control points
  std::size_t pending_ = 0;
  std::vector<Ready> ready_;
  std::size_t taken_ = 0;
};

}  // namespace cnc::motion
