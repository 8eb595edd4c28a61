// What stands on the table of the simulated machine, so that there is something to probe: a stock
// in the middle and a tool setter in the far corner.
#pragma once

#include "config/machine_config.h"
#include "hal/sim/scenario.h"

namespace cnc::server {

/// Stock: the middle third of the travel of X and Y, its top at 40 % of the travel of Z. Tool
/// setter: at 90 % of X and Y, its top at 30 % of Z. Nothing where one of these axes has no travel.
[[nodiscard]] inline hal::sim::TouchOptions virtual_bench(const config::MachineConfig& config) {
  const auto part_of = [&](Axis axis, double part) {
    const config::AxisConfig& travel = config.axes[axis];
    return travel.negative_limit + part * (travel.positive_limit - travel.negative_limit);
  };
  for (const Axis axis : kLinearAxes) {
    const config::AxisConfig& travel = config.axes[axis];
    if (!travel.connected() || travel.negative_limit >= travel.positive_limit) return {};
  }
  constexpr double kThird = 1.0 / 3.0;
  const double left = part_of(Axis::X, kThird);
  const double right = part_of(Axis::X, 2.0 * kThird);
  const double front = part_of(Axis::Y, kThird);
  const double back = part_of(Axis::Y, 2.0 * kThird);
  const double top = part_of(Axis::Z, 0.4);
  const double table = part_of(Axis::Z, -1.0);  // out of reach
  hal::sim::TouchOptions touch;
  touch.stock = [=](double x, double y) {
    return x >= left && x <= right && y >= front && y <= back ? top : table;
  };
  touch.tool_setter = hal::sim::ToolSetter{.x = part_of(Axis::X, 0.9),
                                           .y = part_of(Axis::Y, 0.9),
                                           .half_width = 10.0,
                                           .top = part_of(Axis::Z, 0.3)};
  return touch;
}

/// The scenario of a file; without one a sound machine with that on its table.
[[nodiscard]] inline Result<hal::sim::Scenario> scenario_of(const std::filesystem::path& file,
                                                            const config::MachineConfig& config) {
  if (!file.empty()) return hal::sim::load_scenario(file);
  return hal::sim::Scenario{.machine = {.touch = virtual_bench(config)}};
}

}  // namespace cnc::server
