// What every moving code has in common: where its words lead, whether it has a feed, and the
// command that takes the machine there.
#pragma once

#include "interpreter/execution.h"

namespace cnc::interp {

/// Where the axis words of the line lead, machine coordinates.
[[nodiscard]] Position target(const Execution& x);

/// A move at feed rate needs one: on its own line in inverse time, before or on it otherwise.
[[nodiscard]] Accepted check_feed(const Execution& x);

/// Says the feed again where the kind of move changes: in inch programs F means inches for linear
/// and degrees for rotary moves, and the commands carry either.
void use_feed_for(Execution& x, const Position& end);

void move_rapid(Execution& x, const Position& end);
void move_feed(Execution& x, const Position& end);

}  // namespace cnc::interp
