// The pins of the board, as the core sees them. A port to a processor writes this class.
#pragma once

#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5::firmware {

class BoardIo {
 public:
  /// One step pulse; direction is +1 or -1.
  virtual void step(std::size_t axis, int direction) = 0;
  /// The inputs as they are at this moment. `now` is the core's time of it, the clock that capture
  /// times are on; it never goes back.
  virtual Inputs inputs(Ticks now) = 0;
  virtual void set_outputs(const Outputs& outputs) = 0;

 protected:
  ~BoardIo() = default;
};

}  // namespace cnc::hal::cpu5::firmware
