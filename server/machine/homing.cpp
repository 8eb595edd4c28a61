#include "server/machine/homing.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace cnc::server {
namespace {

/// The way off the switch is slower than the way to it. The latch is exact at any speed; this only
/// keeps the mechanics quiet at the instant that counts.
constexpr double kReleaseRate = 0.25;
/// A switch must come within its axis' travel and this much more; it must release within this part
/// of the travel.
constexpr double kSearchReach = 1.2;
constexpr double kReleaseReach = 0.5;

double travel_of(const config::AxisConfig& axis) {
  return std::abs(axis.positive_limit - axis.negative_limit);
}

}  // namespace

Homing::Homing(const config::MachineConfig& config, MotionFeed& feed)
    : config_(config), feed_(feed), motion_(config, feed) {}

std::vector<Axis> Homing::default_order(const config::MachineConfig& config) {
  std::vector<Axis> order{Axis::Z, Axis::X, Axis::Y, Axis::A, Axis::B, Axis::C};
  std::erase_if(order, [&](Axis axis) { return !config.axes[axis].programmable(); });
  return order;
}

void Homing::start(std::vector<Axis> axes) {
  axes_ = std::move(axes);
  error_.reset();
  motion_.begin({});
  phase_ = Phase::next_axis;
}

void Homing::stop() {
  if (!active()) return;
  error_ = Error{ErrorCode::command_interrupted, "Homing was stopped.", std::nullopt};
  brake_into(Phase::stopping);
}

void Homing::drop() {
  phase_ = Phase::idle;
  axes_.clear();
  motion_.drop();
}

std::optional<Axis> Homing::cycle() {
  const std::optional<Axis> homed = advance();
  if (!active()) return homed;
  if (auto moved = motion_.cycle(); !moved) {
    error_ = std::move(moved.error());
    feed_.quick_stop();
    drop();
  }
  return homed;
}

/// One look at the switch and at the motion: does the next phase begin?
std::optional<Axis> Homing::advance() {
  switch (phase_) {
    case Phase::idle:
      break;
    case Phase::next_axis:
      if (!motion_.at_rest()) break;
      if (axes_.empty()) {
        phase_ = Phase::idle;
        break;
      }
      if (axis_config().home_velocity == 0.0) {  // homed by hand: it stands at its home position
        set_position(axis_config().home_position);
        break;
      }
      begin_axis();
      break;
    case Phase::to_switch:
      if (feed_.board().inputs.home[axis()])
        brake_into(Phase::at_switch);
      else if (motion_.at_rest())
        fail(ErrorCode::home_switch_not_found, "did not meet its home switch");
      break;
    case Phase::at_switch:
      if (!motion_.at_rest()) break;
      feed_.send(ArmLatch{axis(), hal::LatchEdge::release});
      phase_ = Phase::arming;
      break;
    case Phase::arming:
      if (!motion_.at_rest()) break;
      move(-kReleaseRate * axis_config().home_velocity, kReleaseReach * travel_of(axis_config()));
      phase_ = Phase::off_switch;
      break;
    case Phase::off_switch:
      if (feed_.board().home_latch[axis()].caught)
        brake_into(Phase::released);
      else if (motion_.at_rest())
        fail(ErrorCode::home_switch_stuck, "did not release its home switch");
      break;
    case Phase::released:
      if (motion_.at_rest()) take_latch();
      break;
    case Phase::counting: {
      if (!motion_.at_rest()) break;
      const Axis homed = axis();
      axes_.erase(axes_.begin());
      phase_ = Phase::next_axis;
      return homed;
    }
    case Phase::stopping:
      if (!motion_.at_rest()) break;
      axes_.clear();
      phase_ = Phase::idle;
      break;
  }
  return std::nullopt;
}

void Homing::begin_axis() {
  // Anew: the axis before may count from another place now.
  motion_.begin({});
  if (feed_.board().inputs.home[axis()]) {  // stands on its switch already
    phase_ = Phase::at_switch;
    return;
  }
  move(axis_config().home_velocity, kSearchReach * travel_of(axis_config()));
  phase_ = Phase::to_switch;
}

void Homing::move(double velocity, double reach) {
  // Refused only for values that the configuration does not let in.
  static_cast<void>(motion_.move_by(axis(), std::copysign(reach, velocity), std::abs(velocity)));
}

void Homing::brake_into(Phase next) {
  motion_.stop();
  motion_.apply();
  phase_ = next;
}

/// The place of the release has the home position; the axis has run on a little behind it.
void Homing::take_latch() {
  const double behind = feed_.board().position[axis()] - feed_.board().home_latch[axis()].position;
  feed_.send(DisarmLatch{axis()});
  set_position(axis_config().home_position + behind);
}

void Homing::set_position(double position) {
  feed_.set_position(axis(), position);
  phase_ = Phase::counting;
}

void Homing::fail(ErrorCode code, std::string_view what) {
  error_ = Error{code, fmt::format("Axis {} {}.", axis_name(axis()), what), std::nullopt};
  feed_.send(DisarmLatch{axis()});
  phase_ = Phase::stopping;
}

}  // namespace cnc::server
