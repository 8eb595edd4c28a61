#include "hal/sim/virtual_controller.h"

#include "hal/sim/virtual_board.h"

namespace cnc::hal::sim {

std::unique_ptr<VirtualController> make_virtual_controller(const config::MachineConfig& config,
                                                           const SimOptions& options) {
  auto board = std::make_unique<VirtualBoard>(config, options.machine);
  VirtualMachine& machine = board->machine();
  return std::unique_ptr<VirtualController>(
      new VirtualController(config, options.driver, std::move(board), machine));
}

}  // namespace cnc::hal::sim
