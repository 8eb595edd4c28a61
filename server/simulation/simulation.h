// Machine, link and virtual board in one thread under a virtual clock: what cncsim and the tests
// run. The parts are those of cncserver; only the threads and the clock are missing.
#pragma once

#include <memory>

#include "hal/sim/virtual_controller.h"
#include "hal/trace/traced_controller.h"
#include "server/machine/machine.h"

namespace cnc::server {

struct SimulationOptions {
  hal::sim::MachineOptions machine{};
  hal::sim::LinkTrouble link{};  ///< from power-up on
  std::vector<hal::sim::ScenarioEvent> events{};
  /// Virtual time between two cycles, s. Everything that has to be exact happens on the board's
  /// clock; this only has to be well below FifoTime.
  double period = 0.005;
  /// What passes between link and board is recorded here; it outlives the simulation.
  hal::trace::Ring* trace = nullptr;
};

class Simulation {
 public:
  explicit Simulation(MachineData data, const SimulationOptions& options = {});

  [[nodiscard]] Machine& machine() { return machine_; }
  [[nodiscard]] Link& link() { return link_; }
  [[nodiscard]] hal::sim::VirtualMachine& virtual_machine() { return virtual_machine_; }
  /// For its cable and its power.
  [[nodiscard]] hal::sim::VirtualController& virtual_controller() { return virtual_controller_; }
  [[nodiscard]] const MessageLog& log() const { return log_; }
  /// Of the next cycle, s.
  [[nodiscard]] double time() const { return now_; }

  /// The link's cycle, then the machine's.
  void cycle();
  /// The link's cycles only, for so long: a computer that is too busy for the machine.
  void starve_machine(double seconds);
  /// Cycles until `state` is reached; false when the machine stops in a fault before, or the board
  /// stays silent.
  bool cycle_until(State state);

 private:
  const double period_;
  hal::trace::Ring* const trace_;
  MessageLog log_;
  std::unique_ptr<hal::sim::VirtualController> controller_;  // until the link takes it
  hal::sim::VirtualController& virtual_controller_;
  hal::sim::VirtualMachine& virtual_machine_;
  Link link_;
  Machine machine_;
  double now_ = 0.0;
};

}  // namespace cnc::server
