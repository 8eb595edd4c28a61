#include "motion/compensation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cnc::motion {
namespace {

/// The cubic through both ends of an added function: its acceleration against the function's own.
constexpr double kCubicAcceleration = 5.0 / 3.0;
/// The same for a velocity that does not change its sign (half of 3, at the middle), and for any.
constexpr double kOneWayVelocity = 1.5;
constexpr double kAnyVelocity = 2.0;

/// A motor has turned round when it is this far behind its furthest place, mm or degrees: far below
/// a step, far above rounding.
constexpr double kTurned = 1e-5;

/// What additions may use of a motor's limits at most; where they would need more, the axes that
/// cause it are slowed down.
constexpr double kLargestPart = 0.5;

/// A settling piece that is shorter than this is not worth one of its own, and one longer than the
/// other does not fit a segment. s.
constexpr double kShortestPiece = 0.001;
constexpr double kLongestPiece = 0.05;

}  // namespace

Compensation::Compensation(const CompensationSettings& settings)
    : settings_(settings), kinematics_(settings.motor_axes) {
  for (const Axis joint : kAllAxes) {
    const double velocity = settings_.joint_limits.max_velocity[joint] * settings_.backlash_share;
    const double acceleration =
        settings_.joint_limits.max_acceleration[joint] * settings_.backlash_share;
    state_.play[joint] = OffsetRamp(velocity / kOneWayVelocity, acceleration / kCubicAcceleration);
  }
  use_surface(nullptr);
}

/// Less the part for the play; then so slow that following the pitch takes no more than its part.
AxisLimits Compensation::motors_for_plan() const {
  AxisLimits limits = settings_.joint_limits;
  for (const Axis joint : kAllAxes) {
    double& velocity = limits.max_velocity[joint];
    double& acceleration = limits.max_acceleration[joint];
    if (settings_.backlash[joint] > 0.0) {
      velocity *= 1.0 - settings_.backlash_share;
      acceleration *= 1.0 - settings_.backlash_share;
    }
    const double slope = settings_.pitch[joint].steepest();
    const double bend = kCubicAcceleration * settings_.pitch[joint].most_curved();
    velocity /= 1.0 + kAnyVelocity * slope;
    if (bend * velocity * velocity > kLargestPart * acceleration)
      velocity = std::sqrt(kLargestPart * acceleration / bend);
    acceleration = (acceleration - bend * velocity * velocity) / (1.0 + kCubicAcceleration * slope);
  }
  return limits;
}

/// h(x, y) moves Z with h_x v_x + h_y v_y and accelerates it with
/// h_xx v_x² + 2 h_xy v_x v_y + h_yy v_y² + h_x a_x + h_y a_y.
AxisLimits Compensation::with_room_for_surface(AxisLimits limits) const {
  if (!surface_) return limits;
  const SurfaceBounds& most = surface_->bounds();
  const Position& v = limits.max_velocity;
  const Position& a = limits.max_acceleration;
  const double speed = most.slope_x * v[Axis::X] + most.slope_y * v[Axis::Y];
  const double acceleration =
      kCubicAcceleration *
      (most.bend_xx * v[Axis::X] * v[Axis::X] + 2.0 * most.bend_xy * v[Axis::X] * v[Axis::Y] +
       most.bend_yy * v[Axis::Y] * v[Axis::Y] + most.slope_x * a[Axis::X] +
       most.slope_y * a[Axis::Y]);
  // The cubic has the right velocity at both ends, and its acceleration is bounded in between.
  const double velocity = speed + std::min(speed, 0.5 * acceleration * settings_.longest_setpoint);
  if (velocity == 0.0) return limits;
  const double slower = std::min({1.0, kLargestPart * v[Axis::Z] / velocity,
                                  std::sqrt(kLargestPart * a[Axis::Z] / acceleration)});
  for (const Axis axis : {Axis::X, Axis::Y}) {
    limits.max_velocity[axis] *= slower;
    limits.max_acceleration[axis] *= slower * slower;
  }
  limits.max_velocity[Axis::Z] -= velocity * slower;
  limits.max_acceleration[Axis::Z] -= acceleration * slower * slower;
  return limits;
}

double Compensation::reach(Axis joint) const {
  return settings_.backlash[joint] + settings_.pitch[joint].largest();
}

