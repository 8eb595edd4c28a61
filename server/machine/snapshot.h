// One immutable picture of the machine, published by the executor and read by anybody.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "config/axis.h"
#include "hal/controller.h"
#include "interpreter/canonical.h"
#include "server/machine/position_trust.h"
#include "server/machine/state_table.h"

namespace cnc::server {

struct JobSnapshot {
  std::string path;
  std::uint64_t lines = 0;
  std::uint64_t line = 0;
  double progress = 0.0;  ///< 0 … 1
  double elapsed = 0.0;   ///< s
  bool prediction_ready = false;
  double predicted_time = 0.0;
  double time_left = 0.0;
  std::uint64_t runs = 0;
  bool ended_well = false;
  std::uint64_t problems = 0;
  Position extents_min;
  Position extents_max;
};

/// What a program asks the operator (dlgmsg).
struct QuestionSnapshot {
  struct Field {
    std::string label;
    std::int32_t parameter = 0;
    double value = 0.0;
  };
  std::uint64_t number = 0;  ///< counts up; the answer names it
  std::string title;
  std::vector<Field> fields;
};

/// What the board's latches have caught.
struct LatchSnapshot {
  double board_time = 0.0;
  AxisArray<hal::Latch> home{};
  hal::ProbeLatch probe{};
  hal::EventLatch spindle_index{};
  hal::EventLatch estop{};
};

struct MachineSnapshot {
  std::uint64_t sequence = 0;
  double time = 0.0;
  State state = State::off;
  std::string state_text;
  Position machine_position;
  Position work_position;
  AxisArray<Trust> trust = AxisArray<Trust>::filled(Trust::unknown);
  Position velocity;
  double feed = 0.0;             ///< mm/s along the path
  double programmed_feed = 0.0;  ///< mm/s; 0 = rapid or none
  double feed_override = 1.0;
  double rapid_override = 1.0;
  double speed_override = 1.0;
  bool overrides_enabled = true;
  interp::SpindleDirection spindle = interp::SpindleDirection::off;
  double spindle_speed = 0.0;
  bool mist = false;
  bool flood = false;
  std::int32_t tool = 0;
  std::int32_t selected_tool = 0;
  std::int32_t work_system = 1;
  std::string active_codes;
  JobSnapshot job;
  std::optional<QuestionSnapshot> question;
  bool estop_input = false;
  bool probe_input = false;
  AxisArray<bool> home_switches{};
  double fifo_time = 0.0;
  bool board_connected = false;
  hal::BoardIdentity board;          ///< that it was last connected to
  std::uint32_t board_sessions = 0;  ///< links made since the server started
  LatchSnapshot latches{};
  std::uint64_t newest_message = 0;
};

/// Holds the newest snapshot. The lock is held for the copy of a pointer; the real-time thread has
/// no part in it.
class SnapshotBoard {
 public:
  void publish(MachineSnapshot snapshot) {
    auto next = std::make_shared<const MachineSnapshot>(std::move(snapshot));
    const std::scoped_lock lock(mutex_);
    newest_ = std::move(next);
  }
  [[nodiscard]] std::shared_ptr<const MachineSnapshot> newest() const {
    const std::scoped_lock lock(mutex_);
    return newest_;
  }

 private:
  mutable std::mutex mutex_;  // protects newest_
  std::shared_ptr<const MachineSnapshot> newest_ = std::make_shared<const MachineSnapshot>();
};

}  // namespace cnc::server
