// What every moving code has in common: where its words lead, whether it has a feed, and the
// command that takes the machine there.
#pragma once

#include "interpreter/execution.h"

namespace cnc::interp {

/// Where the axis words of the line lead, machine coordinates.
[[nodiscard]] Position target(const Execution& x);

/// A move at feed rate needs one: on its own line in inverse time, before or on it otherwise; and
/// a turning spindle where the feed is per revolution.
[[nodiscard]] Accepted check_feed(const Execution& x);

/// Refuses, with `code`, a move to `end` that turns A, B or C.
[[nodiscard]] Accepted check_rotary_axes_stay(const Execution& x, const Position& end,
                                              ErrorCode code);

/// Says the feed again where the kind of move changes: in inch programs F means inches for linear
/// and degrees for rotary moves, and the commands carry either.
void use_feed_for(Execution& x, const Position& end);

/// Whether left and right, clockwise and counter-clockwise change places in the active plane.
[[nodiscard]] bool is_mirrored(const Execution& x);

void move_rapid(Execution& x, const Position& end);
void move_feed(Execution& x, const Position& end);

/// Makes `moves` without rounding corners, whatever path mode is in force: between a rapid and a
/// cut a rounded corner would cut the way short (holes are drilled so in NIST RS274/NGC too).
template <typename Moves>
void in_exact_path(Execution& x, const Moves& moves) {
  const SetPathMode path = x.state().modal.path;
  const bool rounds_corners = path.mode == PathMode::continuous;
  if (rounds_corners) x.emit(SetPathMode{});
  moves();
  if (rounds_corners) x.emit(path);
}

}  // namespace cnc::interp
