#include "server/machine/height_map.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <optional>

namespace cnc::server {

Result<void> HeightMap::add(const Position& point) {
  if (points_.size() >= static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    return fail(ErrorCode::height_map_full,
                fmt::format("The height map has {} points; it was begun for {} by {}.",
                            points_.size(), columns_, rows_));
  }
  points_.push_back(point);
  return {};
}

Result<std::shared_ptr<const motion::HeightSurface>> HeightMap::surface() const {
  constexpr double kOffGrid = 0.05;  // parts of the grid's size
  const auto columns = static_cast<std::size_t>(columns_);
  const auto rows = static_cast<std::size_t>(rows_);
  if (points_.empty() || points_.size() < columns * rows)
    return fail(
        ErrorCode::height_map_unusable,
        fmt::format("The height map has {} of its {} points.", points_.size(), columns * rows));
  double x = points_.front()[Axis::X];
  double y = points_.front()[Axis::Y];
  for (const Position& point : points_) {
    x = std::min(x, point[Axis::X]);
    y = std::min(y, point[Axis::Y]);
  }
  std::vector<std::optional<double>> found(columns * rows);
  for (const Position& point : points_) {
    const double column = (point[Axis::X] - x) / grid_size_;
    const double row = (point[Axis::Y] - y) / grid_size_;
    const bool on_grid = std::abs(column - std::round(column)) <= kOffGrid &&
                         std::abs(row - std::round(row)) <= kOffGrid &&
                         std::round(column) < columns_ && std::round(row) < rows_;
    if (!on_grid)
      return fail(ErrorCode::height_map_unusable,
                  fmt::format("The point X{:.3f} Y{:.3f} (machine) does not lie on the grid of {} "
                              "by {} points every {} mm from X{:.3f} Y{:.3f}.",
                              point[Axis::X], point[Axis::Y], columns_, rows_, grid_size_, x, y));
    const auto at = static_cast<std::size_t>(std::round(row)) * columns +
                    static_cast<std::size_t>(std::round(column));
    found[at] = point[Axis::Z] - points_.front()[Axis::Z];
  }
  std::vector<double> heights;
  for (const auto& height : found) {
    if (!height)
      return fail(ErrorCode::height_map_unusable,
                  "A point of the height map was measured twice and another one not at all.");
    heights.push_back(*height);
  }
  return std::make_shared<const motion::HeightSurface>(x, y, grid_size_, columns, rows, heights);
}

std::string HeightMap::to_text() const {
  std::string text = fmt::format("grid {:.6f} {} {}\n", grid_size_, columns_, rows_);
  for (const Position& point : points_) {
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.6f} {:.6f}\n", point[Axis::X],
                   point[Axis::Y], point[Axis::Z]);
  }
  return text;
}

}  // namespace cnc::server
