// The machine on the other side of the step pulses: motors, travel stops, home switches, a probe, a
// spindle, heaters, the operator's hands, and what is wired to the outputs.
//
// Each connected axis has a motor that follows its steps while the drives are enabled, a hard stop
// a little beyond either end of its travel, and a home switch at the end to which homing goes. A
// step that the motor cannot make, against a stop or with the drives off, is lost and counted. The
// switch stays on from its trip point to the stop and releases, coming back, exactly at the axis's
// home_position: a perfectly homed machine counts what physical_position() says.
//
// An axis without travel (negative limit not below the positive one) has no stops; one without a
// home velocity has no switch.
//
// The probe input is active while the tip of the tool (machine Z less the tool's length) is at or
// below the stock or the tool setter: the tool itself is the probe. The spindle turns as its PWM
// and direction outputs say; at full PWM it makes the configured highest speed. Not thread-safe.
#pragma once

#include <optional>
#include <vector>

#include "config/machine_config.h"
#include "hal/cpu5/firmware/board_io.h"
#include "hal/sim/loop_back.h"
#include "hal/sim/touch_surface.h"
#include "hal/sim/virtual_heater.h"
#include "hal/sim/virtual_spindle.h"

namespace cnc::hal::sim {

struct MachineOptions {
  /// Where the axes stand at power-up, mm and degrees; unset: in the middle of their travel. An
  /// axis placed beyond a stop stands at the stop.
  std::optional<Position> start{};
  double stop_margin = 5.0;        ///< from the end of the travel to the hard stop, mm or degrees
  double switch_hysteresis = 0.2;  ///< between trip and release of a home switch, mm or degrees
  TouchOptions touch{};
  SpindleOptions spindle{};
  std::vector<HeaterOptions> heaters{};
  /// Wires every AUX and card output to the input of its number, through relays that take so long,
  /// s; unset: no wires.
  std::optional<double> loop_back_delay{};
};

class VirtualMachine final : public cpu5::firmware::BoardIo {
 public:
  VirtualMachine(const config::MachineConfig& config, const MachineOptions& options);

  // The operator's hands and the wiring. Everything stays as it is put.
  void press_estop(bool pressed) { wired_.estop1 = pressed; }
  void press_estop2(bool pressed) { wired_.estop2 = pressed; }
  void raise_external_error(bool raised) { wired_.external_error = raised; }
  /// `port` as hal::port_bit() counts. Either this or the loop-back makes the input active.
  void set_port_input(std::size_t port, bool active);
  /// 0 … 1 of the range; where no heater's sensor is.
  void set_analog_input(std::size_t input, double part);
  /// Quarter steps, signed.
  void turn_hand_wheel(std::int32_t counts);
  /// Of the tool in the spindle, mm.
  void set_tool_length(double length) { tool_length_ = length; }
  /// Puts a tool of MachineOptions::touch.tool_lengths in; one that is not in it has length 0.
  void load_tool(int number);

  [[nodiscard]] double physical_position(Axis axis) const;
  [[nodiscard]] Position physical_position() const;
  [[nodiscard]] std::uint64_t lost_steps(Axis axis) const { return motors_[axis].lost; }
  [[nodiscard]] bool home_switch(Axis axis) const { return motors_[axis].switch_on; }
  [[nodiscard]] bool estop_pressed() const { return wired_.estop1; }
  [[nodiscard]] bool probe_touches() const;
  [[nodiscard]] double tool_length() const { return tool_length_; }
  [[nodiscard]] double spindle_speed() const { return spindle_.speed(); }  ///< rpm, signed
  /// deg C; in the order of MachineOptions::heaters.
  [[nodiscard]] double temperature(std::size_t heater) const {
    return heaters_.at(heater).temperature();
  }
  [[nodiscard]] const cpu5::firmware::Outputs& outputs() const { return outputs_; }

  void step(std::size_t axis, int direction, cpu5::firmware::Ticks when) override;
  cpu5::firmware::Inputs inputs(cpu5::firmware::Ticks now) override;
  void set_outputs(const cpu5::firmware::Outputs& outputs) override;

 private:
  /// Places are whole steps, upwards in the axis's direction, counted from the home position: only
  /// then can the switch release exactly there.
  struct Motor {
    bool connected = false;
    int sense = 1;  ///< -1: positive steps move the axis in its negative direction
    double steps_per_unit = 1.0;
    double home_position = 0.0;
    std::int64_t place = 0;
    std::int64_t low_stop = 0;
    std::int64_t high_stop = 0;
    int switch_side = 0;          ///< +1 at the positive end, -1 at the negative, 0: no switch
    std::int64_t hysteresis = 0;  ///< steps, at least 1
    bool switch_on = false;
    std::uint64_t lost = 0;

    void update_switch();
  };
  static Motor make_motor(const config::AxisConfig& axis, std::optional<double> start,
                          const MachineOptions& options);

  void pass_time(cpu5::firmware::Ticks now);
  void read_sensors(cpu5::firmware::Inputs& inputs);

  AxisArray<Motor> motors_;
  VirtualSpindle spindle_;
  double full_speed_;  // of the spindle, rpm
  std::vector<VirtualHeater> heaters_;
  TouchSurface surface_;
  std::map<int, double> tool_lengths_;
  double tool_length_ = 0.0;
  std::optional<LoopBack> loop_back_;
  cpu5::firmware::Inputs wired_;  // what does not come from the machine itself
  cpu5::firmware::Outputs outputs_;
  cpu5::firmware::Ticks now_ = 0;
};

}  // namespace cnc::hal::sim
