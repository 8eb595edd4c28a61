#include "motion/five_diagonals.h"

namespace cnc::motion {

void FiveDiagonalFactors::factorise(FiveDiagonals& matrix, std::size_t begin, std::size_t end) {
  auto& [diagonal, beside, beyond] = matrix;
  begin_ = begin;
  end_ = end;
  if ((end - begin) % 2 != 0) {
    diagonal[end] = 1.0;
    beside[end - 1] = beyond[end - 1] = 0.0;
    if (end - begin > 1) beyond[end - 2] = 0.0;
    ++end_;
  }
  pairs_ = (end_ - begin_) / 2 - 1;

  // What the rows eliminated so far take from the next two.
  Pair from_pivot{};
  Pair from_next_pivot{};
  Pair from_beside{};
  for (std::size_t k = 0; k < pairs_; ++k) {
    const Pair inverse = 1.0 / (pair_of(diagonal, k) - from_pivot);
    const Pair near = pair_of(beside, k, 1) - from_beside;
    const Pair far = pair_of(beyond, k, 2);
    const Pair next = near * inverse;
    const Pair next_but_one = far * inverse;
    from_pivot = from_next_pivot + near * next;
    from_next_pivot = far * next_but_one;
    from_beside = far * next;
    inverse_[k] = inverse;
    next_[k] = next;
    next_but_one_[k] = next_but_one;
  }
  const std::size_t middle = begin_ + pairs_;
  const double entry = beside[middle] - from_beside[0] - from_beside[1];
  first_ = 1.0 / (diagonal[middle] - from_pivot[0] - from_next_pivot[1]);
  between_ = entry * first_;
  second_ = 1.0 / (diagonal[middle + 1] - from_pivot[1] - from_next_pivot[0] - entry * between_);
}

void FiveDiagonalFactors::solve(const std::array<NodeRow*, 3>& sides) const {
  std::array<PairRow, 3> done;
  std::array<Pair, 3> x1{};
  std::array<Pair, 3> x2{};
  Pair next{};
  Pair next_but_one{};
  Pair next_but_one_before{};
  for (std::size_t k = 0; k < pairs_; ++k) {
    for (std::size_t s = 0; s < 3; ++s) {
      const Pair x = pair_of(*sides[s], k) - next_but_one_before * x2[s] - next * x1[s];
      done[s][k] = inverse_[k] * x;
      x2[s] = x1[s];
      x1[s] = x;
    }
    next = next_[k];
    next_but_one_before = next_but_one;
    next_but_one = next_but_one_[k];
  }
  for (std::size_t s = 0; s < 3; ++s) {
    NodeRow& side = *sides[s];
    // The last pair eliminated reaches both rows in the middle, the one before it the nearer.
    const Pair near = next * x1[s] + next_but_one_before * x2[s];
    const Pair far = next_but_one * x1[s];
    const std::size_t middle = begin_ + pairs_;
    const double first = side[middle] - near[0] - far[1];
    const double second = (side[middle + 1] - near[1] - far[0] - between_ * first) * second_;
    side[middle + 1] = second;
    side[middle] = first * first_ - between_ * second;
    x1[s] = Pair{side[middle], side[middle + 1]};
    x2[s] = Pair{side[middle + 1], side[middle]};
  }
  for (std::size_t k = pairs_; k-- > 0;) {
    for (std::size_t s = 0; s < 3; ++s) {
      const Pair x = done[s][k] - next_but_one_[k] * x2[s] - next_[k] * x1[s];
      x2[s] = x1[s];
      x1[s] = x;
      (*sides[s])[begin_ + k] = x[0];
      (*sides[s])[end_ - 1 - k] = x[1];
    }
  }
}

}  // namespace cnc::motion
