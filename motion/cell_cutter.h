// Keeps the path, with the places at which the motion has to stand, and cuts it into the cells of
// the third-order plan: at least one per interval, short where the motion starts and stops, never
// growing fast.
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

class CellCutter {
 public:
  CellCutter(const JerkLimits& limits, std::size_t max_intervals);

  [[nodiscard]] const Ring<PathInterval>& intervals() const { return intervals_; }

  [[nodiscard]] bool has_room() const { return intervals_.free() > 0 && stops_.free() > 1; }
  void append(const PathInterval& interval);
  /// The motion has to stand at the present end of the path.
  void stop_at_end();
  void clear();
  /// Forgets the intervals before number `interval`.
  void forget_before(std::uint64_t interval);

  [[nodiscard]] const PathPlace& place() const { return at_.place; }
  /// Length of what is not cut yet, up to the next stop.
  [[nodiscard]] double left() const { return at_.left; }
  [[nodiscard]] bool path_left() const { return at_.left > 1e-9; }
  /// The stop at which the cells will end is known.
  [[nodiscard]] bool end_is_known() const { return at_.end_is_known; }
  [[nodiscard]] PathPlace behind(PathPlace place, double length) const;
  /// The same, exactly at the end of an interval if it is as near as rounding makes it.
  [[nodiscard]] PathPlace end_behind(const PathPlace& place, double length) const;

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

  /// What a stop from full speed takes on an interval, generously.
  [[nodiscard]] double stopping_distance(const PathInterval& interval) const;

  /// How far it has come; to be kept and to be put back.
  struct State {
    PathPlace place;
    double previous = 0.0;
    double standstill = 0.0;
    double left = 0.0;
    bool end_is_known = false;
    bool ends_early = false;
  };
  [[nodiscard]] const State& state() const { return at_; }
  void set_state(const State& state) { at_ = state; }

 private:
  [[nodiscard]] bool end_is_final() const { return at_.end_is_known || at_.ends_early; }
  [[nodiscard]] std::uint64_t next_stop(std::uint64_t interval) const;
  [[nodiscard]] SpeedCell rest_of_interval() const;
  [[nodiscard]] double longest_here() const;
  [[nodiscard]] double length_towards_end() const;
  void move_on(double length);

  JerkLimits limits_;
  Ring<PathInterval> intervals_;
  Ring<std::uint64_t> stops_;  ///< before these intervals
  State at_;
};

}  // namespace cnc::motion
