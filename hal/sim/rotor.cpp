#include "hal/sim/rotor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cnc::hal::sim {
namespace {

// Of 1 / w, the time in which the spring acts: small enough for Euler's method.
constexpr double kWindowPart = 0.25;
// s; the firmware's slices are no shorter, so a stiffer motor could not be followed.
constexpr double kShortestWindow = 100e-6;
constexpr double kHighestResonance = kWindowPart / kShortestWindow;  // rad/s
constexpr double kRestLag = 0.01;                                    // steps

}  // namespace

double MotorCurve::acceleration_at(double velocity) const {
  const double speed = std::abs(velocity);
  if (speed > top_velocity) return 0.0;
  return speed <= corner_velocity ? acceleration : acceleration * corner_velocity / speed;
}

Rotor::Rotor(const MotorCurve& curve, double microsteps)
    : curve_(curve),
      full_step_(
          std::max(microsteps, curve.acceleration / (kHighestResonance * kHighestResonance))),
      stiffness_(curve.acceleration / full_step_),
      damping_(2.0 * std::sqrt(stiffness_)),
      window_(kWindowPart / std::sqrt(stiffness_)) {}

void Rotor::follow(double steps, double seconds) {
  const double field_velocity = steps / seconds;
  const double pieces = std::ceil(seconds / window_);
  const double piece = seconds / pieces;
  for (double i = 0.0; i < pieces && in_step_; ++i) {
    pull(field_velocity, piece);
    if (steps == 0.0) settle();
    if (at_rest() && steps == 0.0) return;
  }
}

void Rotor::pull(double field_velocity, double seconds) {
  const double limit = curve_.acceleration_at(velocity_);
  const double wanted = stiffness_ * lag_ + damping_ * (field_velocity - velocity_);
  velocity_ += std::clamp(wanted, -limit, limit) * seconds;
  lag_ += (field_velocity - velocity_) * seconds;
  in_step_ = std::abs(lag_) <= 2.0 * full_step_;
}

void Rotor::settle() {
  const double rest_velocity = kRestLag * damping_;
  if (std::abs(lag_) < kRestLag && std::abs(velocity_) < rest_velocity) stop();
}

double Rotor::coast(double seconds) {
  const double braking = curve_.acceleration / 2.0;
  const double speed = std::max(0.0, std::abs(velocity_) - braking * seconds);
  const double braked = (std::abs(velocity_) - speed) / braking;
  const double way = std::copysign((std::abs(velocity_) + speed) / 2.0 * braked, velocity_);
  velocity_ = std::copysign(speed, velocity_);
  return way;
}

void Rotor::engage(double field_velocity) {
  const double catching = std::sqrt(curve_.acceleration * full_step_);
  in_step_ = in_step_ || (velocity_ == 0.0 && std::abs(field_velocity) <= catching);
}

double Rotor::release() {
  in_step_ = false;
  return std::exchange(lag_, 0.0);
}

void Rotor::stop() {
  lag_ = 0.0;
  velocity_ = 0.0;
}

}  // namespace cnc::hal::sim
