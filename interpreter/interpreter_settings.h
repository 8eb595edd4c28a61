// What the interpreter is told once, when it is made.
#pragma once

#include <array>
#include <cstdint>

#include "interpreter/canonical.h"
#include "interpreter/dialect.h"
#include "interpreter/sources.h"

namespace cnc::interp {

/// What a program can read of the machine (parameters #5101 … #5150, #5380 … #5396): mm, degrees,
/// rpm, machine coordinates.
struct MachineFacts {
  Position negative_limit;                       ///< #5101 …
  Position positive_limit;                       ///< #5111 …
  Position home_position;                        ///< #5121 …
  Position tool_change_area_low;                 ///< #5131 … X Y Z
  Position tool_change_area_high;                ///< #5141 …
  std::int32_t kinematics = 1;                   ///< #5150; 1 = trivial
  bool simulation = false;                       ///< #5380
  std::array<Position, kHeadCount> head_offset;  ///< by Head; #5391-#5393 of the active one
  std::array<double, 3> max_speed{};             ///< of the spindles 0 … 2; #5394-#5396
};

struct InterpreterSettings {
  LengthUnit default_unit = LengthUnit::millimetre;  ///< active until G20/G21 says otherwise
  bool absolute_arc_centres = false;                 ///< I J K are absolute (AbsoluteCenterCoords)
  bool block_delete = false;                         ///< lines that begin with "/" are skipped
  bool diameter_programming = false;  ///< X words are diameters (turning); arcs' I and R are not
  /// Turning with the tool on the operator's side, X towards him: G2 G3 and G41 G42 turn and lie in
  /// G18 as he sees them, mirrored to the standard (manual 3.4.11.2).
  bool front_tool_post = false;
  bool automatic_tool_change = true;  ///< M6 calls the sub change_tool where there is one
  DialectId dialect = DialectId::eding;
  Library library;             ///< macro files; user_macro behind macro
  /// F of a move that turns rotary axes is the speed of the tool on the work piece, also where
  /// nothing else moves: a length, not degrees, per minute (a mill with a fourth axis).
  bool feed_at_tip = false;
  bool is_3d_printer = false;  ///< M1 switches heaters off; unknown M codes are ignored
  bool strict = false;  ///< what the manual does not allow is refused, not tolerated with a warning
  MachineFacts machine{};
  std::uint32_t lines_per_call = 10'000;  ///< next() returns `working` after that many silent lines
  std::uint32_t max_call_depth = 64;      ///< nested gosubs
};

}  // namespace cnc::interp
