// The CPU5 board as a Controller: machine coordinates to steps and ticks, status back.
//
// Requests are collected and leave with the next exchange(), in the order quick stop, clear,
// release, stop along the path, latches, outputs, segments and a cut among them; in as many frames
// as the segments need, and later when the line is full. After a fault the board keeps its outputs
// safe: only set_outputs() called after clear_faults(), in the same exchange or later, switches
// anything on again.
//
// The status is that of a moment ago: frames that are still on their way are counted here as if the
// board had them, where that is the cautious thing to do.
#pragma once

#include <memory>

#include "config/machine_config.h"
#include "hal/controller.h"
#include "hal/cpu5/driver/board_port.h"
#include "hal/cpu5/driver/motor_scale.h"
#include "hal/cpu5/driver/tick_clock.h"

namespace cnc::hal::cpu5 {

/// Pulse times are those of the configuration's connection, polarities those of its axes.
struct DriverSettings {
  double max_step_frequency = 400e3;  ///< Hz, at most 495 kHz; LNK-3
  double host_timeout = 0.5;   ///< s without exchange until the board stops the machine; 0 = never
  double index_timeout = 5.0;  ///< s that a segment waits for the spindle's index; 0 = for ever
  bool drives_off_on_fault = true;
};

/// What the configuration says of them.
[[nodiscard]] DriverSettings driver_settings(const config::MachineConfig& config);

class Cpu5Driver : public Controller {
 public:
  Cpu5Driver(const config::MachineConfig& config, const DriverSettings& settings,
             std::unique_ptr<BoardPort> port);

  /// Refuses an axis whose steps per unit are no usable number, and one whose configured velocity
  /// needs more than the maximum step frequency.
  Result<Capabilities> connect() override;
  void disconnect() override;
  const ControllerStatus& exchange(double now) override;
  [[nodiscard]] std::uint64_t next_frame() const override {
    return port_->frames_sent() + outbox_count_;
  }

  [[nodiscard]] std::size_t free_segments() const override;
  std::size_t push(std::span<const Segment> segments) override;
  void cut_behind(std::uint32_t id) override;

  void set_outputs(const Outputs& outputs) override;
  bool change_outputs(const OutputChange& change) override;
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
  /// What counts of a frame until the board has answered it.
  struct OnItsWay {
    bool empties_fifo = false;
    bool has_cut = false;
    std::uint32_t cut_behind = 0;
    std::uint32_t segments_before_cut = 0;
    std::uint32_t segments = 0;
  };
  static constexpr std::size_t kMostOnTheirWay = 64;
  /// The largest FIFO, and a cut.
  static constexpr std::size_t kOutbox = firmware::kFifoCapacity / firmware::kSegmentsPerFrame + 3;

  [[nodiscard]] Result<void> check_axes() const;
  [[nodiscard]] LinkObstacle obstacle_in(const wire::Identity& board) const;
  [[nodiscard]] firmware::Setup setup() const;
  [[nodiscard]] firmware::Segment to_board(const Segment& segment);
  void drop_segments();
  [[nodiscard]] firmware::HostFrame& asked() { return outbox_[0]; }
  [[nodiscard]] firmware::HostFrame& last_frame() { return outbox_[outbox_count_ - 1]; }
  bool begin_frame();
  void send_frames();
  [[nodiscard]] bool start_is_short_behind(const firmware::HostFrame& frame);
  void empty_outbox();
  void take(const BoardAnswer& answer);
  void begin_session(const BoardAnswer& answer);
  [[nodiscard]] static OnItsWay summary_of(const firmware::HostFrame& frame);
  template <typename Visit>
  void for_each_on_its_way(Visit visit) const;
  void read_status();
  void read_latches();
  void read_probe_latch();
  void read_event(EventLatch& latch, std::uint32_t count,
                  const firmware::PerAxis<std::int64_t>& counts, firmware::Ticks time) const;
  [[nodiscard]] bool path_is_on_its_way() const;
  [[nodiscard]] Position position_of(const firmware::PerAxis<std::int64_t>& counts) const;

  AxisArray<config::AxisConfig> axes_;
  config::ConnectionConfig connection_;
  firmware::PerGuardRule<firmware::GuardRule> guards_;
  DriverSettings settings_;
  std::unique_ptr<BoardPort> port_;
  AxisArray<MotorScale> scales_;
  TickClock clock_;
  std::uint32_t fifo_capacity_ = 0;
  // What goes out with the next exchange: the first frame has the requests, all have segments.
  std::array<firmware::HostFrame, kOutbox> outbox_;
  std::size_t outbox_count_ = 1;
  OutputChange change_{};  // that goes out with it
  bool has_requests_ = false;
  bool path_ends_at_rest_ = true;                       // as sent
  firmware::Ticks begun_path_ = 0;                      // sent since it began
  std::array<OnItsWay, kMostOnTheirWay> on_their_way_;  // by number
  firmware::Status board_;                              // as last heard
  std::uint32_t greetings_ = 0;
  AxisArray<std::uint64_t> latch_frame_{};  // in which a latch was armed or disarmed last
  std::uint64_t probe_frame_ = 0;
  std::uint64_t clear_frame_ = 0;
  ControllerStatus status_;
};

}  // namespace cnc::hal::cpu5
