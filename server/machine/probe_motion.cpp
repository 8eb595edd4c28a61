#include "server/machine/probe_motion.h"

#include <utility>

#include "server/job/settings.h"
#include "server/job/travel_limits.h"

namespace cnc::server {

ProbeMotion::ProbeMotion(const config::MachineConfig& config, MotionFeed& feed)
    : config_(config), feed_(feed), planner_(planner_settings(config), Position{}) {}

Result<void> ProbeMotion::start(const Position& end, double feed) {
  error_.reset();
  tripped_ = false;
  const Position& start = feed_.commanded();
  if (auto inside = check_travel(config_, motion::extents_of_line(start, end)); !inside)
    return inside;
  planner_ = motion::Planner(planner_settings(config_, feed_.limits()), start);
  motion::MoveOptions options;
  options.feed = feed;
  options.stop_at_end = true;
  if (auto queued = planner_.add_line(end, options); !queued) return queued;
  feed_.begin_motion(AxisArray<bool>::filled(true));
  feed_.send(ArmProbe{});
  phase_ = Phase::arming;
  return {};
}

void ProbeMotion::drop() {
  if (phase_ == Phase::arming || phase_ == Phase::moving) feed_.send(DisarmProbe{});
  if (phase_ == Phase::stopping) feed_.send(ReleaseStop{});
  phase_ = Phase::idle;
}

bool ProbeMotion::standing() const {
  return planner_.held() && phase_ == Phase::moving && feed_.at_rest();
}

void ProbeMotion::cycle() {
  const hal::ControllerStatus& board = feed_.board();
  switch (phase_) {
    case Phase::idle:
      break;
    case Phase::arming:
      if (feed_.at_rest()) look_at_latch();
      break;
    case Phase::moving:
      if (board.probe_latch.caught) {
        phase_ = Phase::stopping;
        break;
      }
      feed_motion();
      break;
    case Phase::disarming:
      // It may have touched after the last look.
      if (!feed_.at_rest()) break;
      if (board.probe_latch.caught)
        phase_ = Phase::stopping;
      else
        end(false, feed_.commanded());
      break;
    case Phase::stopping:
      if (board.path_stop == hal::PathStop::stopped && !board.moving) release();
      break;
    case Phase::releasing:
      if (board.path_stop != hal::PathStop::none || !feed_.at_rest()) break;
      end(!error_, board.probe_latch.position);
      break;
  }
}

void ProbeMotion::look_at_latch() {
  const hal::ProbeLatch& latch = feed_.board().probe_latch;
  if (latch.active_at_arming) {
    error_ = Error{ErrorCode::probe_active,
                   "The probe touches something before the probe move begins.", std::nullopt};
    phase_ = Phase::stopping;
  } else if (latch.armed) {
    phase_ = Phase::moving;
  }
}

void ProbeMotion::feed_motion() {
  while (feed_.wants_more()) {
    const auto setpoint = planner_.next();
    if (!setpoint) break;
    if (auto sent = feed_.emit(*setpoint); !sent) {
      error_ = std::move(sent.error());
      feed_.quick_stop();
      drop();
      return;
    }
  }
  if (!planner_.idle() || planner_.held() || !feed_.at_rest()) return;
  feed_.send(DisarmProbe{});
  phase_ = Phase::disarming;
}

void ProbeMotion::release() {
  feed_.accept_board_position();
  feed_.send(ReleaseStop{});
  phase_ = Phase::releasing;
}

void ProbeMotion::end(bool tripped, const Position& position) {
  tripped_ = tripped;
  position_ = position;
  phase_ = Phase::idle;
}

}  // namespace cnc::server
