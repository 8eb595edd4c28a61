#include "interpreter/cycle_strokes.h"

#include <algorithm>
#include <cmath>

#include "interpreter/arc_geometry.h"
#include "interpreter/moves.h"
#include "interpreter/spindle_moves.h"

namespace cnc::interp {
namespace {

/// "Backed off a bit" (3.4.21.4) before the next step begins at feed rate, mm.
constexpr double kBackOff = 0.25;

}  // namespace

CycleStrokes::CycleStrokes(Execution& x, const CycleWords& words, const CycleLevels& levels)
    : x_(x),
      words_(words),
      levels_(levels),
      axes_(axes_of(words.plane)),
      at_(x.state().work_position()) {}

void CycleStrokes::begin() {
  if (at_[axes_.third] < levels_.retract) rapid_to(levels_.retract);
}

void CycleStrokes::go_over_hole() {
  Position over = at_;
  for (const Axis axis : {axes_.first, axes_.second}) {
    if (!x_.block().has(axis)) continue;
    const double value = x_.block().value(axis) * x_.state().scale(axis);
    over[axis] = words_.distance == DistanceMode::incremental ? at_[axis] + value : value;
  }
  if (linear_length(over - at_) >= kSamePoint) {
    at_ = over;
    move_rapid(x_, machine_position());
  }
  rapid_to(levels_.retract);
}

// --- the holes -----------------------------------------------------------------------------------

void CycleStrokes::drill() {
  feed_to(levels_.bottom);
  dwell();
  rapid_to(levels_.clear);
}

void CycleStrokes::drill_and_clear() {
  peck(Chips::clear);
  drill();
}

void CycleStrokes::drill_and_break() {
  peck(Chips::break_off);
  drill();
}

void CycleStrokes::bore() {
  feed_to(levels_.bottom);
  dwell();
  feed_to(levels_.clear);
}

void CycleStrokes::bore_and_stop() {
  feed_to(levels_.bottom);
  dwell();
  turn_spindle(SpindleDirection::off);
  rapid_to(levels_.clear);
  turn_spindle(x_.state().modal.spindle);
}

// The operator retracts the tool and may have moved it anywhere. So the line goes on with a rapid
// to the clear level, always and not only where it has to be, and the spindle starts there: not in
// the hole, should he have left the tool in it.
void CycleStrokes::bore_and_wait() {
  feed_to(levels_.bottom);
  dwell();
  turn_spindle(SpindleDirection::off);
  x_.emit(ProgramStop{StopKind::program_stop});
  at_[axes_.third] = levels_.clear;
  move_rapid(x_, machine_position());
  turn_spindle(x_.state().modal.spindle);
}

void CycleStrokes::bore_upwards() {
  step_aside(ToolAt::insertion);
  x_.emit(OrientSpindle{});
  rapid_to(levels_.bottom);
  step_aside(ToolAt::hole);
  turn_spindle(x_.state().modal.spindle);
  feed_to(levels_.back);
  feed_to(levels_.bottom);
  x_.emit(OrientSpindle{});
  step_aside(ToolAt::insertion);
  rapid_to(levels_.clear);
  step_aside(ToolAt::hole);
  turn_spindle(x_.state().modal.spindle);
}

void CycleStrokes::tap() {
  const SpindleDirection direction = x_.state().modal.spindle;
  thread_to(levels_.bottom);
  turn_spindle(reversed(direction));
  thread_to(levels_.clear);
  turn_spindle(direction);
}

// --- strokes -------------------------------------------------------------------------------------

// All steps but the last. Depths are counted from R, not added up, so that rounding makes no extra
// step.
void CycleStrokes::peck(Chips chips) {
  for (double step = 1.0;; step += 1.0) {
    const double depth = levels_.retract - step * words_.peck;
    if (depth <= levels_.bottom + kSamePoint) return;
    const double up = chips == Chips::clear ? levels_.clear : depth + words_.peck;
    feed_to(depth);
    rapid_to(up);
    rapid_to(std::min({depth + kBackOff, up, levels_.retract}));
  }
}

// I and J say how the tool fits through the hole at the angle at which the spindle stops. That
// angle is the machine's, so rotation and scaling of the work do not change them.
void CycleStrokes::step_aside(ToolAt place) {
  aside_ = {};
  if (place == ToolAt::insertion) {
    aside_[axes_.first] = words_.insert_first;
    aside_[axes_.second] = words_.insert_second;
  }
  move_rapid(x_, machine_position());
}

void CycleStrokes::dwell() {
  if (words_.dwell > 0.0) x_.emit(Dwell{words_.dwell});
}

void CycleStrokes::rapid_to(double level) {
  if (reach(level)) move_rapid(x_, machine_position());
}

void CycleStrokes::feed_to(double level) {
  if (reach(level)) move_feed(x_, machine_position());
}

void CycleStrokes::thread_to(double level) {
  if (reach(level)) move_with_spindle(x_, machine_position(), words_.pitch);
}

void CycleStrokes::turn_spindle(SpindleDirection direction) { x_.emit(TurnSpindle{direction}); }

bool CycleStrokes::reach(double level) {
  if (std::abs(level - at_[axes_.third]) < kSamePoint) return false;
  at_[axes_.third] = level;
  return true;
}

Position CycleStrokes::machine_position() const {
  return x_.state().coordinates.to_machine(at_) + aside_;
}

}  // namespace cnc::interp
