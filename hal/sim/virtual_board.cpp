#include "hal/sim/virtual_board.h"

#include <algorithm>
#include <cmath>

namespace cnc::hal::sim {

using cpu5::firmware::Ticks;

VirtualBoard::VirtualBoard(const config::MachineConfig& config, const MachineOptions& options)
    : machine_(config, options) {
  start();
}

void VirtualBoard::start() {
  core_.emplace(machine_);
  link_.emplace(
      *core_, cpu5::firmware::BoardName{.serial = 1, .boot = ++boots_, .name = {"virtual board"}});
}

// The machine's physics go on with the time that they have, so the new core's begins there too.
void VirtualBoard::reset() {
  start();
  core_->advance(time_);
}

// From the distance to power-up, not from call to call: rounding to ticks cannot add up.
void VirtualBoard::advance_to(double now) {
  if (!power_up_) power_up_ = now;
  now_ = now;
  const Ticks time = std::llround((now - *power_up_) * double{cpu5::firmware::kTicksPerSecond});
  core_->advance(std::max<Ticks>(time - time_, 0));
  time_ = std::max(time, time_);
}

std::span<const std::uint8_t> VirtualBoard::answer(std::span<const std::uint8_t> packet) {
  return link_->answer(packet, memory_);
}

}  // namespace cnc::hal::sim
