#include "server/job/travel_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace cnc::server {
namespace {

/// Programs reach a limit exactly by way of sums and offsets; a tenth of a micrometre is rounding.
constexpr double kTolerance = 1e-4;

struct Side {
  Axis axis;
  double low;
  double high;
};
[[nodiscard]] std::array<Side, 3> sides_of(const config::ToolChangeArea& area) {
  return {{{Axis::X, area.x_low, area.x_high},
           {Axis::Y, area.y_low, area.y_high},
           {Axis::Z, area.z_low, area.z_high}}};
}

std::unexpected<Error> refuse_area() {
  return fail(ErrorCode::tool_change_area,
              "The move goes through the tool change area, which only a tool change may enter.");
}

}  // namespace

Result<void> check_thread_speed(const config::MachineConfig& config, const Position& way,
                                double feed) {
  constexpr double kRoom = 0.8;
  const double length = linear_length(way);
  if (length == 0.0) return {};
  for (const Axis axis : kLinearAxes) {
    const double speed = feed * std::abs(way[axis]) / length;
    const double limit = kRoom * config.axes[axis].velocity;
    if (speed <= limit || !config.axes[axis].programmable()) continue;
    return fail(ErrorCode::thread_too_fast,
                fmt::format("At the spindle's speed {} would have to move at {:.3f} mm/s; {:.3f} "
                            "are possible for a thread.",
                            axis_name(axis), speed, limit));
  }
  return {};
}

// The part of the line, 0 … 1, that is between both ends of a side shrinks with every side.
Result<void> check_tool_change_area(const config::ToolChangeArea& area, const Position& start,
                                    const Position& end) {
  if (!area.exists()) return {};
  double enters = 0.0;
  double leaves = 1.0;
  for (const auto& [axis, low, high] : sides_of(area)) {
    const double way = end[axis] - start[axis];
    if (way == 0.0) {
      if (start[axis] <= low || start[axis] >= high) return {};
      continue;
    }
    const double at_low = (low - start[axis]) / way;
    const double at_high = (high - start[axis]) / way;
    enters = std::max(enters, std::min(at_low, at_high));
    leaves = std::min(leaves, std::max(at_low, at_high));
  }
  if (enters < leaves) return refuse_area();
  return {};
}

Result<void> check_tool_change_area(const config::ToolChangeArea& area,
                                    const motion::Extents& extents) {
  if (!area.exists()) return {};
  for (const auto& [axis, low, high] : sides_of(area))
    if (extents.max[axis] <= low || extents.min[axis] >= high) return {};
  return refuse_area();
}

Result<void> check_travel(const config::MachineConfig& config, const motion::Extents& extents) {
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& limits = config.axes[axis];
    const double low = extents.min[axis];
    const double high = extents.max[axis];
    if (!limits.programmable()) {
      if (low == high) continue;
      return fail(ErrorCode::axis_not_connected,
                  fmt::format("The move needs axis {}, which is not connected.", axis_name(axis)));
    }
    if (low < limits.negative_limit - kTolerance || high > limits.positive_limit + kTolerance) {
      const bool below = low < limits.negative_limit - kTolerance;
      return fail(ErrorCode::travel_limit,
                  fmt::format("The move takes {} to {:.3f} in machine coordinates; its travel is "
                              "{:.3f} to {:.3f}.",
                              axis_name(axis), below ? low : high, limits.negative_limit,
                              limits.positive_limit));
    }
  }
  return {};
}

double tolerance_within_travel(const config::MachineConfig& config, const motion::Extents& extents,
                               double tolerance) {
  double room = tolerance;
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& limits = config.axes[axis];
    // A slave goes where its master does; a rotary axis that rests is not part of the curve.
    const bool rests = is_rotary(axis) && extents.min[axis] == extents.max[axis];
    if (!limits.programmable() || rests) continue;
    room = std::min({room, extents.min[axis] - limits.negative_limit,
                     limits.positive_limit - extents.max[axis]});
  }
  return std::max(room, std::min(tolerance, kTolerance));
}

}  // namespace cnc::server
