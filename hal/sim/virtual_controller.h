// A Controller with a complete virtual machine behind it, in this process.
//
// cncserver gives it the steady clock, cncsim and the tests a virtual one; nothing in it reads a
// clock, sleeps or runs a thread.
#pragma once

#include <memory>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/wire_port.h"
#include "hal/sim/virtual_channel.h"

namespace cnc::hal::sim {

struct SimOptions {
  MachineOptions machine{};
  cpu5::DriverSettings driver{};
  cpu5::WireSettings wire{};
  LinkTrouble link{};  ///< from power-up on
  std::vector<ScenarioEvent> events{};
};

class VirtualController final : public cpu5::Cpu5Driver {
 public:
  [[nodiscard]] VirtualMachine& machine() { return channel_.board().machine(); }
  [[nodiscard]] VirtualBoard& board() { return channel_.board(); }
  /// Of the cable between driver and board.
  [[nodiscard]] LinkTrouble& trouble() { return channel_.trouble(); }

 private:
  friend std::unique_ptr<VirtualController> make_virtual_controller(const config::MachineConfig&,
                                                                    const SimOptions&);
  VirtualController(const config::MachineConfig& config, const cpu5::DriverSettings& settings,
                    std::unique_ptr<cpu5::BoardPort> port, VirtualChannel& channel)
      : Cpu5Driver(config, settings, std::move(port)), channel_(channel) {}

  VirtualChannel& channel_;  // the driver's port owns it
};

/// Allocates; nothing after it does.
[[nodiscard]] std::unique_ptr<VirtualController> make_virtual_controller(
    const config::MachineConfig& config, const SimOptions& options = {});

}  // namespace cnc::hal::sim
