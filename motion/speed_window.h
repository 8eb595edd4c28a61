// The third-order speed plan as an optimisation problem, and the rounds that solve it.
//
// x = (du/dt)² is a quadratic spline over the cells, continuous with its derivative 2w. Its degrees
// of freedom are the middle Bernstein coefficients, one per cell: where two cells meet, x lies on
// the line between their coefficients and w is that line's slope. Every limit involves three
// neighbouring coefficients, so that one Newton step costs a fixed time per cell (a matrix of five
// diagonals).
//
// Least time under the limits is sought with barriers (Boyd & Vandenberghe, "Convex Optimization",
// 2004, chapter 11) whose weight falls from round to round. The barriers are relaxed: a round may
// start from, and leave, a plan that breaks limits; usage() tells when it keeps them all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "motion/ring.h"
#include "motion/speed_cell.h"

namespace cnc::motion {

/// x where two cells meet: before · (middle of the cell before) + behind · (middle of the cell
/// behind) + given.
struct Knot {
  double before = 0.0;
  double behind = 0.0;
  double given = 0.0;
};

/// With x = middle coefficient of a cell and a constant-jerk stretch of length `stretch` beside it:
/// x where they meet, as a part. (w = (2/3) x/stretch there.)
[[nodiscard]] inline double part_beside_standstill(double length, double stretch) {
  return 1.0 / (1.0 + 2.0 / 3.0 * length / stretch);
}

[[nodiscard]] inline Knot knot_between(double before, double behind) {
  return {behind / (before + behind), before / (before + behind), 0.0};
}

struct PlannedCell {
  SpeedCell cell;
  Knot knot;                ///< at its begin
  double distance = 0.0;    ///< at its begin, along the run
  double guess = 0.0;       ///< while a guess is made
  double x = 0.0;           ///< middle coefficient that is worked on
  double x_in_force = 0.0;  ///< and that of the finished plan
  double wanted_x = 0.0;    ///< largest x for feed and override
  /// wanted_x is a limit; otherwise x may have to be above it for a while.
  bool feed_is_kept = true;
  double weight = 0.0;  ///< of its barriers, as a part of its time; falls with every round
  double least = 0.0;   ///< slack below which they are relaxed; falls too
};

/// `cell` behind `before`, not planned yet.
[[nodiscard]] inline PlannedCell planned_behind(const PlannedCell& before, const SpeedCell& cell) {
  PlannedCell planned;
  planned.cell = cell;
  planned.knot = knot_between(before.cell.length, cell.length);
  planned.distance = before.distance + before.cell.length;
  return planned;
}

/// The end of the cells: what x is there, and how much it may be. Behind it is a stop.
struct EndOfCells {
  Knot knot;
  double most_x = 0.0;
};

/// A part of a limit that is used, and the cell where.
struct Usage {
  double part = 0.0;
  std::uint64_t cell = 0;
};

class SpeedWindow {
 public:
  explicit SpeedWindow(std::size_t max_cells);

  Ring<PlannedCell> cells;
  std::uint64_t begin_cell = 0;  ///< first cell of the problem; those before it are left alone
  EndOfCells end;
  double most_start_x = 0.0;  ///< x at the begin of the first cell

  /// Bernstein coefficients of a cell as worked on.
  [[nodiscard]] CellX x_of(std::uint64_t index) const;

  /// Lets the rounds begin anew for the middle coefficients [first, end).
  void reset_weights(std::uint64_t first);
  /// Raises the barriers of the cells that break a limit.
  void defend_harder(std::uint64_t first);
  /// One Newton step for the middle coefficients [first, end). False when there is nothing left to
  /// gain.
  bool improve(std::uint64_t first);
  /// The largest part of a limit (less the reserve) that is used from cell `first` on; not a number
  /// if x is none anywhere.
  [[nodiscard]] double usage(std::uint64_t first) const { return worst(first).part; }
  [[nodiscard]] Usage worst(std::uint64_t first) const;

 private:
  /// What a round wants of a cell; fixed during the round.
  struct Goal {
    Defence defence;
    double wanted_x;
    double wish_weight;          ///< of the feed's barrier
    double wish_least;           ///< slack below which it is a linear price
    std::array<double, 3> most;  ///< largest x
    std::array<double, 3> most_weight;

    [[nodiscard]] double cost(const CellX& x, double third) const;
    void add_cost(const CellX& x, double third, CellModel& model) const;
  };

  [[nodiscard]] double usage_of(std::uint64_t index) const;
  [[nodiscard]] std::uint64_t first_touched(std::uint64_t first) const;
  [[nodiscard]] Goal goal_of(std::uint64_t index) const;
  void assemble(std::uint64_t first);
  void add_to_system(std::uint64_t index, std::uint64_t first, const CellModel& model);
  void solve(std::size_t size);
  [[nodiscard]] double merit(std::uint64_t first, double part) const;
  [[nodiscard]] CellX moved_x(std::uint64_t index, std::uint64_t first, double part) const;
  [[nodiscard]] double most_speed_x(std::uint64_t index) const;
  [[nodiscard]] std::array<double, 3> most_x(std::uint64_t index) const;

  std::vector<Goal> goals_;
  std::vector<double> gradient_;
  std::vector<double> step_;
  std::array<std::vector<double>, 3> diagonal_;
};

}  // namespace cnc::motion
