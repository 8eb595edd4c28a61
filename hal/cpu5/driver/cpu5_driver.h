// The CPU5 board as a Controller: machine coordinates to steps and ticks, status back.
//
// Requests are collected in one frame and leave with the next exchange(), in the order quick
// stop, clear, release, stop along the path, latches, outputs, segments and a cut among them. After
// a fault the board keeps its outputs safe: only set_outputs() called after clear_faults(), in the
// same exchange or later, switches anything on again.
#pragma once

#include <memory>

#include "config/machine_config.h"
#include "hal/controller.h"
#include "hal/cpu5/driver/board_port.h"
#include "hal/cpu5/driver/motor_scale.h"
#include "hal/cpu5/driver/tick_clock.h"

namespace cnc::hal::cpu5 {

struct DriverSettings {
  double max_step_frequency = 400e3;  ///< Hz, at most 495 kHz; LNK-3
  double host_timeout = 0.5;  ///< s without exchange until the board calls the link lost; 0 = never
  double index_timeout = 5.0;  ///< s that a segment waits for the spindle's index; 0 = for ever
  bool drives_off_on_fault = true;
};

class Cpu5Driver : public Controller {
 public:
  Cpu5Driver(const config::MachineConfig& config, const DriverSettings& settings,
             std::unique_ptr<BoardPort> port);

  /// Refuses an axis whose steps per unit are no usable number, and one whose configured velocity
  /// needs more than the maximum step frequency.
  Result<Capabilities> connect() override;
  void disconnect() override;
  const ControllerStatus& exchange(double now) override;

  [[nodiscard]] std::size_t free_segments() const override;
  std::size_t push(std::span<const Segment> segments) override;
  void cut_behind(std::uint32_t id) override;

  void set_outputs(const Outputs& outputs) override;
  void quick_stop() override;
  void stop_along_path() override;
  void release_stop() override;
  void clear_faults() override;
  bool set_position(Axis axis, double position) override;

  void arm_home_latch(Axis axis, LatchEdge edge) override;
  void disarm_home_latch(Axis axis) override;
  void arm_probe_latch() override;
  void disarm_probe_latch() override;

 private:
  [[nodiscard]] Result<void> check_axes() const;
  [[nodiscard]] firmware::Setup setup() const;
  [[nodiscard]] firmware::Segment to_board(const Segment& segment);
  void drop_segments();
  [[nodiscard]] std::uint32_t most_kept_by_cut() const;
  void read_status();
  void read_latches();
  void read_probe_latch();
  [[nodiscard]] Position position_of(const firmware::PerAxis<std::int64_t>& counts) const;

  AxisArray<config::AxisConfig> axes_;
  DriverSettings settings_;
  std::unique_ptr<BoardPort> port_;
  AxisArray<MotorScale> scales_;
  TickClock clock_;
  firmware::HostFrame frame_;  // goes out with the next exchange
  firmware::Status board_;     // as last heard
  ControllerStatus status_;
};

}  // namespace cnc::hal::cpu5
