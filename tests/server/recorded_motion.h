// What a machine under test was really given to execute: the stream of its setpoints, without those
// that were replaced, on the time line of the board.
#pragma once

#include <vector>

#include "motion/curve.h"
#include "motion/setpoint.h"
#include "tests/server/rig.h"

namespace cnc::server::test {

/// The stream of one job that never waits for anything but its own motion.
class RecordedMotion {
 public:
  /// From the next setpoint on.
  explicit RecordedMotion(Rig& rig);
  RecordedMotion(const RecordedMotion&) = delete;
  RecordedMotion& operator=(const RecordedMotion&) = delete;

  [[nodiscard]] const std::vector<motion::Setpoint>& setpoints() const { return setpoints_; }
  [[nodiscard]] double duration() const;
  /// Simulation's time at which the board began with the first setpoint.
  [[nodiscard]] double begin() const { return begin_; }
  /// Number of setpoints that stayed at the last cut, and the time at which the last of them ends.
  [[nodiscard]] std::size_t kept() const { return kept_; }
  [[nodiscard]] double end_of_kept() const;
  [[nodiscard]] int cuts() const { return cuts_; }
  void forget_cuts() { cuts_ = 0; }
  [[nodiscard]] const Position& end() const { return setpoints_.back().position; }

  /// The largest part of its limits that any axis uses.
  [[nodiscard]] double usage(const config::MachineConfig& config) const;
  /// Largest distance of this motion from the path of `other`, which begins at the same place. It
  /// has to go along that path in the same direction, at whatever speed.
  [[nodiscard]] double distance_from(const RecordedMotion& other) const;

 private:
  std::vector<motion::Setpoint> setpoints_;
  double begin_ = 0.0;
  std::size_t kept_ = 0;
  int cuts_ = 0;
};

}  // namespace cnc::server::test
