// The planned part of the path, and where on it the machine is.
//
// Curves are appended, joined at their junctions, cut into steps (step.h), and planned backward so
// that each step knows with which speed it may be entered; the sampler walks along. The plan always
// ends in a standstill at the end of what has been appended, whatever is added later. Steps behind
// the machine stay until they are forgotten, so that it can be sent back to a place at which it
// was; the path up to the furthest such place never changes.
//
// Memory is fixed: a curve of very many steps (a helix with ten thousand turns) is cut into steps
// as room becomes free. Appending costs amortised constant time: the backward pass stops where
// nothing changes any more. Only append() and the constructor allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "motion/leg.h"
#include "motion/limits.h"
#include "motion/overrides.h"
#include "motion/piece.h"
#include "motion/ring.h"
#include "motion/step.h"

namespace cnc::motion {

/// Where the machine is: `done` mm inside step number `step`, at `speed` = ds/dt.
struct Place {
  std::uint64_t step = 0;
  double done = 0.0;
  double speed = 0.0;
  /// On a curve, what is left of the leg that it is on; of no length between two legs. Whoever
  /// samples a leg in parts goes along it to its end, so that the motion does not depend on the
  /// sampling. On a straight line it does not anyway.
  Leg rest;
  std::uint32_t plan = 0;  ///< number of the overrides for which the leg was chosen
};

/// Most steps planned ahead of the machine, and most that a caller may leave unforgotten behind it.
inline constexpr std::size_t kMostStepsAhead = 8192;
inline constexpr std::size_t kMostStepsBehind = 8192;

class Track {
 public:
  explicit Track(const AxisLimits& limits, std::size_t steps_behind = 0);

  [[nodiscard]] const AxisLimits& limits() const { return limits_; }

  /// Nothing is left to be driven.
  [[nodiscard]] bool empty() const { return at_end(place_); }
  /// True when a whole braking distance and more is planned, or memory is used up.
  [[nodiscard]] bool sufficient() const;
  /// True when there is some more, so that it pays to come back later with many curves at once.
  [[nodiscard]] bool well_stocked() const;
  /// Cuts what waits of the last curve into steps until well_stocked(); true when none is left.
  /// They are planned with the next call of plan().
  bool extend();
  /// Appends a curve that begins where the last one ends. Only after extend() returned true.
  void append(const Piece& piece);
  /// Appends a span of a smoothed path, which goes on smoothly from the span before it or begins
  /// where the machine stands. Planned only with the next call of plan(), for many at once.
  void append_span(const Piece& piece);
  void plan() { plan_backward(steps_.end()); }
  /// The machine shall stand still at the present end, whatever comes.
  void stop_at_end();

  void set_overrides(const Overrides& overrides);

  [[nodiscard]] const Place& place() const { return place_; }
  /// Moves the machine on.
  void advance(const Place& place);
  /// Drops the steps before number `step`, which the machine has passed; everything once it stands
  /// at the end and no step is left.
  void forget_before(std::uint64_t step);
  /// Sends the machine back to a place at which it was and whose step is not forgotten.
  void go_back(const Place& place);
  /// Whether the machine has been further along than it is.
  [[nodiscard]] bool was_further() const;
  /// Moves on within the present piece as far as what may still be appended does not matter, and at
  /// least for a while; the seconds that takes, 0 when it stands.
  double skip();
  void clear();

  [[nodiscard]] const Step& step(std::uint64_t index) const { return steps_[index]; }
  [[nodiscard]] const Piece& last_piece() const { return pieces_.back(); }
  [[nodiscard]] const Piece& piece_at(const Place& place) const;
  [[nodiscard]] Position position_at(const Place& place) const;
  [[nodiscard]] Position velocity_at(const Place& place) const;

  [[nodiscard]] bool at_end(const Place& place) const { return place.step == steps_.end(); }
  /// The next stretch of motion from a place, and the place `length` mm further inside it.
  [[nodiscard]] std::optional<Leg> leg_from(const Place& place, bool braking) const;
  [[nodiscard]] Place behind(const Place& place, const Leg& leg) const;
  [[nodiscard]] Place inside(const Place& place, const Leg& leg, double time) const;

  /// Seconds to the end of the plan from the present place; walks over all steps.
  [[nodiscard]] double time_to_end() const;
  /// Length of what has been appended but not yet cut into steps.
  [[nodiscard]] double unplanned_length() const;

 private:
  enum class Until : std::uint8_t { well_stocked, end };

  void push(const Piece& piece, bool stop_before);
  void push_unplanned(const Piece& piece, bool stop_before);
  void cut_into_steps(Until until);
  void pop_last_piece();
  void push_step(std::uint64_t piece_index, double length, bool stop_before);
  void set_end_of_last(double end);
  [[nodiscard]] double free_before_end() const;
  [[nodiscard]] bool append_blended(const Piece& piece, double cut);
  void apply_feed(Step& step, const Piece& piece) const;
  void plan_backward(std::uint64_t end);
  [[nodiscard]] double entry_limit(std::uint64_t index, double Step::*limit) const;
  [[nodiscard]] Exit exit_of(std::uint64_t index) const;
  [[nodiscard]] bool place_is_safe() const;
  [[nodiscard]] double known_way() const;
  [[nodiscard]] bool steps_are_many() const;

  AxisLimits limits_;
  Position per_velocity_;      // 1 / limit
  Position per_acceleration_;  // likewise
  Overrides overrides_;
  std::uint32_t plan_ = 0;  // counts the changes of the overrides
  Ring<Piece> pieces_;
  Ring<Step> steps_;
  Place place_;
  Place furthest_;  ///< since clear(); up to here the path has been driven and stays as it is
  double look_ahead_ = 0.0;  ///< mm; enough for the fastest curve since the last standstill
};

}  // namespace cnc::motion
