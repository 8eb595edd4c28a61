// From moves to setpoints: look-ahead, velocity profile and sampling.
//
// The planner takes moves in machine coordinates, keeps them as exact curves, plans the fastest
// speed along them that keeps every axis within its limits of velocity, acceleration and, where
// set, jerk, and hands out setpoints one after the other. It has no thread, no clock and no I/O:
// the caller adds moves until full(), then draws setpoints; whatever is queued is always planned to
// a standstill at its end, so running dry is a stop, never a fault.
//
// Inside: moves wait in line, are simplified and smoothed (docs/path.md), and become pieces of a
// Profile (profile.h) as far ahead as planning needs them.
//
// Units: mm, s, degrees for rotary axes. Not thread-safe. Memory is reused: next() allocates only
// when a smoothed run, or a batch of moves, is longer than any before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "config/axis.h"
#include "config/error.h"
#include "motion/curve.h"
#include "motion/limits.h"
#include "motion/overrides.h"
#include "motion/setpoint.h"

namespace cnc::motion {

class Profile;

struct PlannerSettings {
  AxisLimits limits;
  double max_setpoint_duration = 0.005;  ///< InterpolationTime, s; 0.0005 … 0.1
  double laf_angle = 1.0;                ///< junctions below this angle are not stopped at, degrees
  double tolerance_use = 1.0;            ///< part of MoveOptions::tolerance that is used, 0 … 1
  std::size_t most_taken_back = 0;       ///< setpoints kept for take_back()
};

struct MoveOptions {
  MoveKind kind = MoveKind::feed;
  double feed =
      0.0;  ///< programmed feed along the path, mm/s (deg/s for rotary-only); unused for rapids
  Override override = Override::feed;  ///< of a feed move
  bool stop_at_end = false;            ///< exact stop (G61.1) after this move
  double tolerance = 0.0;              ///< mm the path may leave the move by (G64 P); 0: exact path
  double simplify = 0.0;               ///< mm within which short lines may become one (Q); 0: never
  std::optional<double> laf_angle;     ///< overrides the setting, degrees
  MoveTag tag;
};

/// Positions beyond this (mm or degrees), faster feeds (per second) and more turns are refused.
inline constexpr double kLargestCoordinate = 1e7;
inline constexpr double kLargestFeed = 1e6;
inline constexpr std::int32_t kMostTurns = 1'000'000;

/// Whether the caller has more moves than it has added so far.
enum class Supply : std::uint8_t {
  ended,   ///< no, or none before the machine has come to rest
  coming,  ///< yes, they are only not known yet
};

class Planner {
 public:
  Planner(const PlannerSettings& settings, const Position& start);
  /// With another profile than the one that `settings` ask for: whatever takes the path.
  Planner(const PlannerSettings& settings, const Position& start, std::unique_ptr<Profile> profile);
  ~Planner();
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;

  /// Appends a straight move / an arc from the end of what is queued. Moves of zero length (below a
  /// nanometre) are accepted and vanish. Refused (and nothing queued) for NaN or infinite numbers,
  /// a feed that is not positive, an axis without limits that would move, a radius mismatch of the
  /// arc, or when a caller that does not ask full() has queued far too much.
  Result<void> add_line(const Position& end, const MoveOptions& options);
  Result<void> add_arc(const ArcShape& arc, const MoveOptions& options);

  /// True when enough path is queued for the present speed limits: adding more brings nothing.
  [[nodiscard]] bool full() const;
  /// Nothing queued and standing still.
  [[nodiscard]] bool idle() const;

  /// The next piece of motion; nothing when idle, or when held and standing still. With a supply
  /// that has ended before the planner is full() the smoothed path is closed exactly where the
  /// moves end; while more is coming it stays open, and the machine stands still before its end if
  /// it has to.
  [[nodiscard]] std::optional<Setpoint> next(Supply supply = Supply::ended);

  /// Goes on without setpoints, for predictions, to the end of a stretch of one move. It moves on
  /// along the very plan that next() samples.
  [[nodiscard]] std::optional<Stretch> skip(Supply supply = Supply::ended);

  /// Operator's overrides as factors; they act from the next setpoint on. Feed 0 … 3, 0 stops along
  /// the path like hold(); rapid 0 … 1; of the spindle's speed 0 … 3. Values outside are brought
  /// inside. A change costs one pass over the planned steps, half a millisecond at most; with
  /// limits of jerk a new plan with the next setpoint, some milliseconds.
  void set_overrides(double feed, double rapid, double speed = 1.0);
  /// An override is 0: next() may give nothing although moves are waiting.
  [[nodiscard]] bool barred() const;
  /// Brakes along the path as hard as the limits allow; next() ends when standing still.
  void hold();
  void resume();
  [[nodiscard]] bool held() const;

  // Re-planning what the controller has not begun. A change of overrides, hold() and resume() act
  // from the next setpoint on; drawn ones that wait in a FIFO can be taken back first, and are then
  // drawn anew along the very same path:
  //
  //   take_back(n), hold() … ─► next() … ─► confirm_take_back()   the controller has dropped the n
  //                                      └► revoke_take_back()    it was too late: they are
  //                                      executed
  //
  // Until it is known which, next() takes in nothing that was added since, and goes no further
  // along the path than it has been, or than is planned well ahead; but it gives a tenth of a
  // second, or all until a standstill, in any case.

  /// Whether setpoints can be taken back at all, and how many.
  [[nodiscard]] bool keeps_setpoints() const;
  [[nodiscard]] std::size_t known() const;
  /// False when the next setpoint would make the oldest of them be forgotten, for want of room.
  [[nodiscard]] bool can_keep_more() const;
  /// Only the last `count` setpoints may still be taken back.
  void forget_all_but(std::size_t count);
  /// The state is again as it was before the last `count` setpoints were drawn. False, and nothing
  /// changed, when they are not known any more, or not known yet whether an earlier call holds.
  bool take_back(std::size_t count);
  void confirm_take_back();
  /// What was drawn since is void; what was taken back counts again.
  void revoke_take_back();

  /// Drops everything that is queued. Only when standing still (after hold() or when idle): returns
  /// false and does nothing otherwise.
  bool clear();

  /// Where the next move would start from, and where the last setpoint ended.
  [[nodiscard]] const Position& queue_end() const;
  [[nodiscard]] const Position& position() const;
  /// Seconds of motion still queued, without the moves of a smoothed run that is still open, at the
  /// present overrides (for progress and prediction). Exact for what is planned, an upper bound for
  /// moves that still wait (with limits of jerk an estimate); infinite when an override of 0 bars
  /// the way. Walks over the whole queue: for a display's rate, not for every setpoint.
  [[nodiscard]] double queued_time() const;

  /// Standing still only: the machine was moved by other means (homing, jog, hand). Refused while
  /// anything is queued, and for numbers that are not finite.
  bool set_position(const Position& position);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cnc::motion
