#include "hal/cpu5/firmware/pulse_shaper.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr Ticks earlier(Ticks a, Ticks b) { return a < b ? a : b; }
constexpr Ticks later(Ticks a, Ticks b) { return a > b ? a : b; }

}  // namespace

bool pulses_possible(const Setup& setup) {
  const Ticks period = 2 * Ticks{setup.pulse_width};  // the pause is as long as the pulse
  return setup.pulse_width > 0 && period <= kOneStep / setup.max_velocity &&
         setup.direction_setup <= kMaxDirectionTicks && setup.direction_hold <= kMaxDirectionTicks;
}

void PulseShaper::set_up(const Setup& setup) {
  setup_ = setup;
  pins_ = {.step = setup.step_inverted, .direction = setup.direction_inverted};
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    if (axes_[i].high) pins_.step ^= axis_bit(i);
    if (axes_[i].upwards) pins_.direction ^= axis_bit(i);
  }
}

bool PulseShaper::add_step(std::size_t axis, int direction, Ticks when) {
  const Step step{.due = when + setup_.direction_setup, .upwards = direction > 0};
  const bool added = axes_[axis].add(step, setup_);
  next_edge_ = earlier(next_edge_, axes_[axis].edge);
  return added;
}

PulseShaper::Pins PulseShaper::make_edges(Ticks now) {
  if (now < next_edge_) return pins_;
  next_edge_ = kNever;
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    Axis& axis = axes_[i];
    if (axis.edge <= now) {
      const bool turns = axis.make_edge(now, setup_);
      (turns ? pins_.direction : pins_.step) ^= axis_bit(i);
    }
    next_edge_ = earlier(next_edge_, axis.edge);
  }
  return pins_;
}

bool PulseShaper::Axis::add(const Step& step, const Setup& setup) {
  if (added_ - taken_ == kWaiting) return false;
  steps_[added_++ % kWaiting] = step;
  if (edge == kNever) find_edge(setup);
  return true;
}

bool PulseShaper::Axis::make_edge(Ticks now, const Setup& setup) {
  const bool turns = !high && has_to_turn();
  if (high) {
    high = false;
    fall_ = now;
  } else if (turns) {
    upwards = !upwards;
    turn_ = now;
  } else {
    high = true;
    rise_ = now;
    ++taken_;
  }
  find_edge(setup);
  return turns;
}

void PulseShaper::Axis::find_edge(const Setup& setup) {
  if (high) {
    edge = rise_ + setup.pulse_width;
  } else if (added_ == taken_) {
    edge = kNever;
  } else if (has_to_turn()) {
    edge = later(next().due - setup.direction_setup, rise_ + setup.direction_hold);
  } else {
    edge = later(next().due, later(fall_ + setup.pulse_width, turn_ + setup.direction_setup));
  }
}

}  // namespace cnc::hal::cpu5::firmware
