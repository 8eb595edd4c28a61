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

#include <array>
#include <cstddef>
#include <vector>

#include "config/axis.h"
#include "motion/curve.h"
#include "motion/lanes.h"

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
  /// Weights of the control points before, at and behind a node.
  struct Stencil {
    double before;
    double at;
    double behind;
  };
  struct Node {
    double step = 0.0;  ///< to the next node
    double tolerance = 0.0;
    double weight = 0.0;     ///< W: share of the length that belongs to the node
    Stencil position{};      ///< q
    Stencil bend{};          ///< q''
    double natural = 0.0;    ///< λ*
    double stiffness = 0.0;  ///< λ; 0: not begun
    double ratio = 0.0;      ///< distance from the program over tolerance
    bool fixed = false;      ///< an end of the run
  };
  using Row = std::vector<double>;
  /// X Y Z A, or B C: what the solver knows of the axes at each node.
  struct Group {
    std::vector<Lanes> point;
    std::vector<Lanes> control;
    std::vector<Lanes> middle;          // of the span behind each node
    std::vector<Lanes> middle_tangent;  // likewise
    std::vector<Lanes> q;               // scratch of the solver
    std::vector<Lanes> q2;
    std::vector<Lanes> gradient;
    bool moves = false;
  };
  static constexpr std::size_t kGroups = 2;
  /// What outlives a window.
  [[nodiscard]] static std::array<std::vector<Lanes>*, 4> kept(Group& group);

  void start(const Position& point, double tolerance);
  void push_node(const Position& point, double tolerance);
  void complete(std::size_t last);
  void set_stencils(std::size_t i);
  void place_control(std::size_t i);

  void solve_window(std::size_t last_node, std::size_t commit, bool run_ends);
  void close();
  void break_run(std::size_t node, std::size_t last_node, bool run_ends);
  [[nodiscard]] bool relax(std::size_t last_node, std::size_t last_checked);
  void measure(std::size_t last_node);
  void stiffen(std::size_t last_node, bool offenders_only);
  void correct(std::size_t last_node);
  void assemble(std::size_t last_node);
  void factorise(std::size_t begin, std::size_t end);
  void meet_start();
  void meet_end(std::size_t last_node);
  void emit(std::size_t last_node, bool stop);
  void drop_before(std::size_t i);
  [[nodiscard]] std::size_t first_row() const;
  void evaluate(Group& group, std::size_t last_node) const;
  void descend(Group& group, std::size_t last_node) const;
  void solve(Group& group, std::size_t last_node) const;
  [[nodiscard]] static Lanes lanes_of(const Position& position, std::size_t group);
  [[nodiscard]] Position position_of(std::vector<Lanes> Group::*lanes, std::size_t i) const;
  [[nodiscard]] Position combine(const Stencil& stencil, std::size_t i,
                                 const Position& standing) const;

  double least_stiffness_;
  std::vector<Node> nodes_;  // two ghosts before the run's first node
  std::array<Group, kGroups> groups_;
  AxisArray<bool> moves_{};
  std::size_t free_ = 0;       // first control point that may still change
  std::size_t emitted_ = 0;    // node up to which spans have come out
  std::size_t completed_ = 0;  // nodes before this one have stencils and control points
  std::size_t pending_ = 0;
  // scratch of the solver
  Row diagonal_;
  Row beside_;
  Row beyond_;
  std::vector<Ready> ready_;
  std::size_t taken_ = 0;
};

}  // namespace cnc::motion
