#include "motion/hand_wheel.h"

#include <algorithm>

namespace cnc::motion {

namespace {

/// Time over which the wheel's speed is measured, s: at one turn a second 16 counts of 400, and the
/// axis begins to stop within two of them.
constexpr double kWindow = 0.04;

std::int32_t difference(std::int32_t count, std::int32_t before) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(count) -
                                   static_cast<std::uint32_t>(before));
}

}  // namespace

HandWheel::HandWheel(Axis axis, const HandWheelSettings& settings, std::int32_t count,
                     double position)
    : axis_(axis), settings_(settings), count_(count), origin_(position) {}

Result<void> HandWheel::follow(JogPlanner& jog, std::int32_t count, double now) {
  const std::int32_t turned = difference(count, count_);
  count_ = count;
  return settings_.mode == HandWheelMode::position ? follow_position(jog, turned)
                                                   : follow_velocity(jog, turned, now);
}

Result<void> HandWheel::follow_position(JogPlanner& jog, std::int32_t turned) {
  if (turned == 0) return {};
  turned_ += turned;
  const double target = origin_ + settings_.way_per_count * static_cast<double>(turned_);
  return jog.move_to(axis_, target, settings_.speed);
}

Result<void> HandWheel::follow_velocity(JogPlanner& jog, std::int32_t turned, double now) {
  if (!window_open_) {
    window_began_ = now;
    window_open_ = true;
  }
  turned_ += turned;
  const double time = now - window_began_;
  if (time < kWindow) return {};
  const double velocity = settings_.way_per_count * static_cast<double>(turned_) / time;
  turned_ = 0;
  window_began_ = now;
  return jog.set_velocity(axis_, std::clamp(velocity, -settings_.speed, settings_.speed));
}

}  // namespace cnc::motion
