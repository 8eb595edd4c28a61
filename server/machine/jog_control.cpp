#include "server/machine/jog_control.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cnc::server {
namespace {

/// Part of the maximum velocity that is allowed before homing, when homing is mandatory (STA-5).
constexpr double kUnhomedRate = 0.05;

}  // namespace

JogControl::JogControl(const config::MachineConfig& config, MotionFeed& feed)
    : config_(config), motion_(config, feed) {}

/// The first command of a motion: from where the machine stands, within the travel of axes that
/// were homed: that of one in doubt is still about right.
void JogControl::begin(const PositionTrust& trust) {
  if (active_) return;
  error_.reset();
  motion_.begin(trust.known());
}

double JogControl::allowed_rate(double rate, const PositionTrust& trust) const {
  const bool is_slow = config_.safety.homing_mandatory && !trust.all_trusted();
  const double highest = is_slow ? kUnhomedRate : 1.0;
  return std::clamp(rate, -highest, highest);
}

Result<void> JogControl::set_rates(const Position& rates, double until,
                                   const PositionTrust& trust) {
  for (const Axis axis : kAllAxes) {
    if (rates[axis] != 0.0 && !config_.axes[axis].programmable())
      return fail(ErrorCode::axis_not_connected,
                  "Axis " + std::string(axis_name(axis)) + " is not connected.");
    if (!std::isfinite(rates[axis]))
      return fail(ErrorCode::jog_value_unusable,
                  "The rate of " + std::string(axis_name(axis)) + " is not a number.");
  }
  begin(trust);
  for (const Axis axis : kAllAxes) {
    if (!config_.axes[axis].programmable()) continue;
    const double velocity = allowed_rate(rates[axis], trust) * config_.axes[axis].velocity;
    if (auto set = motion_.set_velocity(axis, velocity); !set) return set;
  }
  leased_ = true;
  lease_end_ = until;
  active_ = true;
  if (std::exchange(rates_, rates) != rates) motion_.apply();
  return {};
}

Result<void> JogControl::step(Axis axis, double distance, double rate, const PositionTrust& trust) {
  if (!config_.axes[axis].programmable())
    return fail(ErrorCode::axis_not_connected,
                "Axis " + std::string(axis_name(axis)) + " is not connected.");
  begin(trust);
  const double speed = allowed_rate(rate, trust) * config_.axes[axis].velocity;
  if (auto moved = motion_.move_by(axis, distance, speed); !moved) return moved;
  rates_ = {};
  active_ = true;
  motion_.apply();
  return {};
}

void JogControl::stop() {
  leased_ = false;
  rates_ = {};
  if (!active_) return;
  motion_.stop();
  motion_.apply();
}

void JogControl::drop() {
  active_ = leased_ = false;
  rates_ = {};
  motion_.drop();
}

void JogControl::cycle(double now) {
  if (leased_ && now >= lease_end_) stop();
  if (auto moved = motion_.cycle(); !moved) {
    error_ = std::move(moved.error());
    return drop();
  }
  if (!leased_ && motion_.at_rest()) active_ = false;
}

}  // namespace cnc::server
