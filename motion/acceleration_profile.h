// The profile without limits of jerk: acceleration may change at once.
#pragma once

#include "motion/profile.h"
#include "motion/sampler.h"

namespace cnc::motion {

class AccelerationProfile final : public Profile {
 public:
  AccelerationProfile(const AxisLimits& limits, double max_duration, bool goes_back);

  [[nodiscard]] bool sufficient() const override { return track_.sufficient(); }
  [[nodiscard]] bool well_stocked() const override { return track_.well_stocked(); }
  bool extend() override { return track_.extend(); }
  void append(const Piece& piece) override;
  void plan() override { track_.plan(); }
  void stop_at_end() override { track_.stop_at_end(); }
  void set_overrides(const Overrides& overrides) override;
  void clear() override { track_.clear(); }

  [[nodiscard]] bool empty() const override { return track_.empty(); }
  [[nodiscard]] bool standing() const override { return track_.place().speed == 0.0; }
  void prepare(bool /*held*/) override {}
  [[nodiscard]] std::optional<Setpoint> next(bool held) override;
  [[nodiscard]] std::optional<Stretch> skip() override;
  [[nodiscard]] Position position() const override { return track_.position_at(track_.place()); }
  [[nodiscard]] double time_to_end() const override;

  [[nodiscard]] ProfilePlace place() const override { return track_.place(); }
  void go_back(const ProfilePlace& place) override { track_.go_back(std::get<Place>(place)); }
  void forget_before(const ProfilePlace& place) override;
  [[nodiscard]] bool keeps_too_much(const ProfilePlace& oldest) const override;
  [[nodiscard]] bool can_keep_more(const ProfilePlace& oldest) const override;
  [[nodiscard]] bool can_go_on_alone() const override;
  void revert(const ProfilePlace& place) override { go_back(place); }

 private:
  [[nodiscard]] std::uint64_t steps_since(const ProfilePlace& place) const;

  Track track_;
  Sampler sampler_;
  Overrides overrides_;
};

}  // namespace cnc::motion
