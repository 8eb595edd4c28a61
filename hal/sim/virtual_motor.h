// The motor of one axis with its way: what becomes of step pulses, the travel's hard stops, and the
// switches that the moving part runs over.
//
// Places are whole steps, upwards in the axis's direction, counted from the home position: only
// then can a home switch release exactly there. A rotor in step is where its pulses put it; how far
// it lags within its step decides only whether it loses steps (rotor.h). Every step by which motor
// and pulses part is lost and counted: by the rotor, against a stop, or with the drive off. A
// closed-loop drive notices those that are lost while it is on, and raises its alarm until it is
// switched off.
#pragma once

#include <array>
#include <limits>

#include "config/machine_config.h"
#include "hal/cpu5/firmware/fixed_point.h"
#include "hal/sim/machine_options.h"
#include "hal/sim/rotor.h"

namespace cnc::hal::sim {

class VirtualMotor {
 public:
  using Ticks = cpu5::firmware::Ticks;

  enum class Switch : std::uint8_t { home, limit_low, limit_high };

  VirtualMotor(const config::MachineConfig& config, Axis axis, const MachineOptions& options);

  /// One pulse, upwards or downwards as the board counts. Hot: most of a simulation's time.
  void step(int direction) {
    const std::int64_t place = place_ + direction * sense_;
    if (place <= quiet_low_ || place >= quiet_high_) return step_with_care(place);
    place_ = place;
  }
  /// Every step up to `now` has been given.
  void advance(Ticks now) {
    if (now - followed_until_ >= window_) follow(now);
  }
  void set_drive(bool on);
  /// The load is pushed so far against the motor's will.
  void lose_steps(std::int64_t steps);

  [[nodiscard]] double position() const {
    return home_position_ + static_cast<double>(place_) / steps_per_unit_;
  }
  [[nodiscard]] std::uint64_t lost_steps() const { return lost_; }
  [[nodiscard]] bool alarm() const { return (signals_ & kAlarm) != 0; }
  [[nodiscard]] bool switch_on(Switch which) const { return (signals_ & signal_of(which)) != 0; }
  /// None of the switches is on, and no alarm.
  [[nodiscard]] bool is_silent() const { return signals_ == 0; }

 private:
  /// A bit for each switch that is on, and one for the alarm: read for all axes in every slice.
  using Signals = std::uint8_t;
  static constexpr Signals kAlarm = 1 << 3;
  [[nodiscard]] static constexpr Signals signal_of(Switch which) {
    return static_cast<Signals>(1U << static_cast<unsigned>(which));
  }
  void set_signal(Signals signal, bool on) {
    signals_ = static_cast<Signals>(on ? signals_ | signal : signals_ & ~signal);
  }

  static constexpr std::int64_t kNowhere = std::numeric_limits<std::int64_t>::max() / 2;

  /// On beyond its place, on one side of it, until it is left by the hysteresis.
  struct TravelSwitch {
    int side = 0;  ///< +1: on above, -1: below, 0: there is none
    std::int64_t on_at = 0;
    std::int64_t off_at = 0;

    [[nodiscard]] bool is_on(std::int64_t place, bool was_on) const;
  };

  [[nodiscard]] std::int64_t place_of(double position) const;
  void place_stops_and_switches(const config::AxisConfig& axis, const MachineOptions& options);
  void step_with_care(std::int64_t place);
  void follow(Ticks now);
  void part(double steps);
  void move_to(std::int64_t place);
  void lose(std::uint64_t steps);
  void update_switches();

  std::int64_t place_ = 0;
  int sense_ = 1;  // -1: positive steps move the axis in its negative direction
  Signals signals_ = 0;
  std::int64_t quiet_low_ = 0;  // between these two a step only changes the place
  std::int64_t quiet_high_ = 0;
  Ticks followed_until_ = 0;
  Ticks window_ = std::numeric_limits<Ticks>::max();

  bool connected_;
  bool drive_on_ = false;
  bool closed_loop_;
  double steps_per_unit_;
  double home_position_;
  std::int64_t low_stop_ = -kNowhere;
  std::int64_t high_stop_ = kNowhere;
  std::array<TravelSwitch, 3> switches_{};
  Rotor rotor_;
  std::int64_t followed_place_ = 0;
  std::uint64_t followed_lost_ = 0;
  double coasted_ = 0.0;  // steps, the part that has not become a whole one
  std::uint64_t lost_ = 0;
};

}  // namespace cnc::hal::sim
