// An offset on its way to where it should be: as fast as a velocity and an acceleration allow, from
// any state of motion, stopping exactly at its goal.
#pragma once

namespace cnc::motion {

class OffsetRamp {
 public:
  /// Stays at 0.
  OffsetRamp() = default;
  OffsetRamp(double max_velocity, double max_acceleration)
      : max_velocity_(max_velocity), max_acceleration_(max_acceleration) {}

  void go_to(double goal) { goal_ = goal; }
  /// At once; only for an offset that moves nothing by it.
  void put(double value);
  void advance(double time);

  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] double velocity() const { return velocity_; }
  [[nodiscard]] bool arrived() const { return value_ == goal_ && velocity_ == 0.0; }
  /// Seconds until the acceleration changes; 0 when arrived.
  [[nodiscard]] double phase() const { return arrived() ? 0.0 : next_phase().duration; }

 private:
  struct Phase {
    double acceleration;
    double duration;
    bool last;
  };
  [[nodiscard]] Phase next_phase() const;

  double max_velocity_ = 0.0;
  double max_acceleration_ = 0.0;
  double goal_ = 0.0;
  double value_ = 0.0;
  double velocity_ = 0.0;
};

}  // namespace cnc::motion
