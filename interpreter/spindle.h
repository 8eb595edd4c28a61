// Switching the spindle, for every code that does.
#pragma once

#include "interpreter/execution.h"

namespace cnc::interp {

/// M3 M4 M5; the outputs that M84-M87 have switched by themselves follow (manual 3.5.7).
void turn_spindle_to(Execution& x, SpindleDirection direction);
/// M5, if there is anything to stop.
void stop_spindle(Execution& x);

}  // namespace cnc::interp
