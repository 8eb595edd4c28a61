#include "server/simulation/simulation.h"

#include <utility>

#include "server/link/link_trace.h"

namespace cnc::server {
namespace {

/// For a scenario whose cable is out, s.
constexpr double kLinkPatience = 10.0;

std::unique_ptr<hal::sim::VirtualController> connected_controller(
    const config::MachineConfig& config, const SimulationOptions& options) {
  auto controller =
      hal::sim::make_virtual_controller(config, {.machine = options.machine,
                                                 .driver = hal::cpu5::driver_settings(config),
                                                 .link = options.link,
                                                 .events = options.events});
  // In-process it fails with the cable out only, and then the link goes on trying.
  static_cast<void>(controller->connect());
  return controller;
}

std::unique_ptr<hal::Controller> traced(std::unique_ptr<hal::Controller> controller,
                                        hal::trace::Ring* trace) {
  if (trace == nullptr) return controller;
  return std::make_unique<hal::trace::TracedController>(std::move(controller), *trace);
}

}  // namespace

Simulation::Simulation(MachineData data, const SimulationOptions& options)
    : period_(options.period),
      trace_(options.trace),
      controller_(connected_controller(data.config, options)),
      virtual_controller_(*controller_),
      virtual_machine_(controller_->machine()),
      link_(traced(std::move(controller_), trace_)),
      machine_(std::move(data), link_, log_) {}

void Simulation::cycle() {
  link_.cycle(now_);
  machine_.cycle(now_);
  if (trace_ != nullptr) note_state(*trace_, machine_);
  now_ += period_;
}

void Simulation::starve_machine(double seconds) {
  for (const double end = now_ + seconds; now_ < end; now_ += period_) link_.cycle(now_);
}

bool Simulation::cycle_until(State state) {
  const double give_up = now_ + kLinkPatience;
  while (machine_.state() != state) {
    if (machine_.state() == State::error || machine_.state() == State::estop) return false;
    if (machine_.state() == State::off && now_ > give_up) return false;
    cycle();
  }
  return true;
}

}  // namespace cnc::server