HeightSurface::Value Compensation::surface_at(const Position& machine) const {
  return surface_ ? surface_->at(machine[Axis::X], machine[Axis::Y]) : HeightSurface::Value{};
}

Compensation::Joints Compensation::joints_for(const Position& position,
                                              const Position& velocity) const {
  const HeightSurface::Value surface = surface_at(position);
  Position raised = position;
  Position raised_velocity = velocity;
  raised[Axis::Z] += surface.height + state_.entering.value();
  raised_velocity[Axis::Z] += surface.slope_x * velocity[Axis::X] +
                              surface.slope_y * velocity[Axis::Y] + state_.entering.velocity();
  return {kinematics_.joints_at(raised), kinematics_.joint_velocity(raised_velocity)};
}

void Compensation::follow_direction(Axis joint, double position) {
  double& turning = state_.turning[joint];
  bool& downward = state_.downward[joint];
  const double behind = downward ? position - turning : turning - position;
  if (behind > kTurned) downward = !downward;
  if (behind > kTurned || behind < 0.0) turning = position;
  state_.play[joint].go_to(downward ? -settings_.backlash[joint] : 0.0);
}

Setpoint Compensation::motors_for(const Setpoint& machine, const Joints& joints) const {
  Setpoint motors = machine;
  for (const Axis joint : kAllAxes) {
    const PitchCurve::Value pitch = settings_.pitch[joint].at(joints.position[joint]);
    const OffsetRamp& play = state_.play[joint];
    motors.position[joint] = joints.position[joint] + pitch.correction + play.value();
    motors.velocity[joint] = joints.velocity[joint] * (1.0 + pitch.slope) + play.velocity();
  }
  return motors;
}

Setpoint Compensation::apply(const Setpoint& machine) {
  state_.machine = machine.position;
  state_.entering.advance(machine.duration);
  const Joints joints = joints_for(machine.position, machine.velocity);
  for (const Axis joint : kAllAxes) {
    if (settings_.backlash[joint] == 0.0) continue;
    follow_direction(joint, joints.position[joint]);
    state_.play[joint].advance(machine.duration);
  }
  return motors_for(machine, joints);
}

std::optional<Setpoint> Compensation::settle() {
  double piece = std::numeric_limits<double>::infinity();
  const auto look_at = [&piece](const OffsetRamp& ramp) {
    if (!ramp.arrived()) piece = std::min(piece, std::max(ramp.phase(), kShortestPiece));
  };
  for (const Axis joint : kAllAxes) look_at(state_.play[joint]);
  look_at(state_.entering);
  if (std::isinf(piece)) return std::nullopt;
  Setpoint standing;
  standing.duration = std::min(piece, kLongestPiece);
  standing.position = state_.machine;
  return apply(standing);
}

void Compensation::use_surface(std::shared_ptr<const HeightSurface> surface) {
  const double before = surface_at(state_.machine).height + state_.entering.value();
  surface_ = std::move(surface);
  machine_limits_ = with_room_for_surface(kinematics_.machine_limits(motors_for_plan()));
  // Nothing else moves Z meanwhile.
  state_.entering = OffsetRamp(machine_limits_.max_velocity[Axis::Z] / kOneWayVelocity,
                               machine_limits_.max_acceleration[Axis::Z] / kCubicAcceleration);
  state_.entering.put(before - surface_at(state_.machine).height);
  state_.entering.go_to(0.0);
}

Position Compensation::machine_at(const Position& motors, const State& state) const {
  Position joints;
  for (const Axis joint : kAllAxes)
    joints[joint] = settings_.pitch[joint].undone(motors[joint] - state.play[joint].value());
  Position machine = kinematics_.machine_at(joints);
  machine[Axis::Z] -= surface_at(machine).height + state.entering.value();
  return machine;
}

Position Compensation::motors_at(const Position& machine) const {
  Setpoint standing;
  standing.position = machine;
  return motors_for(standing, joints_for(machine, {})).position;
}

void Compensation::accept(const Position& motors, const Position& tolerance) {
  state_.entering.put(0.0);
  Position joints;
  for (const Axis joint : kAllAxes) {
    state_.play[joint].put(state_.play[joint].value());
    joints[joint] = settings_.pitch[joint].undone(motors[joint] - state_.play[joint].value());
  }
  kinematics_.accept(joints, tolerance);
  state_.turning = joints;
  state_.machine = machine_at(motors);
}

}  // namespace cnc::motion
