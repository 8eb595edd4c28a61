// The measured surface of a work piece: a grid of heights, as probed (ZHC…, manual 2.2.5.5).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "config/axis.h"
#include "config/error.h"
#include "motion/height_surface.h"

namespace cnc::server {

class HeightMap {
 public:
  HeightMap() = default;
  HeightMap(double grid_size, std::int32_t columns, std::int32_t rows)
      : grid_size_(grid_size), columns_(columns), rows_(rows) {}

  /// A point that the probe touched, machine coordinates. Refused before a grid was begun, and for
  /// more points than it has.
  Result<void> add(const Position& point);

  /// What is to be added to Z: heights against the first point. Refused while a point is missing,
  /// and for points that do not lie on a grid along X and Y.
  [[nodiscard]] Result<std::shared_ptr<const motion::HeightSurface>> surface() const;

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  /// "grid size columns rows", then "x y z" per point in the order in which they were measured.
  [[nodiscard]] std::string to_text() const;

 private:
  double grid_size_ = 0.0;  // mm
  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  std::vector<Position> points_;
};

}  // namespace cnc::server
