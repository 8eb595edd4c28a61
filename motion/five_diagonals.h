// A symmetric positive definite matrix with five diagonals, and systems of equations with it.
//
// Rows are eliminated from both ends at once. That takes no more arithmetic than from one end, but
// the divisions of one end do not wait for those of the other, and both are done by the same vector
// instruction: half the time.
#pragma once

#include <array>
#include <cstddef>

#include "motion/pair.h"
#include "motion/tube_nodes.h"

namespace cnc::motion {

/// Entries (j, j), (j, j + 1) and (j, j + 2).
struct FiveDiagonals {
  NodeRow diagonal{};
  NodeRow beside{};
  NodeRow beyond{};
};

class FiveDiagonalFactors {
 public:
  /// Factorises rows and columns `begin` to `end` − 1, two at least. Where their number is odd, row
  /// `end` becomes one more, whose unknown is 0 when its right-hand side is.
  void factorise(FiveDiagonals& matrix, std::size_t begin, std::size_t end);
  /// Solves for three right-hand sides; each becomes its solution.
  void solve(const std::array<NodeRow*, 3>& sides) const;

 private:
  /// Of each pair, one row from the front and one from the back.
  using PairRow = std::array<Pair, kMostNodes / 2>;

  /// Elements number `k` from the front and `k` + `back` from the back.
  [[nodiscard]] Pair pair_of(const NodeRow& row, std::size_t k, std::size_t back = 0) const {
    return Pair{row[begin_ + k], row[end_ - 1 - k - back]};
  }

  std::size_t begin_ = 0;
  std::size_t end_ = 0;    // even number of rows
  std::size_t pairs_ = 0;  // eliminated; the two rows in the middle are left
  // Of each pair of rows: 1/pivot, and the entries towards the middle over the pivot.
  PairRow inverse_{};
  PairRow next_{};
  PairRow next_but_one_{};
  // The two rows in the middle.
  double first_ = 0.0;  // inverse of the pivots
  double second_ = 0.0;
  double between_ = 0.0;  // their common entry over the first pivot
};

}  // namespace cnc::motion
