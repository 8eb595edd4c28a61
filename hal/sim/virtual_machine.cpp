#include "hal/sim/virtual_machine.h"

#include <algorithm>
#include <cmath>

namespace cnc::hal::sim {

using cpu5::firmware::axis_bit;
using cpu5::firmware::Inputs;
using cpu5::firmware::PortBits;

namespace {

cpu5::firmware::Ticks ticks_of(double seconds) {
  return std::llround(seconds * double{cpu5::firmware::kTicksPerSecond});
}

PortBits bit_of(std::optional<std::size_t> port) {
  return port ? PortBits{1} << *port : PortBits{0};
}

PortBits ports_of(const std::array<bool, kCardCount>& io_cards) {
  PortBits ports = (PortBits{1} << kAuxCount) - 1;
  constexpr PortBits kCard = (PortBits{1} << kCardPorts) - 1;
  for (std::size_t card = 0; card < kCardCount; ++card) {
    if (io_cards[card]) ports |= kCard << (kAuxCount + card * kCardPorts);
  }
  return ports;
}

// Numbers for the seeds of contacts that are no axis's.
constexpr std::uint64_t kProbeContact = 1000;
constexpr std::uint64_t kDoorContact = 1001;

Contact make_contact(const MachineOptions& options, std::uint64_t number) {
  return {ticks_of(options.switch_bounce), options.seed * 4096 + number};
}

}  // namespace

VirtualMachine::VirtualMachine(const config::MachineConfig& config, const MachineOptions& options)
    : motors_(make_motors(config, options)),
      wiring_(make_wiring(options)),
      spindle_(options.spindle),
      full_speed_(config.spindle.max_speed),
      heaters_(options.heaters.begin(), options.heaters.end()),
      surface_(options.touch),
      probe_(make_contact(options, kProbeContact)),
      tool_lengths_(options.touch.tool_lengths),
      door_(options.door),
      door_contact_(make_contact(options, kDoorContact)),
      door_open_(options.door && options.door->open),
      present_ports_(ports_of(options.io_cards)) {
  if (options.loop_back_delay) loop_back_.emplace(ticks_of(*options.loop_back_delay));
  wired_.ports = options.ports_on;
  for (std::size_t i = 0; i < kAnalogCount; ++i) set_analog_input(i, options.analog.at(i));
}

AxisArray<VirtualMotor> VirtualMachine::make_motors(const config::MachineConfig& config,
                                                    const MachineOptions& options) {
  const auto make = [&](Axis axis) { return VirtualMotor(config, axis, options); };
  return {
      {make(Axis::X), make(Axis::Y), make(Axis::Z), make(Axis::A), make(Axis::B), make(Axis::C)}};
}

AxisArray<VirtualMachine::AxisWiring> VirtualMachine::make_wiring(const MachineOptions& options) {
  const auto make = [&](Axis axis) {
    const AxisOptions& wires = options.axes[axis];
    const std::uint64_t number = 3 * index_of(axis);
    return AxisWiring{.contacts = {make_contact(options, number), make_contact(options, number + 1),
                                   make_contact(options, number + 2)},
                      .limit_low_port = bit_of(wires.limit_low_port),
                      .limit_high_port = bit_of(wires.limit_high_port),
                      .limits_in_estop_chain = wires.limits_in_estop_chain};
  };
  return {
      {make(Axis::X), make(Axis::Y), make(Axis::Z), make(Axis::A), make(Axis::B), make(Axis::C)}};
}

Position VirtualMachine::physical_position() const {
  Position position;
  for (const Axis axis : kAllAxes) position[axis] = physical_position(axis);
  return position;
}

// --- hands, wiring and faults --------------------------------------------------------------------

void VirtualMachine::open_door(bool open) {
  door_open_ = open;
  drive_spindle();
}

void VirtualMachine::set_port_input(std::size_t port, bool active) {
  wired_.ports = active ? wired_.ports | bit_of(port) : wired_.ports & ~bit_of(port);
}

void VirtualMachine::set_analog_input(std::size_t input, double part) {
  const double value = std::clamp(part, 0.0, 1.0) * Inputs::kFullAnalog;
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

void VirtualMachine::raise_drive_alarm(Axis axis, bool raised) {
  const std::uint8_t bit = axis_bit(index_of(axis));
  raised_alarms_ = static_cast<std::uint8_t>(raised ? raised_alarms_ | bit : raised_alarms_ & ~bit);
}

void VirtualMachine::stick_switch(Axis axis, VirtualMotor::Switch which,
                                  std::optional<bool> state) {
  wiring_[axis].contacts.at(static_cast<std::size_t>(which)).stick(state);
  awake_axes_ |= axis_bit(index_of(axis));
}

void VirtualMachine::stick_door(std::optional<bool> state) { door_contact_.stick(state); }

// --- pins ----------------------------------------------------------------------------------------

void VirtualMachine::set_outputs(const cpu5::firmware::Outputs& outputs) {
  const bool changed = outputs != outputs_;
  outputs_ = outputs;
  for (VirtualMotor& motor : motors_.values) motor.set_drive(outputs.drives_enabled);
  if (loop_back_) loop_back_->set_outputs(outputs.ports & present_ports_, now_);
  drive_spindle();
  if (changed && output_listener_) output_listener_();
}

void VirtualMachine::drive_spindle() {
  const bool cut_off = door_ && door_->stops_spindle && door_open_;
  const double speed = full_speed_ * outputs_.spindle_pwm / cpu5::firmware::Outputs::kFullPwm;
  spindle_.set_target(cut_off ? 0.0 : outputs_.tool_direction ? speed : -speed);
}

Inputs VirtualMachine::inputs(Ticks now) {
  pass_time(board_start_ + now);
  Inputs result = wired_;
  result.estop1 = estop1_.pressed();
  result.estop2 = estop2_.pressed();
  read_axes(result);
  if (door_) read_door(result);
  read_sensors(result);
  if (loop_back_) result.ports |= loop_back_->inputs(now_);
  result.ports &= present_ports_;
  return result;
}

// The board looks at its inputs when it has made every step that is due.
void VirtualMachine::pass_time(Ticks now) {
  for (VirtualMotor& motor : motors_.values) motor.advance(now);
  const bool coolant_cut_off = door_ && door_->stops_coolant && door_open_;
  if (outputs_.mist && !coolant_cut_off) mist_ticks_ += now - now_;
  if (outputs_.flood && !coolant_cut_off) flood_ticks_ += now - now_;
  now_ = now;
  spindle_.advance(now);
  for (VirtualHeater& heater : heaters_) {
    const auto pwm = static_cast<double>(outputs_.pwm.at(heater.options().pwm));
    heater.advance(now, pwm / cpu5::firmware::Outputs::kFullPwm);
  }
}

void VirtualMachine::read_axes(Inputs& inputs) {
  inputs.alarm = raised_alarms_;
  for (const Axis axis : kAllAxes) {
    const bool awake = (awake_axes_ & axis_bit(index_of(axis))) != 0;
    if (awake || !motors_[axis].is_silent()) read_switches(axis, inputs);
  }
}

void VirtualMachine::read_switches(Axis axis, Inputs& inputs) {
  using Switch = VirtualMotor::Switch;
  const VirtualMotor& motor = motors_[axis];
  AxisWiring& wiring = wiring_[axis];
  const std::uint8_t bit = axis_bit(index_of(axis));
  const auto read = [&](Switch which) {
    return wiring.contacts[static_cast<std::size_t>(which)].read(motor.switch_on(which), now_);
  };
  if (read(Switch::home)) inputs.home |= bit;
  const bool low = read(Switch::limit_low);
  const bool high = read(Switch::limit_high);
  if (low) inputs.ports |= wiring.limit_low_port;
  if (high) inputs.ports |= wiring.limit_high_port;
  const bool chain_broken = wiring.limits_in_estop_chain && (low || high);
  inputs.estop1 |= chain_broken;
  inputs.estop2 |= chain_broken;
  if (motor.alarm()) inputs.alarm |= bit;

  const bool asleep = std::ranges::all_of(
      wiring.contacts, [this](const Contact& contact) { return contact.is_asleep(now_); });
  awake_axes_ = static_cast<std::uint8_t>(asleep ? awake_axes_ & ~bit : awake_axes_ | bit);
}

void VirtualMachine::read_door(Inputs& inputs) {
  if (!door_contact_.read(door_open_, now_)) return;
  inputs.ports |= bit_of(door_->port);
  inputs.estop1 |= door_->in_estop_chain;
  inputs.estop2 |= door_->in_estop_chain;
}

// The board's capture unit counts on the board's clock.
void VirtualMachine::read_sensors(Inputs& inputs) {
  inputs.probe = probe_.read(probe_touches(), now_);
  inputs.sync = spindle_.sync_input();
  inputs.index_count = spindle_.pulses();
  inputs.index_time = spindle_.last_pulse() - board_start_;
  for (const VirtualHeater& heater : heaters_) {
    const double part = std::clamp(heater.sensor(), 0.0, 1.0);
    inputs.analog.at(heater.options().analog) =
        static_cast<std::uint32_t>(std::lround(part * Inputs::kFullAnalog));
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
