#include "server/job/travel_limits.h"

#include <fmt/format.h>

namespace cnc::server {
namespace {

/// Programs reach a limit exactly by way of sums and offsets; a tenth of a micrometre is rounding.
constexpr double kTolerance = 1e-4;

}  // namespace

Result<void> check_travel(const config::MachineConfig& config, const motion::Extents& extents) {
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& limits = config.axes[axis];
    const double low = extents.min[axis];
    const double high = extents.max[axis];
    if (!limits.connected()) {
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

}  // namespace cnc::server
