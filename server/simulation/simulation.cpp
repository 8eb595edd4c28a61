#include "server/simulation/simulation.h"

#include <utility>

namespace cnc::server {
namespace {

std::unique_ptr<hal::sim::VirtualController> connected_controller(
    const config::MachineConfig& config, const hal::sim::MachineOptions& options) {
  auto controller = hal::sim::make_virtual_controller(config, {.machine = options});
  // In-process: connecting cannot fail.
  static_cast<void>(controller->connect());
  return controller;
}

}  // namespace

Simulation::Simulation(MachineData data, const SimulationOptions& options)
    : period_(options.period),
      controller_(connected_controller(data.config, options.machine)),
      virtual_machine_(controller_->machine()),
      link_(std::move(controller_)),
      machine_(std::move(data), link_, log_) {}

void Simulation::cycle() {
  link_.cycle(now_);
  machine_.cycle(now_);
  now_ += period_;
}

bool Simulation::cycle_until(State state) {
  while (machine_.state() != state) {
    if (machine_.state() == State::error || machine_.state() == State::estop) return false;
    cycle();
  }
  return true;
}

}  // namespace cnc::server
