#include "motion/jog.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "motion/axis_ramp.h"

namespace cnc::motion {

namespace {

/// An axis this close to where it should stop has arrived; far below a step, above rounding. mm.
constexpr double kArrived = 1e-9;

}  // namespace

JogPlanner::JogPlanner(const AxisLimits& limits, double tick, const Position& start)
    : limits_(limits), tick_(std::clamp(tick, 0.0005, 0.1)), position_(start) {}

void JogPlanner::set_travel(Axis axis, const TravelRange& travel) { travel_[axis] = travel; }

Result<void> JogPlanner::check(Axis axis, double value, double speed) const {
  if (!std::isfinite(value) || !(speed > 0.0) || !std::isfinite(speed)) {
    return fail(ErrorCode::jog_value_unusable,
                fmt::format("Axis {} cannot be jogged by {} at a speed of {}; the speed must be "
                            "above 0.",
                            axis_name(axis), value, speed));
  }
  if (!(limits_.max_velocity[axis] > 0.0) || !(limits_.max_acceleration[axis] > 0.0)) {
    return fail(ErrorCode::jog_value_unusable,
                fmt::format("Axis {} cannot be jogged: it has no velocity and acceleration limit "
                            "above 0.",
                            axis_name(axis)));
  }
  return {};
}

Result<void> JogPlanner::set_velocity(Axis axis, double velocity) {
  const double limit = limits_.max_velocity[axis];
  if (velocity == 0.0) {
    orders_[axis] = {};
    return {};
  }
  if (auto good = check(axis, velocity, std::abs(velocity)); !good) return good;
  orders_[axis] = {std::clamp(velocity, -limit, limit), std::nullopt};
  return {};
}

Result<void> JogPlanner::move_to(Axis axis, double position, double speed) {
  if (auto good = check(axis, position, speed); !good) return good;
  const TravelRange& travel = travel_[axis];
  orders_[axis] = {std::min(speed, limits_.max_velocity[axis]),
                   std::min(std::max(position, travel.min), travel.max)};
  return {};
}

Result<void> JogPlanner::move_by(Axis axis, double distance, double speed) {
  return move_to(axis, orders_[axis].target.value_or(position_[axis]) + distance, speed);
}

void JogPlanner::stop() { orders_ = {}; }

void JogPlanner::go_back(const Position& position, const Position& velocity,
                         const Position& acceleration) {
  position_ = position;
  velocity_ = velocity;
  for (const Axis axis : kAllAxes) {
    acceleration_[axis] = limits_.max_jerk[axis] > 0.0 ? acceleration[axis] : 0.0;
  }
}

bool JogPlanner::standing() const { return velocity_ == Position{} && acceleration_ == Position{}; }

std::optional<Setpoint> JogPlanner::next() {
  const Position before = position_;
  const bool stood = standing();
  for (const Axis axis : kAllAxes) advance(axis);
  if (stood && standing() && position_ == before) return std::nullopt;
  Setpoint setpoint;
  setpoint.duration = tick_;
  setpoint.position = position_;
  setpoint.velocity = velocity_;
  return setpoint;
}

void JogPlanner::advance(Axis axis) {
  const Order& order = orders_[axis];
  double& p = position_[axis];
  double& v = velocity_[axis];
  const bool has_arrived = order.target ? *order.target == p : order.velocity == 0.0;
  if (v == 0.0 && acceleration_[axis] == 0.0 && has_arrived) return;

  const TravelRange& travel = travel_[axis];
  const bool upward = order.target.value_or(p + order.velocity) > p;
  const double top = order.target && upward ? std::min(*order.target, travel.max) : travel.max;
  const double bottom = order.target && !upward ? std::max(*order.target, travel.min) : travel.min;
  const double wanted = order.target && !upward ? -order.velocity : order.velocity;

  const double a = limits_.max_acceleration[axis];
  const AxisRamp ramp(a, limits_.max_jerk[axis], tick_);
  AxisState next = ramp.next({p, v, acceleration_[axis]}, wanted, {bottom, top});

  // The last tick of a stop leaves rounding behind; it must not become motion of its own.
  const double goal = next.velocity + v > 0.0 ? top : bottom;
  if (std::abs(next.position - goal) <= kArrived && ramp.nearly_stands(next)) {
    next = {goal, 0.0, 0.0};
  }
  p = next.position;
  v = next.velocity;
  acceleration_[axis] = next.acceleration;
}

bool JogPlanner::set_position(const Position& position) {
  if (!standing()) return false;
  for (const Axis axis : kAllAxes) {
    if (!std::isfinite(position[axis])) return false;
  }
  position_ = position;
  orders_ = {};
  return true;
}

}  // namespace cnc::motion
