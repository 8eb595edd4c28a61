// The fastest motion along a path within velocity, acceleration and jerk of every axis, from
// standstill to standstill, planned while the path is still arriving and while the motion runs.
//
// The path comes as intervals (path_interval.h), is cut into cells (cell_cutter.h), and x(u) over
// them is improved in rounds (speed_window.h). The plan in force keeps every limit and ends in a
// standstill on the known path, always: a better or longer one takes its place only when it is
// finished and keeps them too. If that fails, the motion stops where the plan in force ends and
// goes on from there.
//
// Memory is fixed at construction. A call of plan() costs at most a fixed number of rounds over the
// cells ahead of the place. Units: mm, s, degrees for rotary axes. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "motion/cell_cutter.h"
#include "motion/cell_motion.h"
#include "motion/speed_window.h"

namespace cnc::motion {

/// Where the motion is: a value that a caller may keep with each setpoint, to come back to it.
struct MotionPlace {
  enum class Phase : std::uint8_t { standing, starting, driving, stopping };
  Phase phase = Phase::standing;
  std::uint64_t cell = 0;  ///< driving only
  double time = 0.0;       ///< since the phase or the cell began
};

/// What it does there.
struct PathMotion {
  PathPlace place;
  double v = 0.0;   ///< du/dt
  double w = 0.0;   ///< d²u/dt²
  double dw = 0.0;  ///< dw/du, infinite at a standstill
};

class JerkPlan {
 public:
  explicit JerkPlan(const JerkLimits& limits, std::size_t max_cells = 4096,
                    std::size_t max_intervals = 4096);

  /// Whether more path is of use, and there is room for it.
  [[nodiscard]] bool wants_path() const;
  void append(const PathInterval& interval);
  /// The path ends here: the motion may stop at its very end. append() opens it again.
  void close();

  /// Whether plan() would have enough to do.
  [[nodiscard]] bool due() const;
  /// Plans what has been appended or changed. False when no better plan was found: the one in force
  /// goes on, and due() asks for the next attempt.
  bool plan();

  /// Factor on every feed, 0.001 … 10; acts with the next plan().
  void set_override(double factor);
  /// Stops as soon as the limits allow with the next plan(), and stays there until resume().
  void hold();
  void resume();

  [[nodiscard]] const MotionPlace& place() const { return place_; }
  [[nodiscard]] bool standing() const { return place_.phase == MotionPlace::Phase::standing; }
  /// Everything is driven.
  [[nodiscard]] bool idle() const { return standing() && !cutter_.path_left(); }
  [[nodiscard]] PathMotion motion() const;
  [[nodiscard]] const PathInterval& interval(std::uint64_t index) const {
    return cutter_.intervals[index];
  }

  /// Time until the present cell or phase ends; 0 when standing.
  [[nodiscard]] double time_in_cell() const;
  /// Moves on by `time` along the plan in force.
  void advance(double time);
  /// Back to a place of the same run (since the last standstill) that was not forgotten, and not
  /// before the one at which a hold, a resume or an override was planned.
  void go_back(const MotionPlace& place) { place_ = place; }
  /// Nobody comes back to a place before this one: gives its memory free. To be called now and
  /// then.
  void forget_before(const MotionPlace& place);
  /// Seconds to the standstill at the end of the plan in force.
  [[nodiscard]] double time_to_stop() const;
  /// Rounds of the last plan(), for measuring.
  [[nodiscard]] int rounds() const { return rounds_; }

 private:
  static constexpr int kMostNewCells = 150;

  struct Stop {
    std::uint64_t cell = 0;  ///< behind the last cell before it
    EndOfCells end;
    double length = 0.0;
    PathPlace place;  ///< where it begins
  };

  [[nodiscard]] CellX x_in_force(std::uint64_t index) const;
  [[nodiscard]] CellMotion motion_of(std::uint64_t index) const;
  [[nodiscard]] double duration_of(std::uint64_t index) const;
  [[nodiscard]] StandstillMotion start_motion() const;
  [[nodiscard]] StandstillMotion stop_motion() const;
  [[nodiscard]] double known_ahead() const;
  void enter_next_phase();

  bool plan_run();
  void begin_run();
  void cut();
  void push_cell(const SpeedCell& cell);
  [[nodiscard]] Stop stop_behind(const SpeedWindow& window) const;
  [[nodiscard]] std::optional<std::uint64_t> first_free() const;
  [[nodiscard]] std::uint64_t first_worth_changing() const;
  void guess(std::uint64_t first);
  [[nodiscard]] double guess_forward(std::uint64_t index, double x, double way) const;
  bool run_rounds(std::uint64_t first, int rounds);
  bool slow_down_until_kept(std::uint64_t first);
  void put_in_force(const Stop& stop);
  void drop_cells_behind_stop();

  bool plan_hold();
  void split_present_cell();
  void drop_behind(std::uint64_t count);
  [[nodiscard]] double distance_to_stop(std::uint64_t first) const;
  [[nodiscard]] double shortest_braking(std::uint64_t first) const;
  bool try_to_stop(std::uint64_t first);
  bool make_trial(std::uint64_t first);
  void guess_braking();
  void take_over_trial(std::uint64_t first);

  CellCutter cutter_;
  SpeedWindow window_;
  SpeedWindow trial_;     ///< of a hold
  PathPlace standstill_;  ///< where the run began or the next one begins
  double start_length_ = 0.0;
  std::uint64_t run_begin_ = 0;  ///< first cell of the run
  Stop stop_;                    ///< of the plan in force
  MotionPlace place_;
  double look_ahead_ = 0.0;     ///< longest distance in which feed is reached or left
  double stopping_time_ = 0.0;  ///< and the time for it
  double override_ = 1.0;
  bool held_ = false;
  bool changed_ = false;           ///< hold, resume or override since the last plan
  int new_cells_ = kMostNewCells;  ///< of the next plan
  int rounds_ = 0;
};

}  // namespace cnc::motion
