#include "hal/sim/virtual_machine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cnc::hal::sim {

VirtualMachine::VirtualMachine(const config::MachineConfig& config, const MachineOptions& options) {
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

void VirtualMachine::step(std::size_t axis, int direction) {
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

cpu5::firmware::Inputs VirtualMachine::inputs() {
  cpu5::firmware::Inputs result{.estop = estop_};
  for (const Axis axis : kAllAxes) {
    if (motors_[axis].switch_on) result.home |= cpu5::firmware::axis_bit(index_of(axis));
  }
  return result;
}

}  // namespace cnc::hal::sim
