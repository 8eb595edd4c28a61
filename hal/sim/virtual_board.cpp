#include "hal/sim/virtual_board.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace cnc::hal::sim {

using cpu5::firmware::Ticks;

VirtualBoard::VirtualBoard(const config::MachineConfig& config, const Scenario& scenario)
    : machine_(config, scenario.machine),
      player_(scenario.events),
      trouble_(scenario.link),
      boot_(std::random_device{}()) {
  start();
}

void VirtualBoard::start() {
  core_.emplace(machine_);
  link_.emplace(*core_,
                cpu5::firmware::BoardName{.serial = 1, .boot = ++boot_, .name = {"virtual board"}});
}

void VirtualBoard::reset() {
  machine_.restart_board();
  start();
}

// From the distance to power-up, not from call to call: rounding to ticks cannot add up.
void VirtualBoard::advance_to(double now) {
  if (!power_up_) power_up_ = now;
  now_ = now;
  const Ticks time = std::llround((now - *power_up_) * double{cpu5::firmware::kTicksPerSecond});
  while (player_.next() <= time) play_events();
  advance_core_to(time);
}

void VirtualBoard::advance_core_to(Ticks time) {
  core_->advance(std::max<Ticks>(time - time_, 0));
  time_ = std::max(time, time_);
}

void VirtualBoard::play_events() {
  advance_core_to(player_.next());
  Stage stage{machine_, trouble_};
  player_.advance(time_, stage);
  if (stage.reset_board) reset();
}

std::span<const std::uint8_t> VirtualBoard::answer(std::span<const std::uint8_t> packet) {
  return link_->answer(packet, memory_);
}

}  // namespace cnc::hal::sim
