#include "motion/jog.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace cnc::motion {

namespace {

/// An axis this close to where it should stop has arrived; far below a step, above rounding. mm.
constexpr double kArrived = 1e-9;

/// Largest velocity v' >= 0 that an axis may have at the end of this tick, when it may travel
/// `room` further, now moves at v, and later brakes with one constant acceleration of at most a per
/// tick.
///
/// A stop from v' = (m + r) aT with 0 <= r < 1 takes m ticks at a and one for the rest, over
/// aT² (m (m + 2r)/2 + r/2); together with the tick (v + v') T/2 that lies ahead the room needed is
/// vT/2 + aT² ((m + 1)(m + r) − m (m + 1)/2). That is continuous and piecewise linear in v', and at
/// r = 0 it is aT² m (m + 1)/2, which gives m for the room that there is.
double fastest_with_room(double room, double v, double a, double tick) {
  if (std::isinf(room)) return room;
  const double free = room - 0.5 * v * tick;
  if (free <= 0.0) return 0.0;
  const double units = free / (a * tick * tick);
  const double m = std::floor(0.5 * (std::sqrt(1.0 + 8.0 * units) - 1.0));
  return (free / tick + 0.5 * m * (m + 1.0) * a * tick) / (m + 1.0);
}

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

void JogPlanner::go_back(const Position& position, const Position& velocity) {
  position_ = position;
  velocity_ = velocity;
}

bool JogPlanner::standing() const { return velocity_ == Position{}; }

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
  Order& order = orders_[axis];
  double& p = position_[axis];
  double& v = velocity_[axis];
  if (order.target == p && v == 0.0) order = {};
  if (v == 0.0 && order.velocity == 0.0) return;

  const TravelRange& travel = travel_[axis];
  const bool upward = order.target.value_or(p + order.velocity) > p;
  const double top = order.target && upward ? std::min(*order.target, travel.max) : travel.max;
  const double bottom = order.target && !upward ? std::max(*order.target, travel.min) : travel.min;
  const double wanted = order.target && !upward ? -order.velocity : order.velocity;

  const double a = limits_.max_acceleration[axis];
  const double fastest_up = fastest_with_room(top - p, v, a, tick_);
  const double fastest_down = fastest_with_room(p - bottom, -v, a, tick_);
  const double within = std::min(std::max(wanted, -fastest_down), fastest_up);
  double next_v = std::clamp(within, v - a * tick_, v + a * tick_);
  double next_p = p + 0.5 * (v + next_v) * tick_;

  // The last tick of a stop leaves rounding behind; it must not become motion of its own.
  const double goal = next_v + v > 0.0 ? top : bottom;
  if (std::abs(next_p - goal) <= kArrived && std::abs(next_v) <= 1e-6 * a * tick_) {
    next_p = goal;
    next_v = 0.0;
  }
  p = next_p;
  v = next_v;
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
