// The steps of all axes within one slice of time, in the order in which they are due.
//
// Within a slice (100 us) each axis is taken to move at constant speed. Against the cubic that is
// wrong by at most a t^2 / 8: 0.00125 step at 10^6 steps/s^2, and zero at the slice's end.
#pragma once

#include "hal/cpu5/firmware/fixed_point.h"

namespace cnc::hal::cpu5::firmware {

class SliceSteps {
 public:
  struct Step {
    std::size_t axis;
    int direction;        ///< +1 or -1
    std::int64_t moment;  ///< part of the slice that has passed, in 2^-24
  };

  /// The axis moves between two positions less than 2^31 steps apart. Once per axis and slice.
  void add(std::size_t axis, StepPosition from, StepPosition to);

  [[nodiscard]] bool empty() const { return lane_count_ == 0; }
  /// Takes the earliest step that is left; of simultaneous ones the first axis's. Not empty.
  Step take();

 private:
  struct Lane {
    std::size_t axis;
    int direction;
    std::int64_t steps_left;
    std::int64_t moment;    ///< of the next step
    std::int64_t interval;  ///< from one step to the next
  };

  PerAxis<Lane> lanes_;  // only the first lane_count_ are in use
  std::size_t lane_count_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
