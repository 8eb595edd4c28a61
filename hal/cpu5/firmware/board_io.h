// The pins of the board, as the core sees them. A port to a processor writes this class.
#pragma once

#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5::firmware {

class BoardIo {
 public:
  /// Nothing moves. For boards with pins: how the pulses have to look.
  virtual void set_up(const Setup& /*setup*/) {}
  /// One step; direction is +1 or -1. It is due at `when`, which never goes back from step to step:
  /// the present, or, as far as run_until() was called late, a little before.
  virtual void step(std::size_t axis, int direction, Ticks when) = 0;
  /// The inputs as they are at this moment. `now` is the core's time of it, the clock that capture
  /// times are on; it never goes back.
  virtual Inputs inputs(Ticks now) = 0;
  virtual void set_outputs(const Outputs& outputs) = 0;

 protected:
  ~BoardIo() = default;
};

}  // namespace cnc::hal::cpu5::firmware
