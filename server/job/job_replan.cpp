// Re-planning of what the board has not begun: hold, resume and overrides act at once.
//
// The segments behind the first that can be replaced in time are cut off, the runner goes back by
// as many setpoints, and what it hands out now travels with the cut. A cycle or two later the board
// has answered. If it was past the place of the cut already it goes on with what it had, and so
// does the runner: then the cut is made again, further ahead. Also where nothing can be cut, because
// the board stops along its path: until then it takes no more of the path that it brakes along.
#include "server/job/job_control.h"

namespace cnc::server {

void JobControl::replan() {
  if (!active_ || waits_for_ != WaitsFor::nothing) return;
  replan_wanted_ = feed_.cut_answer() == CutAnswer::pending;
  if (replan_wanted_) return;
  if (const std::size_t count = feed_.replaceable(); count > 0) cut_and_go_on(count);
}

void JobControl::cut_and_go_on(std::size_t count) {
  if (!runner_.take_back(count)) {
    count = 0;
    runner_.take_back(count);
  }
  feed_.begin_cut(count);
  notes_before_cut_ = notes_;
  withdraw_notes();
  draw_replacement();
  feed_.commit_cut();
}

/// Those of setpoints that were cut off: the runner hands them out again. Those right behind the
/// last one that is kept lose the segment with which they were to switch.
void JobControl::withdraw_notes() {
  while (!notes_.empty() && notes_.back().after_segment > feed_.last_id()) notes_.pop_back();
  for (DueNote& note : notes_)
    if (note.with_segment > feed_.last_id()) note.with_segment = 0;
}

/// A path of so many small steps that the planner could not go back over the whole FIFO gets a
/// shorter one.
bool JobControl::wants_more() const {
  return feed_.wants_more(config_.trajectory.fifo_time) && planner_.can_keep_more();
}

void JobControl::draw_replacement() {
  while (wants_more()) {
    const JobRunner::Next next = runner_.next();
    if (next == JobRunner::Next::note) {
      note(runner_.event());
    } else if (next != JobRunner::Next::setpoint) {
      return;
    } else if (auto sent = emit(runner_.setpoint()); !sent) {
      error_ = std::move(sent.error());  // the next cycle tells
      return;
    }
  }
}

/// False while it is not known what became of the last cut.
bool JobControl::cut_is_settled() {
  if (!runner_.unconfirmed()) return true;
  switch (feed_.cut_answer()) {
    case CutAnswer::pending:
      return false;
    case CutAnswer::late:
      undo_cut();
      cut_and_go_on(feed_.replaceable());
      return false;
    case CutAnswer::none:
    case CutAnswer::taken:
      break;
  }
  runner_.confirm_take_back();
  notes_before_cut_.clear();
  if (replan_wanted_) replan();
  return !runner_.unconfirmed();
}

void JobControl::undo_cut() {
  runner_.revoke_take_back();
  notes_ = std::move(notes_before_cut_);
  notes_before_cut_.clear();
  plan_speeds();
}

}  // namespace cnc::server
