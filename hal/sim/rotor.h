// The rotor of a stepping motor: it follows the field that the step pulses turn, as far as its
// torque goes, and falls out of step where it does not.
//
// What accelerates the rotor is torque over inertia, so the curve of the torque is written as an
// acceleration. It is the textbook's (P. Acarnley, Stepping Motors, 4th ed., IET 2002, chapters 4
// and 5): flat while the drive can hold the current, then falling as 1 / speed because the supply's
// voltage is used up, and nothing at all above the highest speed.
//
// In step the field pulls the rotor like a spring: one full step of lag gives all of the torque.
// The drive damps it, critically. Then a field that accelerates with a pulls the rotor with at most
// 1.27 a at any moment, whatever the motion (the integral of the absolute impulse response), and at
// most a full step behind; so a motor with a margin of 1.5 never loses a step in a legal motion.
// Two full steps of lag are half a period of the field: there the rotor falls out of step.
//
// Out of step the field passes too fast to pull either way. The rotor coasts, braked by friction
// and by its load with half of the torque at standstill, and stays where it comes to rest until the
// field is slow enough to catch it: no faster than the speed that a standing rotor reaches within a
// full step. Pulses that cease while the motor turns fast are the same thing: the rotor swings past
// the standing field by two full steps, and coasts on.
#pragma once

namespace cnc::hal::sim {

/// The acceleration that a motor has for its load; all above 0, in steps or in mm or degrees.
struct MotorCurve {
  double acceleration = 0.0;     ///< up to the corner, per second squared
  double corner_velocity = 0.0;  ///< per second
  double top_velocity = 0.0;     ///< per second; at least the corner's

  [[nodiscard]] double acceleration_at(double velocity) const;
};

class Rotor {
 public:
  /// In steps of the pulses, of which `microsteps` make a full step.
  Rotor(const MotorCurve& curve, double microsteps);

  /// s; how often it should be advanced: a sixteenth of its own period and less.
  [[nodiscard]] double window() const { return window_; }
  [[nodiscard]] bool in_step() const { return in_step_; }
  [[nodiscard]] bool at_rest() const { return in_step_ && lag_ == 0.0 && velocity_ == 0.0; }

  /// In step: the field went `steps` in `seconds` > 0. It may have lost the rotor then.
  void follow(double steps, double seconds);
  /// The field has lost the rotor, or is switched off: the steps that the rotor lags behind it.
  [[nodiscard]] double release();
  /// Out of step: the steps that the rotor goes by itself in `seconds`.
  [[nodiscard]] double coast(double seconds);
  /// A field that is on, and goes at `field_velocity`, catches the rotor if it can.
  void engage(double field_velocity);
  /// Something solid stops it.
  void stop();

 private:
  void pull(double field_velocity, double seconds);
  void settle();

  MotorCurve curve_;
  double full_step_;
  double stiffness_;  // 1/s^2
  double damping_;    // 1/s
  double window_;
  bool in_step_ = true;
  double lag_ = 0.0;  // steps that the field is ahead
  double velocity_ = 0.0;
};

}  // namespace cnc::hal::sim
