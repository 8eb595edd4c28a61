// The solver behind the tube spline, against the product of matrix and solution.
#include "motion/five_diagonals.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/motion/dice.h"

namespace cnc::motion::test {

namespace {

/// SᵀS + small I, where each row of S has three neighbouring entries, as in a smoothing spline.
FiveDiagonals random_matrix(Dice& dice, std::size_t begin, std::size_t end) {
  FiveDiagonals matrix;
  for (std::size_t j = begin; j < end; ++j) matrix.diagonal[j] = 1e-3;
  for (std::size_t j = begin; j + 2 < end; ++j) {
    const double a = dice.between(-1, 1);
    const double b = dice.between(-3, 3);
    const double c = dice.between(-1, 1);
    matrix.diagonal[j] += a * a;
    matrix.diagonal[j + 1] += b * b;
    matrix.diagonal[j + 2] += c * c;
    matrix.beside[j] += a * b;
    matrix.beside[j + 1] += b * c;
    matrix.beyond[j] += a * c;
  }
  return matrix;
}

double product(const FiveDiagonals& matrix, const NodeRow& x, std::size_t begin, std::size_t end,
               std::size_t j) {
  double sum = matrix.diagonal[j] * x[j];
  if (j + 1 < end) sum += matrix.beside[j] * x[j + 1];
  if (j + 2 < end) sum += matrix.beyond[j] * x[j + 2];
  if (j >= begin + 1) sum += matrix.beside[j - 1] * x[j - 1];
  if (j >= begin + 2) sum += matrix.beyond[j - 2] * x[j - 2];
  return sum;
}

}  // namespace

TEST_CASE("Five diagonals are solved for any number of rows, even and odd", "[GCO-6]") {
  Dice dice(11);
  FiveDiagonalFactors factors;
  for (std::size_t rows = 2; rows < kMostNodes - 5; ++rows) {
    const std::size_t begin = 1 + rows % 4;
    const std::size_t end = begin + rows;
    const FiveDiagonals matrix = random_matrix(dice, begin, end);
    std::array<NodeRow, 3> sides{};
    for (NodeRow& side : sides) {
      for (std::size_t j = begin; j < end; ++j) side[j] = dice.between(-1, 1);
    }
    std::array<NodeRow, 3> solutions = sides;
    FiveDiagonals used_up = matrix;
    factors.factorise(used_up, begin, end);
    factors.solve({&solutions[0], &solutions[1], &solutions[2]});
    double worst = 0.0;
    for (std::size_t s = 0; s < 3; ++s) {
      for (std::size_t j = begin; j < end; ++j) {
        const double left = product(matrix, solutions[s], begin, end, j) - sides[s][j];
        worst = std::max(worst, std::abs(left));
      }
    }
    INFO(rows << " rows");
    // Solutions may be 1 / 1e-3 times their right-hand sides; 15 digits of those.
    CHECK(worst < 1e-10);
  }
}

}  // namespace cnc::motion::test
