// The moves of the canned cycles, one function per kind of hole (manual 3.4.21).
#pragma once

#include "config/plane.h"
#include "interpreter/execution.h"

namespace cnc::interp {

/// Heights along the axis of the hole, work coordinates.
struct CycleLevels {
  double retract = 0.0;  ///< R
  double bottom = 0.0;
  double clear = 0.0;  ///< where the cycle ends
  double back = 0.0;   ///< G87: where it has bored up to
};

/// Emits the moves of one line. Positions are work coordinates until they are emitted, so that the
/// hole lies where the work lies.
class CycleStrokes {
 public:
  CycleStrokes(Execution& x, const CycleWords& words, const CycleLevels& levels);

  /// Once per line: up to R if the tool is below.
  void begin();
  /// Before each hole: over it, and down to R.
  void go_over_hole();

  // Each begins over the hole at R.
  void drill();            ///< down, dwell, rapid out
  void drill_and_clear();  ///< in steps of Q, out of the hole after each
  void drill_and_break();  ///< in steps of Q, back by Q after each
  void bore();             ///< down, dwell, out at feed rate
  void bore_and_stop();    ///< down, dwell, out with the spindle off
  void bore_and_wait();    ///< down, dwell, spindle off, the operator retracts
  void bore_upwards();     ///< through the hole, and up against its lower edge
  void tap();              ///< down and up with the spindle

 private:
  enum class Chips : std::uint8_t { clear, break_off };
  enum class ToolAt : std::uint8_t { hole, insertion };

  void peck(Chips chips);
  void step_aside(ToolAt place);
  void dwell();
  void rapid_to(double level);
  void feed_to(double level);
  void thread_to(double level);
  void turn_spindle(SpindleDirection direction);
  /// False when the tool is there already.
  bool reach(double level);
  [[nodiscard]] Position machine_position() const;

  Execution& x_;
  const CycleWords& words_;
  const CycleLevels& levels_;
  PlaneAxes axes_;
  Position at_;     ///< work coordinates
  Position aside_;  ///< of the tool from there, machine
};

}  // namespace cnc::interp
