#include "server/machine/manual_motion.h"

#include <utility>

namespace cnc::server {

ManualMotion::ManualMotion(const config::MachineConfig& config, MotionFeed& feed)
    : config_(config), feed_(feed), planner_(planner_at_rest()) {}

motion::JogPlanner ManualMotion::planner_at_rest() const {
  return {feed_.limits(), config_.trajectory.interpolation_time, feed_.commanded()};
}

void ManualMotion::begin(const AxisArray<bool>& limited) {
  drop();
  const motion::Extents travel = feed_.travel(limited);
  for (const Axis axis : kAllAxes) planner_.set_travel(axis, {travel.min[axis], travel.max[axis]});
  feed_.begin_motion(limited);
}

void ManualMotion::drop() {
  planner_ = planner_at_rest();
  apply_wanted_ = false;
  error_.reset();
}

Result<void> ManualMotion::set_velocity(Axis axis, double velocity) {
  return planner_.set_velocity(axis, velocity);
}

/// Where an axis that follows a velocity comes to the end of what is planned says nothing to
/// whoever gives a step.
Result<void> ManualMotion::move_by(Axis axis, double distance, double speed) {
  return planner_.follows_velocity(axis)
             ? planner_.move_to(axis, feed_.board().position[axis] + distance, speed)
             : planner_.move_by(axis, distance, speed);
}

void ManualMotion::stop() { planner_.stop(); }

void ManualMotion::apply() {
  apply_wanted_ = feed_.cut_answer() == CutAnswer::pending;
  if (apply_wanted_) return;
  if (const std::size_t count = feed_.replaceable(); count > 0) cut(count);
}

void ManualMotion::cut(std::size_t count) {
  feed_.begin_cut(count);
  planner_.go_back(feed_.commanded(), feed_.end_velocity(), feed_.end_acceleration());
  draw();
  feed_.commit_cut();
}

void ManualMotion::draw() {
  while (!error_ && feed_.wants_more()) {
    const auto setpoint = planner_.next();
    if (!setpoint) return;
    if (auto sent = feed_.emit(*setpoint); !sent) error_ = std::move(sent.error());
  }
}

Result<void> ManualMotion::cycle() {
  if (feed_.cut_answer() == CutAnswer::late) cut(feed_.replaceable());
  if (feed_.cut_answer() == CutAnswer::pending) return {};
  if (apply_wanted_) apply();
  draw();
  if (error_) return std::unexpected(*std::exchange(error_, std::nullopt));
  return {};
}

}  // namespace cnc::server
