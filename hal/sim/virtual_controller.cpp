#include "hal/sim/virtual_controller.h"

namespace cnc::hal::sim {

std::unique_ptr<VirtualController> make_virtual_controller(const config::MachineConfig& config,
                                                           const SimOptions& options) {
  auto channel = std::make_unique<VirtualChannel>(
      config, Scenario{.machine = options.machine, .link = options.link, .events = options.events});
  VirtualChannel& end = *channel;
  auto port = std::make_unique<cpu5::WirePort>(std::move(channel), options.wire);
  return std::unique_ptr<VirtualController>(
      new VirtualController(config, options.driver, std::move(port), end));
}

}  // namespace cnc::hal::sim
