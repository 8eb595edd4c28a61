// The machine on the other side of the step pulses: motors, travel stops, home switches, the estop
// button, and what is wired to the outputs.
//
// Each connected axis has a motor that follows its steps while the drives are enabled, a hard stop
// a little beyond either end of its travel, and a home switch at the end to which homing goes. A
// step that the motor cannot make, against a stop or with the drives off, is lost and counted. The
// switch stays on from its trip point to the stop and releases, coming back, exactly at the axis's
// home_position: a perfectly homed machine counts what physical_position() says.
//
// An axis without travel (negative limit not below the positive one) has no stops; one without a
// home velocity has no switch. Not thread-safe.
#pragma once

#include <optional>

#include "config/machine_config.h"
#include "hal/cpu5/firmware/board_io.h"

namespace cnc::hal::sim {

struct MachineOptions {
  /// Where the axes stand at power-up, mm and degrees; unset: in the middle of their travel. An
  /// axis placed beyond a stop stands at the stop.
  std::optional<Position> start{};
  double stop_margin = 5.0;        ///< from the end of the travel to the hard stop, mm or degrees
  double switch_hysteresis = 0.2;  ///< between trip and release of a home switch, mm or degrees
};

class VirtualMachine final : public cpu5::firmware::BoardIo {
 public:
  VirtualMachine(const config::MachineConfig& config, const MachineOptions& options);

  /// The operator's button; it stays as it is put.
  void press_estop(bool pressed) { estop_ = pressed; }

  [[nodiscard]] double physical_position(Axis axis) const;
  [[nodiscard]] Position physical_position() const;
  [[nodiscard]] std::uint64_t lost_steps(Axis axis) const { return motors_[axis].lost; }
  [[nodiscard]] bool home_switch(Axis axis) const { return motors_[axis].switch_on; }
  [[nodiscard]] bool estop_pressed() const { return estop_; }
  [[nodiscard]] const cpu5::firmware::Outputs& outputs() const { return outputs_; }

  void step(std::size_t axis, int direction) override;
  cpu5::firmware::Inputs inputs() override;
  void set_outputs(const cpu5::firmware::Outputs& outputs) override { outputs_ = outputs; }

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

  AxisArray<Motor> motors_;
  cpu5::firmware::Outputs outputs_;
  bool estop_ = false;
};

}  // namespace cnc::hal::sim
