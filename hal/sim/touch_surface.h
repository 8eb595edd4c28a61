// What a tool tip can touch, seen from above, in machine coordinates: the stock on the table and a
// tool setter beside it. The probe input is active while the tip is at or below the surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>

namespace cnc::hal::sim {

/// A square button.
struct ToolSetter {
  double x = 0.0;  ///< of its middle
  double y = 0.0;
  double half_width = 10.0;
  double top = 0.0;  ///< height at which it trips
};

struct TouchOptions {
  /// Height of the stock at (x, y); unset: no stock. Must not allocate: the board calls it.
  std::function<double(double, double)> stock{};
  std::optional<ToolSetter> tool_setter{};
  /// Tool number to length, for VirtualMachine::load_tool().
  std::map<int, double> tool_lengths{};
};

class TouchSurface {
 public:
  explicit TouchSurface(const TouchOptions& options)
      : stock_(options.stock), setter_(options.tool_setter) {}

  [[nodiscard]] bool exists() const { return stock_ || setter_; }

  [[nodiscard]] double height(double x, double y) const {
    const double stock = stock_ ? stock_(x, y) : -std::numeric_limits<double>::infinity();
    const bool on_setter = setter_ && std::abs(x - setter_->x) <= setter_->half_width &&
                           std::abs(y - setter_->y) <= setter_->half_width;
    return on_setter ? std::max(stock, setter_->top) : stock;
  }

 private:
  std::function<double(double, double)> stock_;
  std::optional<ToolSetter> setter_;
};

}  // namespace cnc::hal::sim
