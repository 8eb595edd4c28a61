#include "hal/cpu5/firmware/pulse_shaper.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr Ticks later(Ticks a, Ticks b) { return a > b ? a : b; }

}  // namespace

bool pulses_possible(const Setup& setup) {
  const Ticks period = 2 * Ticks{setup.pulse_width};  // the pause is as long as the pulse
  return setup.pulse_width > 0 && period <= kOneStep / setup.max_velocity &&
         setup.direction_setup <= kMaxDirectionTicks && setup.direction_hold <= kMaxDirectionTicks;
}

void PulseShaper::set_up(const Setup& setup) { setup_ = setup; }

bool PulseShaper::add_step(std::size_t axis, int direction, Ticks when) {
  return axes_[axis].add({.due = when + setup_.direction_setup, .upwards = direction > 0});
}

PulseShaper::Pins PulseShaper::make_edges(Ticks now) {
  Pins pins{.step = setup_.step_inverted, .direction = setup_.direction_inverted};
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    Axis& axis = axes_[i];
    if (axis.next_edge(setup_) <= now) axis.make_edge(now);
    if (axis.high) pins.step ^= axis_bit(i);
    if (axis.upwards) pins.direction ^= axis_bit(i);
  }
  return pins;
}

Ticks PulseShaper::next_edge() const {
  Ticks next = kNever;
  for (const Axis& axis : axes_) {
    const Ticks edge = axis.next_edge(setup_);
    if (edge < next) next = edge;
  }
  return next;
}

bool PulseShaper::Axis::add(const Step& step) {
  if (added_ - taken_ == kWaiting) return false;
  steps_[added_++ % kWaiting] = step;
  return true;
}

Ticks PulseShaper::Axis::next_edge(const Setup& setup) const {
  if (high) return rise_ + setup.pulse_width;
  if (added_ == taken_) return kNever;
  const Ticks due = next().due;
  if (has_to_turn()) return later(due - setup.direction_setup, rise_ + setup.direction_hold);
  return later(due, later(fall_ + setup.pulse_width, turn_ + setup.direction_setup));
}

void PulseShaper::Axis::make_edge(Ticks now) {
  if (high) {
    high = false;
    fall_ = now;
  } else if (has_to_turn()) {
    upwards = !upwards;
    turn_ = now;
  } else {
    high = true;
    rise_ = now;
    ++taken_;
  }
}

}  // namespace cnc::hal::cpu5::firmware
