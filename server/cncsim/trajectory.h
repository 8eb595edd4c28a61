// The commanded trajectory of a job: statistics, and a recording of one row per millisecond.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "motion/planner.h"

namespace cnc::server {

/// Largest and smallest values over the whole trajectory, from the cubics themselves.
struct TrajectorySummary {
  double time = 0.0;      ///< s, dwells included
  double distance = 0.0;  ///< mm along X Y Z
  Position min;
  Position max;
  Position max_velocity;      ///< per axis, absolute
  Position max_acceleration;  ///< per axis, absolute
};

class TrajectoryStatistics {
 public:
  explicit TrajectoryStatistics(const Position& start);
  void add(const motion::Setpoint& setpoint);
  /// The machine stands elsewhere than where the last setpoint led: a probe move ended by itself.
  void restart(const Position& position);
  [[nodiscard]] const TrajectorySummary& summary() const { return summary_; }

 private:
  TrajectorySummary summary_;
  Position position_;
  Position velocity_;
};

/// Writes "t,x,y,z,a,b,c,f,line": seconds, commanded machine position before step rounding (mm and
/// degrees, 1e-9), programmed feed limit in mm/s (0 for a rapid), source line.
class TrajectoryRecorder {
 public:
  [[nodiscard]] static Result<TrajectoryRecorder> create(const std::filesystem::path& path,
                                                         const Position& start);
  void add(const motion::Setpoint& setpoint);
  /// As TrajectoryStatistics::restart(): the rows jump there.
  void restart(const Position& position);
  /// Writes the last row, the end of the motion. Fails when the disk did not take everything.
  [[nodiscard]] Result<void> finish();

 private:
  TrajectoryRecorder(const std::filesystem::path& path, std::FILE* file, const Position& start);
  void write_row(double t, const Position& position, const motion::Setpoint& of);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  Position position_;
  Position velocity_;
  double begin_ = 0.0;          // of the next setpoint, s
  std::uint64_t next_row_ = 0;  // in ms
  motion::Setpoint last_;
  bool failed_ = false;
};

}  // namespace cnc::server
