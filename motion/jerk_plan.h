// The fastest motion along a path within velocity, acceleration and jerk of every axis, from
// standstill to standstill, planned while the path is still arriving and while the motion runs.
//
// The path comes as intervals (path_interval.h), is cut into cells (cell_cutter.h), and x(u) over
// them is improved in rounds (speed_window.h). A run is what lies between two standstills. The plan
// in force keeps every limit and ends in a standstill on the known path, always: a better or longer
// one takes its place only when it is finished and keeps them too. If that fails, the motion stops
// where the plan in force ends and goes on from there.
//
// Memory is fixed at construction, but for the first save(). A call of plan() costs at most a fixed
// number of rounds over the cells ahead of the place. Units: mm, s, degrees for rotary axes. Not
// thread-safe.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "motion/cell_cutter.h"
#include "motion/cell_motion.h"
#include "motion/speed_window.h"

namespace cnc::motion {

/// Where the motion is: a value that a caller may keep with each setpoint, to come back to it.
/// Ordered along the motion.
struct MotionPlace {
  enum class Phase : std::uint8_t { starting, driving, stopping, standing };
  std::uint64_t run = 0;  ///< standing: the one that has ended
  Phase phase = Phase::standing;
  std::uint64_t cell = 0;
  double time = 0.0;  ///< since the phase or the cell began

  auto operator<=>(const MotionPlace&) const = default;
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
  /// With room for so many cells, and as many intervals, ahead of the motion and behind it. How far
  /// it plans does not depend on what lies behind.
  explicit JerkPlan(const JerkLimits& limits, std::size_t ahead = 4096, std::size_t behind = 0);
  ~JerkPlan();
  JerkPlan(JerkPlan&&) noexcept;
  JerkPlan& operator=(JerkPlan&&) noexcept;

  /// Whether more path is of use, and there is room for it.
  [[nodiscard]] bool wants_path() const;
  /// Whether plan() would do better with more path than there is.
  [[nodiscard]] bool lacks_path() const;
  /// Whether what is known suffices for a change of overrides.
  [[nodiscard]] bool knows_enough() const;
  [[nodiscard]] bool has_room() const;
  void append(const PathInterval& interval);
  /// The motion has to stand at the present end of the path, whatever follows.
  void stop_at_end() { cutter_.stop_at_end(); }

  /// Whether plan() would have enough to do.
  [[nodiscard]] bool due() const;
  /// Plans what has been appended or changed. False when no better plan was found: the one in force
  /// goes on, and due() asks for the next attempt after a while.
  bool plan();

  /// Each factor 0.001 … 10; acts with the next plan().
  void set_overrides(const Overrides& factors);
  /// Stops as soon as the limits allow with the next plan(), and stays there until resume().
  void hold();
  void resume();
  [[nodiscard]] bool held() const { return held_; }

  [[nodiscard]] const MotionPlace& place() const { return place_; }
  [[nodiscard]] bool standing() const { return place_.phase == MotionPlace::Phase::standing; }
  /// Everything is driven.
  [[nodiscard]] bool idle() const { return standing() && !path_left(); }
  [[nodiscard]] PathMotion motion() const { return motion_at(place_); }
  [[nodiscard]] PathMotion motion_at(const MotionPlace& place) const;
  [[nodiscard]] const Ring<PathInterval>& intervals() const { return cutter_.intervals(); }

  /// Time until the present cell or phase ends; 0 when standing.
  [[nodiscard]] double time_in_cell() const { return time_in_cell(place_); }
  [[nodiscard]] double time_in_cell(const MotionPlace& place) const;
  /// Where it will be after the present cell or phase, and after `time`, by the plan in force.
  [[nodiscard]] MotionPlace behind_cell(const MotionPlace& place) const;
  [[nodiscard]] MotionPlace after(MotionPlace place, double time) const;
  /// Moves on along the plan in force.
  void advance(double time) { advance_to(after(place_, time)); }
  void advance_to(const MotionPlace& place);
  /// Back to a place that was not forgotten. What is planned then replaces all that followed.
  void go_back(const MotionPlace& place);
  /// Nobody comes back to a place before this one: gives its memory free. To be called now and
  /// then.
  void forget_before(const MotionPlace& place);
  /// Seconds to the standstill at the end of the present run, by the plan in force.
  [[nodiscard]] double time_to_stop() const;
  /// Where the path is planned up to.
  [[nodiscard]] const PathPlace& planned_end() const { return run().end; }
  /// Where the motion is or, standing, would begin.
  [[nodiscard]] PathPlace next_place() const { return cutter_.behind(motion().place, 0.0); }
  /// Forgets the path; standing only.
  void clear();

