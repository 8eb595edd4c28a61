#include "hal/sim/virtual_machine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cnc::hal::sim {

using cpu5::firmware::Ticks;

VirtualMachine::VirtualMachine(const config::MachineConfig& config, const MachineOptions& options)
    : spindle_(options.spindle),
      full_speed_(config.spindle.max_speed),
      heaters_(options.heaters.begin(), options.heaters.end()),
      surface_(options.touch),
      tool_lengths_(options.touch.tool_lengths) {
  if (options.loop_back_delay) {
    constexpr double kSecond{cpu5::firmware::kTicksPerSecond};
    loop_back_.emplace(std::llround(*options.loop_back_delay * kSecond));
  }
  for (const Axis axis : kAllAxes) {
    const std::optional<double> start =
        options.start ? std::optional((*options.start)[axis]) : std::nullopt;
    motors_[axis] = make_motor(config.axes[axis], start, options);
  }
}

VirtualMachine::Motor VirtualMachine::make_motor(const config::AxisConfig& axis,
                                                 std::optional<double> start,
                                                 const MachineOptions& options) {
  Motor motor{.connected = axis.connected(),
              .sense = axis.steps_per_unit < 0.0 ? -1 : 1,
              .steps_per_unit = std::abs(axis.steps_per_unit),
              .home_position = axis.home_position,
              .low_stop = std::numeric_limits<std::int64_t>::min(),
              .high_stop = std::numeric_limits<std::int64_t>::max()};
  const auto place_of = [&motor](double position) {
    return static_cast<std::int64_t>(
        std::llround((position - motor.home_position) * motor.steps_per_unit));
  };
  double low = axis.home_position;
  double high = axis.home_position;
  if (axis.negative_limit < axis.positive_limit) {
    low = std::min(low, axis.negative_limit);
    high = std::max(high, axis.positive_limit);
    motor.low_stop = place_of(low - options.stop_margin);
    motor.high_stop = place_of(high + options.stop_margin);
  }
  motor.place =
      std::clamp(place_of(start.value_or((low + high) / 2)), motor.low_stop, motor.high_stop);
  motor.switch_side = (axis.home_velocity > 0.0) - (axis.home_velocity < 0.0);
  motor.hysteresis =
      std::max<std::int64_t>(1, std::llround(options.switch_hysteresis * motor.steps_per_unit));
  motor.update_switch();
  return motor;
}

double VirtualMachine::physical_position(Axis axis) const {
  const Motor& motor = motors_[axis];
  return motor.home_position + static_cast<double>(motor.place) / motor.steps_per_unit;
}

Position VirtualMachine::physical_position() const {
  Position position;
  for (const Axis axis : kAllAxes) position[axis] = physical_position(axis);
  return position;
}

void VirtualMachine::step(std::size_t axis, int direction, Ticks) {
  Motor& motor = motors_.values[axis];
  if (!motor.connected) return;
  const std::int64_t place = motor.place + direction * motor.sense;
  const bool blocked = place < motor.low_stop || place > motor.high_stop;
  if (blocked || !outputs_.drives_enabled) {
    ++motor.lost;
    return;
  }
  motor.place = place;
  motor.update_switch();
}

void VirtualMachine::Motor::update_switch() {
  const std::int64_t beyond_home = switch_side * place;
  if (switch_side != 0 && beyond_home >= hysteresis) switch_on = true;
  if (beyond_home <= 0) switch_on = false;
}

// --- hands and wiring ----------------------------------------------------------------------------

void VirtualMachine::set_port_input(std::size_t port, bool active) {
  const auto bit = cpu5::firmware::PortBits{1} << port;
  wired_.ports = active ? wired_.ports | bit : wired_.ports & ~bit;
}

void VirtualMachine::set_analog_input(std::size_t input, double part) {
  const double value = std::clamp(part, 0.0, 1.0) * cpu5::firmware::Inputs::kFullAnalog;
  wired_.analog.at(input) = static_cast<std::uint32_t>(std::lround(value));
}

// Two tracks a quarter step apart, A ahead: the Gray code of the quarter.
void VirtualMachine::turn_hand_wheel(std::int32_t counts) {
  const auto count =
      static_cast<std::uint32_t>(wired_.hand_wheel_count) + static_cast<std::uint32_t>(counts);
  const std::uint32_t quarter = count % 4;
  const std::uint32_t gray = quarter ^ (quarter >> 1U);
  wired_.hand_wheel_count = static_cast<std::int32_t>(count);
  wired_.hand_wheel_a = (gray & 1U) != 0;
  wired_.hand_wheel_b = (gray & 2U) != 0;
}

void VirtualMachine::load_tool(int number) {
  const auto found = tool_lengths_.find(number);
  tool_length_ = found == tool_lengths_.end() ? 0.0 : found->second;
}

// --- pins ----------------------------------------------------------------------------------------

void VirtualMachine::set_outputs(const cpu5::firmware::Outputs& outputs) {
  outputs_ = outputs;
  if (loop_back_) loop_back_->set_outputs(outputs.ports, now_);
  const double speed = full_speed_ * outputs.spindle_pwm / cpu5::firmware::Outputs::kFullPwm;
  spindle_.set_target(outputs.tool_direction ? speed : -speed);
}

cpu5::firmware::Inputs VirtualMachine::inputs(Ticks now) {
  pass_time(now);
  cpu5::firmware::Inputs result = wired_;
  read_sensors(result);
  return result;
}

void VirtualMachine::pass_time(Ticks now) {
  now_ = now;
  spindle_.advance(now);
  for (VirtualHeater& heater : heaters_) {
    const auto pwm = static_cast<double>(outputs_.pwm.at(heater.options().pwm));
    heater.advance(now, pwm / cpu5::firmware::Outputs::kFullPwm);
  }
}

void VirtualMachine::read_sensors(cpu5::firmware::Inputs& inputs) {
  for (const Axis axis : kAllAxes) {
    if (motors_[axis].switch_on) inputs.home |= cpu5::firmware::axis_bit(index_of(axis));
  }
  inputs.probe = probe_touches();
  inputs.sync = spindle_.sync_input();
  inputs.index_count = spindle_.pulses();
  inputs.index_time = spindle_.last_pulse();
  if (loop_back_) inputs.ports |= loop_back_->inputs(now_);
  for (const VirtualHeater& heater : heaters_) {
    const double part = std::clamp(heater.sensor(), 0.0, 1.0);
    inputs.analog.at(heater.options().analog) =
        static_cast<std::uint32_t>(std::lround(part * cpu5::firmware::Inputs::kFullAnalog));
  }
}

// The tip is where a number of whole steps put it; the rounding of that sum must not decide.
bool VirtualMachine::probe_touches() const {
  constexpr double kRounding = 1e-9;
  if (!surface_.exists()) return false;
  const double tip = physical_position(Axis::Z) - tool_length_;
  const double height = surface_.height(physical_position(Axis::X), physical_position(Axis::Y));
  return tip <= height + kRounding;
}

}  // namespace cnc::hal::sim
