#include "server/machine/height_map.h"

#include <fmt/format.h>
#include <iterator>

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

std::string HeightMap::to_text() const {
  std::string text = fmt::format("grid {:.6f} {} {}\n", grid_size_, columns_, rows_);
  for (const Position& point : points_) {
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.6f} {:.6f}\n", point[Axis::X],
                   point[Axis::Y], point[Axis::Z]);
  }
  return text;
}

}  // namespace cnc::server
