#include "hal/sim/virtual_board.h"

#include <algorithm>
#include <cmath>

namespace cnc::hal::sim {

using cpu5::firmware::Ticks;

Result<cpu5::firmware::Status> VirtualBoard::open(const cpu5::firmware::Setup& setup) {
  if (core_.set_up(setup)) return core_.status();
  return fail(ErrorCode::board_setup_refused,
              "The virtual board refused its setup: it is moving, or the maximum step frequency or "
              "the time-out is out of range.");
}

bool VirtualBoard::exchange(double now, const cpu5::firmware::HostFrame& frame,
                            cpu5::firmware::Status& status) {
  advance_to(now);
  cpu5::firmware::execute(frame, core_);
  status = core_.status();
  return true;
}

// From the distance to power-up, not from exchange to exchange: rounding to ticks cannot add up.
void VirtualBoard::advance_to(double now) {
  if (!power_up_) power_up_ = now;
  const Ticks time = std::llround((now - *power_up_) * double{cpu5::firmware::kTicksPerSecond});
  core_.advance(std::max<Ticks>(time - time_, 0));
  time_ = std::max(time, time_);
}

}  // namespace cnc::hal::sim
