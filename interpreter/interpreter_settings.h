// What the interpreter is told once, when it is made.
#pragma once

#include <cstdint>

#include "interpreter/canonical.h"

namespace cnc::interp {

struct InterpreterSettings {
  LengthUnit default_unit = LengthUnit::millimetre;  ///< active until G20/G21 says otherwise
  bool absolute_arc_centres = false;                 ///< I J K are absolute (AbsoluteCenterCoords)
  bool block_delete = false;                         ///< lines that begin with "/" are skipped
  std::uint32_t lines_per_call = 10'000;  ///< next() returns `working` after that many silent lines
  std::uint32_t max_call_depth = 64;      ///< nested gosubs
};

}  // namespace cnc::interp
