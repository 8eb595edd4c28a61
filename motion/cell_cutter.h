// Cuts the path into the cells of the third-order plan: at least one per interval, short where the
// motion starts and stops, never growing fast.
#pragma once

#include <cstdint>
#include <optional>

#include "motion/path_interval.h"
#include "motion/ring.h"
#include "motion/speed_cell.h"

namespace cnc::motion {

/// A place on the path: `start` inside interval number `interval`.
struct PathPlace {
  std::uint64_t interval = 0;
  double start = 0.0;
};

/// What a stop from full speed takes on an interval, generously.
struct Stopping {
  double distance;
  double time;
};

class CellCutter {
 public:
  CellCutter(const JerkLimits& limits, std::size_t max_intervals);

  Ring<PathInterval> intervals;

  void append(const PathInterval& interval);
  /// Nothing follows: the end may be approached.
  void close() { closed_ = true; }
  [[nodiscard]] bool closed() const { return closed_; }

  [[nodiscard]] const PathPlace& place() const { return place_; }
  /// Length of what is not cut yet.
  [[nodiscard]] double left() const { return left_; }
  [[nodiscard]] bool path_left() const { return left_ > 1e-9; }
  [[nodiscard]] PathPlace behind(PathPlace place, double length) const;

  /// Goes on from an earlier or later place; the next cell is at most `growth` times `previous`
  /// long.
  void go_to(const PathPlace& place, double previous);

  /// The path shall end `length` from here, until go_to().
  void end_after(double length);

  /// The motion starts from rest here: the length of its start, which skip() takes.
  double begin_run();
  void skip(double length);
  [[nodiscard]] Reach reach_of(PathPlace begin, double length) const;

  /// Length of the next cell; 0 when only enough for a stop is left.
  [[nodiscard]] double next_length() const;
  /// The next cell; nothing when only enough for a stop is left.
  [[nodiscard]] std::optional<SpeedCell> next();
  /// Length that a stop behind the last cell cut may take.
  [[nodiscard]] double stop_length() const;

  [[nodiscard]] SpeedCell cell_at(const PathPlace& place, double length) const;

  [[nodiscard]] Stopping stopping_on(const PathInterval& interval) const;

 private:
  [[nodiscard]] bool end_is_final() const { return closed_ || ends_early_; }
  [[nodiscard]] double longest_here() const;
  [[nodiscard]] double length_towards_end() const;
  void move_on(double length);

  JerkLimits limits_;
  PathPlace place_;
  double previous_ = 0.0;
  double standstill_ = 0.0;
  double left_ = 0.0;
  bool closed_ = false;
  bool ends_early_ = false;
};

}  // namespace cnc::motion
