// The two interrupts of the image, in main.cpp: steps before everything, planning before the link.
#pragma once

#include "hal/cpu5/target/mps2_an385/registers.h"

namespace cnc::hal::cpu5::target {

void step_interrupt();
void planning_interrupt();

}  // namespace cnc::hal::cpu5::target
