// One axis in equal ticks of time: as near to a wanted velocity as its limits allow, and always
// able to stop within its travel.
//
// Without a limit of jerk a tick has one acceleration, with one it has one jerk: in both cases the
// setpoint of a tick is exact. Whether a tick leaves enough room is decided by the very stop that
// would follow, tick by tick; so a stop ends exactly where the room does.
#pragma once

#include <optional>

namespace cnc::motion {

struct AxisState {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;  ///< stays 0 without a limit of jerk

  [[nodiscard]] bool standing() const { return velocity == 0.0 && acceleration == 0.0; }
};

/// Where the axis may be, and come to stand.
struct Room {
  double bottom;
  double top;
};

class AxisRamp {
 public:
  /// `jerk` 0: no limit. `tick`: s.
  AxisRamp(double acceleration, double jerk, double tick)
      : acceleration_(acceleration), jerk_(jerk), tick_(tick) {}

  /// The state after one tick. Where the room is too small already it brakes.
  [[nodiscard]] AxisState next(const AxisState& now, double wanted, const Room& room) const;
  /// What is left of its motion is rounding.
  [[nodiscard]] bool nearly_stands(const AxisState& state) const;

 private:
  [[nodiscard]] AxisState next_within_acceleration(const AxisState& now, double wanted,
                                                   const Room& room) const;
  [[nodiscard]] AxisState next_within_jerk(const AxisState& now, double wanted,
                                           const Room& room) const;
  [[nodiscard]] AxisState after_tick(const AxisState& now, double acceleration) const;
  [[nodiscard]] double acceleration_towards(const AxisState& now, double wanted) const;
  [[nodiscard]] std::optional<double> stop_within(AxisState state, const Room& room) const;

  double acceleration_;
  double jerk_;
  double tick_;
};

}  // namespace cnc::motion
