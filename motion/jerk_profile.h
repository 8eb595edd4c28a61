// The profile within limits of jerk (docs/jerk.md): pieces become intervals of a JerkPlan, and its
// motion becomes setpoints.
//
// A setpoint is a cubic between two instants of the planned motion. Its jerk is a weighted mean of
// the motion's jerk between them (6 t (h − t)/h³ is its Peano kernel) and keeps that limit however
// long it is; acceleration and path are looked at, and the setpoint shortened until they are kept.
#pragma once

#include "motion/jerk_plan.h"
#include "motion/profile.h"

namespace cnc::motion {

/// The stretch [begin, begin + length] of a piece as the third-order plan sees it; of an arc no
/// more than kArcStep.
[[nodiscard]] PathInterval interval_of(const Piece& piece, double begin, double length);

/// Turning of an arc in one interval, radians: q'' changes linearly there instead of along a
/// circle, and is 1e-4 of itself too small in the middle.
inline constexpr double kArcStep = 0.03;

/// What a plan may use of the axes. None reaches its acceleration in less than a millisecond: an
/// axis without a limit of jerk, in a machine with such limits, does so in that time.
[[nodiscard]] JerkLimits jerk_limits(const AxisLimits& limits);

class JerkProfile final : public Profile {
 public:
  JerkProfile(const AxisLimits& limits, double max_duration, bool goes_back);

  [[nodiscard]] bool sufficient() const override { return !plan_.lacks_path(); }
  [[nodiscard]] bool well_stocked() const override { return !plan_.wants_path(); }
  bool extend() override;
  void append(const Piece& piece) override;
  void plan() override {}
  void stop_at_end() override;
  void set_overrides(const Overrides& overrides) override;
  void clear() override;

  [[nodiscard]] bool empty() const override { return plan_.idle(); }
  [[nodiscard]] bool standing() const override { return plan_.standing(); }
  void prepare(bool held) override;
  [[nodiscard]] std::optional<Setpoint> next(bool held) override;
  [[nodiscard]] std::optional<Stretch> skip() override;
  [[nodiscard]] Position position() const override { return position_at(plan_.motion().place); }
  [[nodiscard]] double time_to_end() const override;

  [[nodiscard]] ProfilePlace place() const override { return plan_.place(); }
  void go_back(const ProfilePlace& place) override;
  void forget_before(const ProfilePlace& place) override;
  [[nodiscard]] bool keeps_too_much(const ProfilePlace& oldest) const override;
  [[nodiscard]] bool can_keep_more(const ProfilePlace& oldest) const override;
  [[nodiscard]] bool can_go_on_alone() const override;
  void save() override { plan_.save(); }
  void revert(const ProfilePlace& place) override;

 private:
  /// An interval of the plan as a part of a piece.
  struct Part {
    std::uint64_t piece = 0;
    double begin = 0.0;  ///< on the piece's curve
  };

  void obey(bool held);
  [[nodiscard]] std::uint64_t cells_since(const MotionPlace& place) const;
  [[nodiscard]] const Piece& piece_of(std::uint64_t interval) const;
  [[nodiscard]] const Piece& piece_before(double time) const;
  [[nodiscard]] double place_on_curve(const PathPlace& place) const;
  [[nodiscard]] Position position_at(const PathPlace& place) const;
  [[nodiscard]] Setpoint setpoint_of(double duration) const;
  [[nodiscard]] Position acceleration_after(double time) const;
  [[nodiscard]] bool follows(const Setpoint& setpoint) const;
  [[nodiscard]] double longest_duration() const;
  [[nodiscard]] double shorter_than(double duration) const;
  [[nodiscard]] double without_sliver(double duration) const;
  [[nodiscard]] double time_to_end_of_cell() const;

  AxisLimits limits_;
  double max_duration_;
  JerkPlan plan_;
  Ring<Piece> pieces_;
  Ring<Part> parts_;  ///< one for each interval, with its index
  Overrides overrides_;
};

}  // namespace cnc::motion
