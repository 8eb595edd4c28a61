// From planned setpoints of the machine's axes to setpoints of its motors: the last stage before
// the link (MOT-5).
//
//   machine ── + height map on Z ── kinematics ── + pitch ── + backlash ──► motors
//
// Nothing jumps. The height map and the pitch tables are smooth functions of position, so velocity
// stays continuous; play is taken up by a ramp of its own that begins at the reversal. What these
// additions may need of a motor's velocity and acceleration at most is kept back from the planner
// (machine_limits()), so that the sum keeps the motor's limits:
//
// A setpoint's cubic repeats what is added only at its two ends. For any function f its cubic has
// an acceleration of ∫ f''(s) (4h − 6s)/h² ds at its start, and the like at its end, which is
// 5/3 max|f''| at most. That bound needs no assumption, and is what is kept back.
//
// Not thread-safe; apply() and settle() allocate nothing.
#pragma once

#include <memory>
#include <optional>

#include "config/axis.h"
#include "motion/height_surface.h"
#include "motion/kinematics.h"
#include "motion/limits.h"
#include "motion/offset_ramp.h"
#include "motion/pitch_curve.h"
#include "motion/setpoint.h"

namespace cnc::motion {

struct CompensationSettings {
  AxisLimits joint_limits{};
  MotorAxes motor_axes = kOwnAxes;
  Position backlash{};           ///< of each motor, >= 0
  double backlash_share = 0.25;  ///< of a motor's limits, for taking up its play
  AxisArray<PitchCurve> pitch{};
  double longest_setpoint = 0.005;  ///< s
};

class Compensation {
 public:
  explicit Compensation(const CompensationSettings& settings);

  /// What the planner may use so that the motors keep their limits, with the surface in force.
  [[nodiscard]] const AxisLimits& machine_limits() const { return machine_limits_; }
  /// How far beyond the travel of its axis a motor may be moved by backlash and pitch.
  [[nodiscard]] double reach(Axis joint) const;

  /// The motors' setpoint for the machine's next one.
  [[nodiscard]] Setpoint apply(const Setpoint& machine);
  /// While the machine stands: what remains to be added, piece by piece; nothing when all is.
  [[nodiscard]] std::optional<Setpoint> settle();

  /// Standing: the surface that is added to Z from now on, none to end it. The motors do not move
  /// by this; settle() brings Z to its new place.
  void use_surface(std::shared_ptr<const HeightSurface> surface);
  [[nodiscard]] const HeightSurface* surface() const { return surface_.get(); }

  /// All that changes from setpoint to setpoint, to go back to one of them.
  struct State {
    Position machine;
    AxisArray<OffsetRamp> play;
    AxisArray<bool> downward;  ///< last direction of the motor
    Position turning;          ///< furthest place of the motor in that direction
    OffsetRamp entering;       ///< what is left of Z's way onto or off the surface
  };
  [[nodiscard]] const State& state() const { return state_; }
  void restore(const State& state) { state_ = state; }

  /// Where the machine is when its motors are there, in the present state or an earlier one.
  [[nodiscard]] Position machine_at(const Position& motors) const {
    return machine_at(motors, state_);
  }
  [[nodiscard]] Position machine_at(const Position& motors, const State& state) const;
  /// What the motors have to count when the machine stands here.
  [[nodiscard]] Position motors_at(const Position& machine) const;
  [[nodiscard]] const Kinematics& kinematics() const { return kinematics_; }
  /// The machine stands, its motors at `motors`, where nobody planned it; a slave that is off by
  /// more than `tolerance` keeps that.
  void accept(const Position& motors, const Position& tolerance);

 private:
  struct Joints {
    Position position;
    Position velocity;
  };
  [[nodiscard]] Joints joints_for(const Position& position, const Position& velocity) const;
  [[nodiscard]] HeightSurface::Value surface_at(const Position& machine) const;
  [[nodiscard]] AxisLimits motors_for_plan() const;
  [[nodiscard]] AxisLimits with_room_for_surface(AxisLimits limits) const;
  void follow_direction(Axis joint, double position);
  [[nodiscard]] Setpoint motors_for(const Setpoint& machine, const Joints& joints) const;

  CompensationSettings settings_;
  Kinematics kinematics_;
  std::shared_ptr<const HeightSurface> surface_;
  AxisLimits machine_limits_;
  State state_;
};

}  // namespace cnc::motion
