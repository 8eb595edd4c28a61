#include "hal/sim/virtual_spindle.h"

#include <algorithm>
#include <cmath>

namespace cnc::hal::sim {
namespace {

constexpr cpu5::firmware::Ticks kStep = cpu5::firmware::kTicksPerSecond / 10'000;
constexpr double kStandstill = 0.1;  // rpm below which friction wins

}  // namespace

VirtualSpindle::VirtualSpindle(const SpindleOptions& options)
    : options_(options),
      clock_(kStep),
      gain_(1.0 - std::exp(-clock_.step_seconds() / options.time_constant)),
      highest_change_(options.acceleration * clock_.step_seconds()) {}

void VirtualSpindle::advance(Ticks now) {
  if (target_ == 0.0 && speed_ == 0.0) return clock_.skip_to(now);
  while (clock_.take_step(now)) turn();
}

bool VirtualSpindle::sync_input() const {
  return !index_missing_ && angle_ - std::floor(angle_) < options_.sync_width;
}

// Within a step the speed is its mean, so the pulse's moment follows from the part of the way. A
// pulse comes where a whole revolution is reached or passed.
void VirtualSpindle::turn() {
  const double before = speed_;
  speed_ += std::clamp((target_ - speed_) * gain_, -highest_change_, highest_change_);
  if (target_ == 0.0 && std::abs(speed_) < kStandstill) speed_ = 0.0;
  const double way = (before + speed_) / 2 / 60.0 * clock_.step_seconds();
  const double from = angle_;
  angle_ += way;
  const double passed = std::abs(std::floor(angle_) - std::floor(from));
  if (passed == 0.0 || index_missing_) return;
  const double last = way > 0.0 ? std::floor(angle_) : std::floor(angle_) + 1.0;
  pulses_ += static_cast<std::uint32_t>(passed);
  last_pulse_ = clock_.time() - clock_.step() +
                std::llround((last - from) / way * static_cast<double>(clock_.step()));
}

}  // namespace cnc::hal::sim
