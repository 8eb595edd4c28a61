// From the program's curves to the path that is driven: feed moves with a tolerance (G64 P) become
// spans of a smooth curve inside the tube around them, everything else passes as it is.
//
// A run is a sequence of feed moves with a tolerance, each beginning where the last ends. It ends,
// with the machine standing still, at a move of another kind, at an exact stop, where the direction
// nearly reverses, and when finish() says that nothing follows. Inside a run nothing stops. A run
// of one line is that line, passed on as it is. Where the limits of jerk ask for it, moves on an
// exact path form runs too, with a tiny tolerance.
//
// Where nodes lie (tube_spline.h): every vertex is one; between two vertices the steps grow
// geometrically from both ends, beginning with a length on which the curve can turn within the
// tolerance. Lengths and the tube are measured over all six axes, mm and degrees alike: where
// rotary axes turn along, P is their tolerance in degrees too.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/limits.h"
#include "motion/piece.h"
#include "motion/ring.h"
#include "motion/tube_spline.h"

namespace cnc::motion {

class Smoother {
 public:
  /// `tolerance_use`: part of the tube that the path may use, 0 … 1. `exact_path`: moves without a
  /// tolerance become runs of this one, which end at corners above the LAF angle; 0: they pass as
  /// they are.
  explicit Smoother(const AxisLimits& limits, double tolerance_use = 1.0, double exact_path = 0.0);

  /// The next move of the program; it begins where the last one ends.
  void add(const Piece& piece);
  /// Nothing follows until the machine stands: the path ends exactly where the program does.
  void finish();
  /// The machine shall stand still at the end of what was added; false when nothing is inside.
  bool stop_at_end();

  /// The pieces of the path in order.
  [[nodiscard]] bool ready() const { return !ready_.empty(); }
  [[nodiscard]] const Piece& front() const { return ready_.front(); }
  void pop() { ready_.pop_front(); }
  /// Nothing inside, ready or not.
  [[nodiscard]] bool empty() const { return ready_.empty() && !in_run_; }
  void clear();

 private:
  /// A curve of the run that waits for its neighbours to be known.
  struct Segment {
    Piece piece;
    double stretch = 1.0;  ///< length over all six axes for each mm of the curve's parameter
    double length = 0.0;   ///< over all six axes
    double tolerance = 0.0;
    double radius = 0.0;  ///< of an arc; 0: straight
    double longest_step = 0.0;
    double turn = 0.0;  ///< change of direction at its begin, radians for small turns
    double kink = 0.0;  ///< turn over the shorter of the two lengths
  };

  void begin_run(const Segment& first);
  [[nodiscard]] bool is_one_line() const;
  void pass_front();
  void place_front();
  void add_span(const Segment& segment, double from, double to, double end_tolerance);
  [[nodiscard]] double first_step(const Segment& before, const Segment& after, double kink) const;
  void collect();

  [[nodiscard]] bool can_be_smoothed(const Piece& piece) const;
  [[nodiscard]] bool ends_run(const Segment& segment) const;
  [[nodiscard]] double tolerance_of(const Piece& piece, double radius) const;
  [[nodiscard]] double longest_step(const Segment& segment) const;

  TubeSpline spline_;
  double weakest_acceleration_;
  double exact_path_;
  Ring<Segment> segments_;
  std::vector<double> steps_;  // of the segment in hand
  Segment last_placed_;
  Ring<Wishes> sources_;          // of spans that are not ready
  Ring<std::size_t> span_count_;  // of each source
  Ring<Piece> ready_;
  Entry next_entry_ = Entry::standstill;
  bool in_run_ = false;
};

}  // namespace cnc::motion
