// The height of a stock over a grid in machine X and Y, bilinear in between.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cnc::hal::sim {

struct HeightMap {
  double x = 0.0;                 ///< of the first point of a row
  double y = 0.0;                 ///< of the first row
  double dx = 1.0;                ///< between two points of a row, above 0
  double dy = 1.0;                ///< between two rows, above 0
  std::size_t columns = 0;        ///< points in a row, at least 2
  std::vector<double> heights{};  ///< row by row, at least two rows

  /// Nothing, minus infinity, outside of the grid.
  [[nodiscard]] double operator()(double at_x, double at_y) const {
    const double column = (at_x - x) / dx;
    const double row = (at_y - y) / dy;
    const auto last_column = static_cast<double>(columns - 1);
    const auto last_row = static_cast<double>(heights.size() / columns - 1);
    if (!(column >= 0.0 && column <= last_column && row >= 0.0 && row <= last_row)) {
      return -std::numeric_limits<double>::infinity();
    }
    // On the far edge the cell before it is used, at its end.
    const double left = std::min(std::floor(column), last_column - 1.0);
    const double near = std::min(std::floor(row), last_row - 1.0);
    const auto corner = static_cast<std::size_t>(near) * columns + static_cast<std::size_t>(left);
    return std::lerp(
        std::lerp(heights[corner], heights[corner + 1], column - left),
        std::lerp(heights[corner + columns], heights[corner + columns + 1], column - left),
        row - near);
  }
};

}  // namespace cnc::hal::sim
