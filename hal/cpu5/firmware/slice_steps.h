// The steps of all axes on one piece of their path, in the order in which they are due.
//
// A step is due when the axis passes the middle between two steps: nearest_step() changes there.
// The moment is that of the segment's own cubic, at any acceleration. Where an axis turns round
// within the piece, and comes back over a middle that it has passed, it makes no step: the motor
// would only be sent to and fro.
#pragma once

#include "hal/cpu5/firmware/hermite.h"

namespace cnc::hal::cpu5::firmware {

/// What one axis does on the piece.
struct AxisPiece {
  const Cubic& cubic;
  StepPosition origin;  ///< where the cubic starts
  StepPosition from;
  StepPosition to;
  PathTime after;   ///< of the cubic, at `from`
  PathTime before;  ///< of the cubic, at `to`
};

class SliceSteps {
 public:
  struct Step {
    std::size_t axis;
    int direction;    ///< +1 or -1
    PathTime moment;  ///< of the cubic
  };

  /// Once per axis; the cubic has to live until the last step is taken.
  void add(std::size_t axis, const AxisPiece& piece);

  [[nodiscard]] bool empty() const { return lane_count_ == 0; }
  /// Takes the earliest step that is left; of simultaneous ones the first axis's. Not empty.
  Step take();

 private:
  struct Lane {
    std::size_t axis;
    int direction;
    std::int64_t steps_left;
    const Cubic* cubic;
    Cubic::Passage next;
    PathTime moment;  // of the next step

    void find_moment() { moment = cubic->moment_of(next); }
  };

  PerAxis<Lane> lanes_;  // only the first lane_count_ are in use
  std::size_t lane_count_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
