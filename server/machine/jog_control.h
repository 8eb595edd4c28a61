// Manual motion: continuous jog as a lease, and single steps (MAN-1, MAN-2).
//
// Whoever jogs has to say so again before the lease runs out; a lost client is a released key. New
// rates, steps and a stop act at once (manual_motion.h).
// Executor thread only.
#pragma once

#include <optional>

#include "config/machine_config.h"
#include "server/machine/manual_motion.h"
#include "server/machine/position_trust.h"

namespace cnc::server {

class JogControl {
 public:
  JogControl(const config::MachineConfig& config, MotionFeed& feed);

  /// Wanted velocities as parts of the maximum, -1 … 1; renews the lease until `until`.
  Result<void> set_rates(const Position& rates, double until, const PositionTrust& trust);
  /// Adds a step to where the axis is going; to where it is, if it jogs.
  Result<void> step(Axis axis, double distance, double rate, const PositionTrust& trust);
  void stop();
  /// The motion was ended from outside (fault): forget it.
  void drop();

  void cycle(double now);
  [[nodiscard]] bool active() const { return active_; }
  /// Set when a setpoint failed its last check; the motion has been dropped.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  void begin(const PositionTrust& trust);
  [[nodiscard]] double allowed_rate(double rate, const PositionTrust& trust) const;

  const config::MachineConfig& config_;
  ManualMotion motion_;
  bool active_ = false;
  bool leased_ = false;
  Position rates_;
  double lease_end_ = 0.0;
  std::optional<Error> error_;
};

}  // namespace cnc::server
