#include "server/machine/jog_control.h"

#include <algorithm>
#include <utility>

#include "server/job/settings.h"

namespace cnc::server {
namespace {

/// Seconds of motion under way while jogging: what a step waits for. Far below FifoTime, far above
/// the jitter of a busy computer.
constexpr double kLead = 0.06;
/// Part of the maximum velocity that is allowed before homing, when homing is mandatory (STA-5).
constexpr double kUnhomedRate = 0.05;

}  // namespace

JogControl::JogControl(const config::MachineConfig& config, MotionFeed& feed)
    : config_(config),
      feed_(feed),
      planner_(feed.limits(), config.trajectory.interpolation_time, Position{}) {}

/// The first command of a motion: from where the machine stands, within the travel of axes that
/// were homed: that of one in doubt is still about right.
void JogControl::begin(const PositionTrust& trust) {
  if (active_) return;
  error_.reset();
  planner_ =
      motion::JogPlanner(feed_.limits(), config_.trajectory.interpolation_time, feed_.commanded());
  const motion::Extents travel = feed_.travel(trust.known());
  for (const Axis axis : kAllAxes) planner_.set_travel(axis, {travel.min[axis], travel.max[axis]});
  feed_.begin_motion(trust.known());
}

double JogControl::allowed_rate(double rate, const PositionTrust& trust) const {
  const bool is_slow = config_.safety.homing_mandatory && !trust.all_trusted();
  const double highest = is_slow ? kUnhomedRate : 1.0;
  return std::clamp(rate, -highest, highest);
}

Result<void> JogControl::set_rates(const Position& rates, double until,
                                   const PositionTrust& trust) {
  for (const Axis axis : kAllAxes)
    if (rates[axis] != 0.0 && !config_.axes[axis].programmable())
      return fail(ErrorCode::axis_not_connected,
                  "Axis " + std::string(axis_name(axis)) + " is not connected.");
  begin(trust);
  for (const Axis axis : kAllAxes) {
    if (!config_.axes[axis].programmable()) continue;
    const double velocity = allowed_rate(rates[axis], trust) * config_.axes[axis].velocity;
    if (auto set = planner_.set_velocity(axis, velocity); !set) return set;
  }
  leased_ = true;
  lease_end_ = until;
  active_ = true;
  if (std::exchange(rates_, rates) != rates) replan();
  return {};
}

Result<void> JogControl::step(Axis axis, double distance, double rate, const PositionTrust& trust) {
  if (!config_.axes[axis].programmable())
    return fail(ErrorCode::axis_not_connected,
                "Axis " + std::string(axis_name(axis)) + " is not connected.");
  begin(trust);
  const double speed = allowed_rate(rate, trust) * config_.axes[axis].velocity;
  if (auto moved = planner_.move_by(axis, distance, speed); !moved) return moved;
  rates_ = {};
  active_ = true;
  return {};
}

void JogControl::stop() {
  planner_.stop();
  leased_ = false;
  rates_ = {};
  replan();
}

/// Every order has just been given anew, so that none is lost that a void tick has fulfilled.
void JogControl::replan() {
  if (!active_) return;
  replan_wanted_ = feed_.cut_answer() == CutAnswer::pending;
  if (replan_wanted_) return;
  if (const std::size_t count = feed_.replaceable(); count > 0) cut(count);
}

void JogControl::cut(std::size_t count) {
  feed_.begin_cut(count);
  planner_.go_back(feed_.commanded(), feed_.end_velocity(), feed_.end_acceleration());
  draw();
  feed_.commit_cut();
}

void JogControl::drop() {
  active_ = leased_ = replan_wanted_ = false;
  rates_ = {};
  planner_ =
      motion::JogPlanner(feed_.limits(), config_.trajectory.interpolation_time, feed_.commanded());
}

void JogControl::draw() {
  while (feed_.wants_more(kLead)) {
    const auto setpoint = planner_.next();
    if (!setpoint) return;
    if (auto sent = feed_.emit(*setpoint); !sent) {
      error_ = std::move(sent.error());  // the next cycle tells
      return;
    }
  }
}

void JogControl::cycle(double now) {
  if (leased_ && now >= lease_end_) stop();
  if (feed_.cut_answer() == CutAnswer::late) cut(feed_.replaceable());
  if (feed_.cut_answer() == CutAnswer::pending) return;
  if (replan_wanted_) replan();
  if (!error_) draw();
  if (error_) return drop();
  if (planner_.standing() && !leased_ && feed_.at_rest()) active_ = false;
}

}  // namespace cnc::server
