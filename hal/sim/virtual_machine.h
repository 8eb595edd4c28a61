// The machine on the other side of the step pulses: motors, travel stops, switches, an estop chain,
// a door, a probe, a spindle, heaters, the operator's hands, and what is wired to the outputs.
//
// Each connected axis has a motor that follows its steps as far as its torque goes (rotor.h) while
// the drives are enabled, a hard stop a little beyond either end of its travel, a limit switch
// before each, and a home switch at the end to which homing goes. A step that the motor cannot make
// is lost and counted. The home switch stays on from its trip point to the stop and releases,
// coming back, exactly at the axis's home_position: a perfectly homed machine counts what
// physical_position() says.
//
// An axis without travel (negative limit not below the positive one) has no stops and no limit
// switches; one without a home velocity has no home switch.
//
// The probe input is active while the tip of the tool (machine Z less the tool's length) is at or
// below the stock or the tool setter: the tool itself is the probe. The spindle turns as its PWM
// and direction outputs say; at full PWM it makes the configured highest speed.
//
// Everything can fail, by hand or by a scenario's events. The same options, steps and times give
// the same machine, to the last bounce of a switch. One thread; only the first estop button may be
// pressed from another.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "config/machine_config.h"
#include "hal/cpu5/firmware/board_io.h"
#include "hal/sim/contact.h"
#include "hal/sim/loop_back.h"
#include "hal/sim/machine_options.h"
#include "hal/sim/push_button.h"
#include "hal/sim/touch_surface.h"
#include "hal/sim/virtual_motor.h"

namespace cnc::hal::sim {

class VirtualMachine final : public cpu5::firmware::BoardIo {
 public:
  using Ticks = cpu5::firmware::Ticks;

  VirtualMachine(const config::MachineConfig& config, const MachineOptions& options);

  // The operator's hands and the wiring. Everything stays as it is put.
  /// Any thread.
  void press_estop(bool pressed) { estop1_.press(pressed); }
  void press_estop2(bool pressed) { estop2_.press(pressed); }
  void raise_external_error(bool raised) { wired_.external_error = raised; }
  void open_door(bool open);
  /// `port` as hal::port_bit() counts. Either this, the loop-back, or what is wired to the port
  /// makes the input active.
  void set_port_input(std::size_t port, bool active);
  /// 0 … 1 of the range; where no heater's sensor is.
  void set_analog_input(std::size_t input, double part);
  /// Quarter steps, signed.
  void turn_hand_wheel(std::int32_t counts);
  /// Of the tool in the spindle, mm.
  void set_tool_length(double length) { tool_length_ = length; }
  /// Puts a tool of MachineOptions::touch.tool_lengths in; one that is not in it has length 0.
  void load_tool(int number);

  // Faults.
  /// The axis moves so many steps, signed, that the board knows nothing of; never beyond a stop.
  void lose_steps(Axis axis, std::int64_t steps) { motors_[axis].lose_steps(steps); }
  /// Beside the alarms that closed-loop drives raise themselves.
  void raise_drive_alarm(Axis axis, bool raised);
  /// On, off, or unset: free again.
  void stick_switch(Axis axis, VirtualMotor::Switch which, std::optional<bool> state);
  void stick_probe(std::optional<bool> state) { probe_.stick(state); }
  void stick_door(std::optional<bool> state);
  void set_index_missing(bool missing) { spindle_.set_index_missing(missing); }
  /// The board begins anew, its clock at 0; the machine goes on from where it is.
  void restart_board() { board_start_ = now_; }

  [[nodiscard]] double physical_position(Axis axis) const { return motors_[axis].position(); }
  [[nodiscard]] Position physical_position() const;
  [[nodiscard]] std::uint64_t lost_steps(Axis axis) const { return motors_[axis].lost_steps(); }
  [[nodiscard]] bool home_switch(Axis axis) const {
    return motors_[axis].switch_on(VirtualMotor::Switch::home);
  }
  [[nodiscard]] bool estop_pressed() const { return estop1_.pressed(); }
  [[nodiscard]] bool door_open() const { return door_open_; }
  [[nodiscard]] bool probe_touches() const;
  [[nodiscard]] double tool_length() const { return tool_length_; }
  [[nodiscard]] double spindle_speed() const { return spindle_.speed(); }  ///< rpm, signed
  /// deg C; in the order of MachineOptions::heaters.
  [[nodiscard]] double temperature(std::size_t heater) const {
    return heaters_.at(heater).temperature();
  }
  /// s for which mist, or flood, has run.
  [[nodiscard]] double mist_time() const { return seconds(mist_ticks_); }
  [[nodiscard]] double flood_time() const { return seconds(flood_ticks_); }
  [[nodiscard]] const cpu5::firmware::Outputs& outputs() const { return outputs_; }
  /// Is called when the board has switched something, with where the machine stands at that tick.
  void set_output_listener(std::function<void()> listener) {
    output_listener_ = std::move(listener);
  }
  /// s since power-up of the machine, as far as the board has looked at its inputs.
  [[nodiscard]] double time() const { return seconds(now_); }

  void step(std::size_t axis, int direction, Ticks /*when*/) override {
    motors_.values[axis].step(direction);
  }
  cpu5::firmware::Inputs inputs(Ticks now) override;
  void set_outputs(const cpu5::firmware::Outputs& outputs) override;

 private:
  /// The contacts of an axis's switches, in the order of VirtualMotor::Switch, and their wires.
  struct AxisWiring {
    std::array<Contact, 3> contacts;
    cpu5::firmware::PortBits limit_low_port = 0;
    cpu5::firmware::PortBits limit_high_port = 0;
    bool limits_in_estop_chain = false;
  };
  static AxisArray<VirtualMotor> make_motors(const config::MachineConfig& config,
                                             const MachineOptions& options);
  static AxisArray<AxisWiring> make_wiring(const MachineOptions& options);
  [[nodiscard]] static double seconds(Ticks ticks) {
    return static_cast<double>(ticks) / double{cpu5::firmware::kTicksPerSecond};
  }

  void pass_time(Ticks now);
  void drive_spindle();
  void read_axes(cpu5::firmware::Inputs& inputs);
  void read_switches(Axis axis, cpu5::firmware::Inputs& inputs);
  void read_door(cpu5::firmware::Inputs& inputs);
  void read_sensors(cpu5::firmware::Inputs& inputs);

  AxisArray<VirtualMotor> motors_;
  AxisArray<AxisWiring> wiring_;
  std::uint8_t awake_axes_ = 0;  // of whose contacts one is closed, stuck or bouncing
  VirtualSpindle spindle_;
  double full_speed_;  // of the spindle, rpm
  std::vector<VirtualHeater> heaters_;
  TouchSurface surface_;
  Contact probe_;
  std::map<int, double> tool_lengths_;
  double tool_length_ = 0.0;
  std::optional<LoopBack> loop_back_;
  std::optional<DoorOptions> door_;
  Contact door_contact_;
  bool door_open_ = false;
  PushButton estop1_;
  PushButton estop2_;
  std::uint8_t raised_alarms_ = 0;
  cpu5::firmware::PortBits present_ports_ = 0;
  cpu5::firmware::Inputs wired_;  // what does not come from the machine itself
  cpu5::firmware::Outputs outputs_;
  std::function<void()> output_listener_;
  Ticks now_ = 0;  // since power-up of the machine
  Ticks board_start_ = 0;
  Ticks mist_ticks_ = 0;
  Ticks flood_ticks_ = 0;
};

}  // namespace cnc::hal::sim