  /// Keeps the plan in force, and puts it back; what was wanted meanwhile (hold, overrides) is
  /// still wanted, and what was appended is kept.
  void save();
  void restore();

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
  /// From standstill to standstill.
  struct Run {
    std::uint64_t begin = 0;  ///< first cell
    PathPlace from;
    double start_length = 0.0;
    double most_start_x = 0.0;
    Stop stop;
    PathPlace end;
    std::uint64_t shaped_from = 0;  ///< first cell that would be driven faster on a longer path
    double start_speed = 0.0;
    double stop_speed = 0.0;

    [[nodiscard]] StandstillMotion start() const { return {start_length, start_speed}; }
    [[nodiscard]] StandstillMotion halt() const { return {stop.length, stop_speed}; }
  };
  struct Saved;

  [[nodiscard]] const Run& run_of(const MotionPlace& place) const { return runs_[place.run]; }
  [[nodiscard]] Run& run() { return runs_.back(); }
  [[nodiscard]] const Run& run() const { return runs_.back(); }
  [[nodiscard]] bool in_last_run() const { return place_.run + 1 == runs_.end(); }
  [[nodiscard]] CellX x_in_force(std::uint64_t index, const Run& run) const;
  [[nodiscard]] CellMotion motion_of(std::uint64_t index, const Run& run) const;
  [[nodiscard]] double duration_of(std::uint64_t index, const Run& run) const;
  [[nodiscard]] bool path_left() const;
  [[nodiscard]] double known_ahead() const;
  [[nodiscard]] std::uint64_t first_interval_of(const MotionPlace& place) const;
  [[nodiscard]] std::size_t free_cells() const;
  [[nodiscard]] bool takes_intervals() const;
  [[nodiscard]] double distance_of(std::uint64_t index) const;
  void begin_at_standstill();
  void look_at(const PathInterval& interval);

  bool plan_run();
  bool try_plan_run(bool from_rest);
  void begin_run();
  void begin_next_run();
  void drop_last_run();
  void drop_later_runs();
  void cut();
  void push_cell(const SpeedCell& cell);
  [[nodiscard]] Stop stop_behind(const SpeedWindow& window) const;
  [[nodiscard]] std::optional<std::uint64_t> first_free() const;
  [[nodiscard]] std::uint64_t first_shaped_by_stop() const;
  void guess(std::uint64_t first);
  [[nodiscard]] double guess_forward(std::uint64_t index, double x, double way) const;
  bool run_rounds(std::uint64_t first, int rounds);
  bool slow_down_until_kept();
  void flatten();
  void put_in_force(const Stop& stop);
  void end_run_at(const Stop& stop);
  void drop_cells_behind_stop();

  bool plan_hold();
  void split_present_cell();
  void drop_behind(std::uint64_t count);
  [[nodiscard]] double distance_to_stop(std::uint64_t first) const;
  [[nodiscard]] double shortest_braking(std::uint64_t first) const;
  [[nodiscard]] Usage try_to_stop(std::uint64_t first, double distance);
  bool make_trial(std::uint64_t first, double distance);
  void guess_braking(std::uint64_t first);
  void take_over_trial(std::uint64_t first);

  std::size_t most_ahead_;
  CellCutter cutter_;
  SpeedWindow window_;  ///< of the last run; the cells of earlier ones lie before it
  SpeedWindow trial_;   ///< of a hold
  Ring<Run> runs_;
  MotionPlace place_;
  double look_ahead_ = 0.0;  ///< longest distance in which the last run's feed is reached or left
  Overrides overrides_;
  bool held_ = false;
  bool changed_ = false;             ///< hold, resume or override since the last plan
  std::uint64_t retry_at_cell_ = 0;  ///< no attempt before, the last one having failed
  int new_cells_ = kMostNewCells;    ///< of the next plan
  int rounds_ = 0;
  std::unique_ptr<Saved> saved_;
};

}  // namespace cnc::motion
