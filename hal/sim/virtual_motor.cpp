#include "hal/sim/virtual_motor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cnc::hal::sim {
namespace {

// What a motor has above what its axis is configured to use.
constexpr double kMargin = 1.5;
constexpr double kTopVelocity = 2.0;

constexpr double kSecond{cpu5::firmware::kTicksPerSecond};

// A slave makes its master's motion too.
MotorCurve curve_in_steps(const config::MachineConfig& config, Axis axis,
                          const MotorOptions& options) {
  const config::AxisConfig& own = config.axes[axis];
  const config::AxisConfig& moved = config.axes[config.moved_by(axis)];
  const double steps = std::abs(own.steps_per_unit);
  const double velocity = std::max(own.velocity, moved.velocity);
  const double acceleration = std::max(own.acceleration, moved.acceleration);
  const double corner = options.corner_velocity.value_or(kMargin * velocity);
  const double top = options.top_velocity.value_or(std::max(corner, kTopVelocity * velocity));
  return {.acceleration = steps * options.acceleration.value_or(kMargin * acceleration),
          .corner_velocity = steps * std::min(corner, top),
          .top_velocity = steps * top};
}

}  // namespace

VirtualMotor::VirtualMotor(const config::MachineConfig& config, Axis axis,
                           const MachineOptions& options)
    : sense_(config.axes[axis].steps_per_unit < 0.0 ? -1 : 1),
      connected_(config.axes[axis].connected()),
      closed_loop_(options.axes[axis].motor.closed_loop),
      steps_per_unit_(std::abs(config.axes[axis].steps_per_unit)),
      home_position_(config.axes[axis].home_position),
      rotor_(curve_in_steps(config, axis, options.axes[axis].motor),
             options.axes[axis].motor.microsteps) {
  if (connected_) window_ = std::llround(rotor_.window() * kSecond);
  place_stops_and_switches(config.axes[axis], options);
  const double middle = (static_cast<double>(low_stop_) + static_cast<double>(high_stop_)) / 2;
  place_ = options.start ? place_of((*options.start)[axis]) : std::llround(middle);
  place_ = std::clamp(place_, low_stop_, high_stop_);
  followed_place_ = place_;
  update_switches();
}

std::int64_t VirtualMotor::place_of(double position) const {
  return std::llround((position - home_position_) * steps_per_unit_);
}

void VirtualMotor::place_stops_and_switches(const config::AxisConfig& axis,
                                            const MachineOptions& options) {
  const auto hysteresis =
      std::max<std::int64_t>(1, std::llround(options.switch_hysteresis * steps_per_unit_));
  const auto make_switch = [hysteresis](int side, std::int64_t on_at) {
    return TravelSwitch{.side = side, .on_at = on_at, .off_at = on_at - side * hysteresis};
  };
  const int home_side = (axis.home_velocity > 0.0) - (axis.home_velocity < 0.0);
  switches_[0] = make_switch(home_side, home_side * hysteresis);
  if (!(axis.negative_limit < axis.positive_limit)) return;
  const double low = std::min(axis.home_position, axis.negative_limit);
  const double high = std::max(axis.home_position, axis.positive_limit);
  low_stop_ = place_of(low - options.stop_margin);
  high_stop_ = place_of(high + options.stop_margin);
  switches_[1] = make_switch(-1, place_of(low - options.limit_switch_margin));
  switches_[2] = make_switch(1, place_of(high + options.limit_switch_margin));
}

// --- steps and time ------------------------------------------------------------------------------

void VirtualMotor::step_with_care(std::int64_t place) {
  if (!connected_) return;
  if (place < low_stop_ || place > high_stop_) {
    rotor_.stop();
    followed_place_ = place_;
    return lose(1);
  }
  if (!drive_on_ || !rotor_.in_step()) return lose(1);
  move_to(place);
}

// The steps since the last call are taken to be spread evenly over the time since then, at least a
// window: single steps at low speed do not look like jerks.
void VirtualMotor::follow(Ticks now) {
  const double seconds = static_cast<double>(now - std::exchange(followed_until_, now)) / kSecond;
  const auto moved = static_cast<double>(place_ - std::exchange(followed_place_, place_));
  const auto missed = static_cast<double>(lost_ - std::exchange(followed_lost_, lost_));
  if (rotor_.in_step()) {
    if (rotor_.at_rest() && moved == 0.0) return;
    rotor_.follow(moved, seconds);
    if (rotor_.in_step()) return;
    part(-rotor_.release());
  } else {
    part(rotor_.coast(seconds));
    if (drive_on_) rotor_.engage(missed / seconds);
  }
  update_switches();
}

// The rotor goes where no pulse puts it.
void VirtualMotor::part(double steps) {
  coasted_ += steps;
  const auto whole = static_cast<std::int64_t>(coasted_);
  if (whole == 0) return;
  coasted_ -= static_cast<double>(whole);
  lose_steps(whole);
}

void VirtualMotor::set_drive(bool on) {
  if (on == drive_on_) return;
  drive_on_ = on;
  if (on) {
    rotor_.engage(0.0);
  } else {
    set_signal(kAlarm, false);
    part(-rotor_.release());
  }
  update_switches();
}

void VirtualMotor::lose_steps(std::int64_t steps) {
  const std::int64_t place = std::clamp(place_ + steps, low_stop_, high_stop_);
  if (place != place_ + steps) rotor_.stop();
  const auto lost = static_cast<std::uint64_t>(std::abs(place - place_));
  lose(lost);
  followed_lost_ += lost;
  followed_place_ += place - place_;
  move_to(place);
}

void VirtualMotor::lose(std::uint64_t steps) {
  lost_ += steps;
  if (closed_loop_ && drive_on_ && steps > 0) set_signal(kAlarm, true);
}

// --- switches ------------------------------------------------------------------------------------

bool VirtualMotor::TravelSwitch::is_on(std::int64_t place, bool was_on) const {
  return side * (place - (was_on ? off_at : on_at)) >= (was_on ? 1 : 0);
}

void VirtualMotor::move_to(std::int64_t place) {
  place_ = place;
  update_switches();
}

// The quiet way ends where the next switch changes or a stop is, and there is none without torque.
void VirtualMotor::update_switches() {
  quiet_low_ = low_stop_ - 1;
  quiet_high_ = high_stop_ + 1;
  for (const Switch which : {Switch::home, Switch::limit_low, Switch::limit_high}) {
    const TravelSwitch& travel_switch = switches_[static_cast<std::size_t>(which)];
    if (travel_switch.side == 0) continue;
    const bool on = travel_switch.is_on(place_, switch_on(which));
    set_signal(signal_of(which), on);
    const std::int64_t change = on ? travel_switch.off_at : travel_switch.on_at;
    std::int64_t& end = change > place_ ? quiet_high_ : quiet_low_;
    end = change > place_ ? std::min(end, change) : std::max(end, change);
  }
  if (!connected_ || !drive_on_ || !rotor_.in_step()) quiet_low_ = quiet_high_ = place_;
}

}  // namespace cnc::hal::sim
