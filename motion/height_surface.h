// A measured surface as a smooth function of X and Y: what is added to Z over an uneven work piece
// (manual 2.2.5.5).
//
// Between the points of the grid it is the bicubic of Catmull and Rom: height and slope are
// continuous, the points themselves and planes are exact. Over the cell beside the grid its slope
// runs out, further away it is constant: a cut that leaves the measured area finds no step.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace cnc::motion {

/// Largest absolute derivatives of a surface; bounds, not exact.
struct SurfaceBounds {
  double slope_x = 0.0;
  double slope_y = 0.0;
  double bend_xx = 0.0;  ///< 1/mm
  double bend_xy = 0.0;
  double bend_yy = 0.0;
};

class HeightSurface {
 public:
  /// `heights`: columns * rows, along X first; their grid begins at (x, y). Size above 0, at least
  /// one point.
  HeightSurface(double x, double y, double size, std::size_t columns, std::size_t rows,
                std::span<const double> heights);

  struct Value {
    double height = 0.0;
    double slope_x = 0.0;
    double slope_y = 0.0;
  };
  [[nodiscard]] Value at(double x, double y) const;
  [[nodiscard]] const SurfaceBounds& bounds() const { return bounds_; }
  /// No height is outside of these.
  [[nodiscard]] double lowest() const { return lowest_; }
  [[nodiscard]] double highest() const { return highest_; }

 private:
  using Patch = std::array<std::array<double, 4>, 4>;  // Bezier points, [y][x]

  [[nodiscard]] double& padded(std::size_t column, std::size_t row) {
    return heights_[row * width_ + column];
  }
  [[nodiscard]] Patch patch(std::size_t column, std::size_t row) const;
  void pad();
  void measure();

  double x_;
  double y_;
  double size_;
  std::size_t width_;  // columns and rows with two more on either side
  std::size_t height_;
  std::vector<double> heights_;
  SurfaceBounds bounds_;
  double lowest_;
  double highest_;
};

}  // namespace cnc::motion
