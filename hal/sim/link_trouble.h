// What is wrong with the cable to a virtual board.
#pragma once

namespace cnc::hal::sim {

struct LinkTrouble {
  bool cable_out = false;
  double loss = 0.0;         ///< probability for each frame, in either direction
  double duplication = 0.0;  ///< probability
  double corruption = 0.0;   ///< probability
  double delay = 0.0;        ///< s, of every frame
  double jitter = 0.0;       ///< s; up to so much more, evenly distributed
};

}  // namespace cnc::hal::sim
