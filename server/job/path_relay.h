// A profile that drives nothing: the planner's path goes on to another thread, which times it.
//
// To the planner it looks like a machine that is wherever the path ends at the moment it gets
// there. So the planner smooths and closes its path just as for a machine, but never has to wait
// for times; and a stretch of no duration is all that the runner sees of each hundred moves.
#pragma once

#include <cstddef>

#include "motion/profile.h"
#include "server/job/path_queue.h"

namespace cnc::server {

class PathRelay final : public motion::Profile {
 public:
  /// `queue` outlives the relay.
  explicit PathRelay(PathQueue& queue) : queue_(queue) {}

  [[nodiscard]] bool sufficient() const override { return passed_on_ >= kAtOnce; }
  [[nodiscard]] bool well_stocked() const override { return sufficient(); }
  bool extend() override { return true; }
  void append(const motion::Piece& piece) override;
  void plan() override {}
  void stop_at_end() override { queue_.add(Rest{0.0, tag_.id}); }
  void clear() override { passed_on_ = 0; }

  [[nodiscard]] bool empty() const override { return passed_on_ == 0; }
  [[nodiscard]] bool standing() const override { return true; }
  void prepare(bool /*held*/) override {}
  [[nodiscard]] std::optional<motion::Stretch> skip() override;
  [[nodiscard]] Position position() const override { return position_; }

  // Without setpoints and times there is nothing to be told of them, nor to go back to.
  void set_overrides(const motion::Overrides& /*overrides*/) override {}
  [[nodiscard]] std::optional<motion::Setpoint> next(bool /*held*/) override { return {}; }
  [[nodiscard]] double time_to_end() const override { return 0.0; }
  [[nodiscard]] motion::ProfilePlace place() const override { return {}; }
  void go_back(const motion::ProfilePlace& /*place*/) override {}
  void forget_before(const motion::ProfilePlace& /*place*/) override {}
  [[nodiscard]] bool keeps_too_much(const motion::ProfilePlace& /*oldest*/) const override {
    return false;
  }
  [[nodiscard]] bool can_keep_more(const motion::ProfilePlace& /*oldest*/) const override {
    return true;
  }
  [[nodiscard]] bool can_go_on_alone() const override { return true; }
  void revert(const motion::ProfilePlace& /*place*/) override {}

 private:
  /// Pieces between two stretches: the runner's part of the work becomes small beside theirs.
  static constexpr std::size_t kAtOnce = 256;

  PathQueue& queue_;
  std::size_t passed_on_ = 0;  // since the last stretch
  motion::MoveTag tag_;        // of the last piece
  Position position_;          // likewise, where it ends
};

}  // namespace cnc::server
