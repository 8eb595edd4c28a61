#include "motion/height_surface.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {
namespace {

constexpr std::size_t kPad = 2;

using Four = std::array<double, 4>;

/// The Bezier points of the curve of Catmull and Rom between p[1] and p[2].
Four bezier_of(const Four& p) {
  return {p[1], p[1] + (p[2] - p[0]) / 6.0, p[2] - (p[3] - p[1]) / 6.0, p[2]};
}

struct Point {
  double value;
  double slope;  // per unit of u
};

/// de Casteljau
Point point_of(const Four& b, double u) {
  const auto mix = [u](double p, double q) { return p + u * (q - p); };
  const double ab = mix(b[0], b[1]);
  const double bc = mix(b[1], b[2]);
  const double cd = mix(b[2], b[3]);
  const double left = mix(ab, bc);
  const double right = mix(bc, cd);
  return {mix(left, right), 3.0 * (right - left)};
}

/// Where a coordinate lies: in which cell of the padded grid, and how far in it, 0 … 1.
struct Place {
  std::size_t cell;
  double part;
};

Place place_of(double coordinate, double first, double size, std::size_t count) {
  const double last = static_cast<double>(count - kPad);
  const double in_grid = (coordinate - first) / size + double{kPad};
  const double u = std::clamp(in_grid, 1.0, last);
  const double cell = std::min(std::floor(u), last - 1.0);
  return {static_cast<std::size_t>(cell), u - cell};
}

/// Two more values on either side, in place: the slope of the end goes on for one cell, at whose
/// end it is 0. `step` is the way between two values.
void pad_line(double* first, std::size_t count, std::size_t step) {
  const auto at = [&](std::size_t i) -> double& { return first[i * step]; };
  const std::size_t low = kPad;
  const std::size_t high = count - kPad - 1;
  const bool single = low == high;
  at(low - 1) = single ? at(low) : 2.0 * at(low) - at(low + 1);
  at(high + 1) = single ? at(high) : 2.0 * at(high) - at(high - 1);
  at(low - 2) = at(low);
  at(high + 2) = at(high);
}

}  // namespace

HeightSurface::HeightSurface(double x, double y, double size, std::size_t columns, std::size_t rows,
                             std::span<const double> heights)
    : x_(x),
      y_(y),
      size_(size),
      width_(columns + 2 * kPad),
      height_(rows + 2 * kPad),
      heights_(width_ * height_) {
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      padded(column + kPad, row + kPad) = heights[row * columns + column];
  pad();
  measure();
}

void HeightSurface::pad() {
  for (std::size_t row = kPad; row + kPad < height_; ++row) pad_line(&padded(0, row), width_, 1);
  for (std::size_t column = 0; column < width_; ++column)
    pad_line(&padded(column, 0), height_, width_);
}

/// Of the cell between `column`, `row` and the next of both.
HeightSurface::Patch HeightSurface::patch(std::size_t column, std::size_t row) const {
  Patch along_x;
  for (std::size_t j = 0; j < 4; ++j) {
    const double* line = &heights_[(row + j - 1) * width_ + column - 1];
    along_x[j] = bezier_of({line[0], line[1], line[2], line[3]});
  }
  Patch patch;
  for (std::size_t i = 0; i < 4; ++i) {
    const Four column_points =
        bezier_of({along_x[0][i], along_x[1][i], along_x[2][i], along_x[3][i]});
    for (std::size_t j = 0; j < 4; ++j) patch[j][i] = column_points[j];
  }
  return patch;
}

HeightSurface::Value HeightSurface::at(double x, double y) const {
  const Place column = place_of(x, x_, size_, width_);
  const Place row = place_of(y, y_, size_, height_);
  const Patch points = patch(column.cell, row.cell);
  Four values;
  Four slopes;
  for (std::size_t j = 0; j < 4; ++j) {
    const Point point = point_of(points[j], column.part);
    values[j] = point.value;
    slopes[j] = point.slope;
  }
  const Point value = point_of(values, row.part);
  return {value.value, point_of(slopes, row.part).value / size_, value.slope / size_};
}

/// A Bezier patch and its derivatives lie within their control points (Farin, Curves and Surfaces
/// for CAGD): differences of these bound the slopes and bends everywhere.
void HeightSurface::measure() {
  lowest_ = highest_ = patch(1, 1)[0][0];
  const auto raise = [](double& bound, double value) { bound = std::max(bound, std::abs(value)); };
  for (std::size_t row = 1; row + kPad < height_; ++row) {
    for (std::size_t column = 1; column + kPad < width_; ++column) {
      const Patch b = patch(column, row);
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i) {
          lowest_ = std::min(lowest_, b[j][i]);
          highest_ = std::max(highest_, b[j][i]);
          const double first = 3.0 / size_;
          const double second = 6.0 / (size_ * size_);
          if (i < 3) raise(bounds_.slope_x, first * (b[j][i + 1] - b[j][i]));
          if (j < 3) raise(bounds_.slope_y, first * (b[j + 1][i] - b[j][i]));
          if (i < 2) raise(bounds_.bend_xx, second * (b[j][i + 2] - 2.0 * b[j][i + 1] + b[j][i]));
          if (j < 2) raise(bounds_.bend_yy, second * (b[j + 2][i] - 2.0 * b[j + 1][i] + b[j][i]));
          if (i < 3 && j < 3)
            raise(bounds_.bend_xy,
                  first * first * (b[j + 1][i + 1] - b[j + 1][i] - b[j][i + 1] + b[j][i]));
        }
      }
    }
  }
}

}  // namespace cnc::motion
