// "%mx=200": nesting data in a program (manual 2.2.4.4, F11). They say how often and where a part
// is made; the language itself skips them.
#pragma once

#include <optional>
#include <string_view>

namespace cnc::interp {

/// X and Y of the nesting data, in the unit of the program; unset where the file says nothing.
struct NestingData {
  std::optional<double> material_x;  ///< %mx
  std::optional<double> material_y;  ///< %my
  std::optional<double> pitch_x;     ///< %dx
  std::optional<double> pitch_y;     ///< %dy
  std::optional<double> offset_x;    ///< %ox
  std::optional<double> offset_y;    ///< %oy

  /// Takes what `line` says if it is one of nesting data.
  void read(std::string_view line);
};

}  // namespace cnc::interp
