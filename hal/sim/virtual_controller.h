// A Controller with a complete virtual machine behind it, in this process.
//
// cncserver gives it the steady clock, cncsim and the tests a virtual one; nothing in it reads a
// clock, sleeps or runs a thread.
#pragma once

#include <memory>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/sim/virtual_machine.h"

namespace cnc::hal::sim {

struct SimOptions {
  MachineOptions machine{};
  cpu5::DriverSettings driver{};
};

class VirtualController final : public cpu5::Cpu5Driver {
 public:
  [[nodiscard]] VirtualMachine& machine() { return machine_; }

 private:
  friend std::unique_ptr<VirtualController> make_virtual_controller(const config::MachineConfig&,
                                                                    const SimOptions&);
  VirtualController(const config::MachineConfig& config, const cpu5::DriverSettings& settings,
                    std::unique_ptr<cpu5::BoardPort> board, VirtualMachine& machine)
      : Cpu5Driver(config, settings, std::move(board)), machine_(machine) {}

  VirtualMachine& machine_;  // part of the board that the driver owns
};

/// Allocates; nothing after it does.
[[nodiscard]] std::unique_ptr<VirtualController> make_virtual_controller(
    const config::MachineConfig& config, const SimOptions& options = {});

}  // namespace cnc::hal::sim
