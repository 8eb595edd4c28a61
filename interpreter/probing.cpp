// G38.2: straight until the probe trips (manual 3.4.10). What it found is in answers.cpp.
#include <fmt/format.h>

#include "interpreter/arc_geometry.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"

namespace cnc::interp {
namespace {

/// 0.01 inch.
constexpr double kMinProbeWay = 0.254;

// Per revolution is refused too: a probe's spindle stands, so the move would never end.
Accepted check_feed_mode(const Execution& x) {
  const FeedMode mode = x.state().modal.feed_mode;
  if (mode == FeedMode::per_minute) return check_feed(x);
  return refuse(ErrorCode::probe_feed_mode, x.code_span(),
                fmt::format("G38.2 cannot use {}.", mode == FeedMode::inverse_time
                                                        ? "inverse time feed (G93)"
                                                        : "a feed per revolution (G95)"),
                "G94 and F before it.");
}

Accepted check_way(const Execution& x, const Position& end) {
  const Block& block = x.block();
  if (!block.has('X') && !block.has('Y') && !block.has('Z')) {
    return refuse(ErrorCode::axis_words_missing, x.code_span(),
                  "G38.2 needs at least one of X Y Z.", "X Y Z");
  }
  if (Accepted stay = check_rotary_axes_stay(x, end, ErrorCode::rotary_axis_would_turn); !stay) {
    return stay;
  }
  const double way = linear_length(end - x.state().position);
  if (way > kMinProbeWay - kSamePoint) return {};
  return refuse(ErrorCode::probe_too_close, x.code_span(),
                fmt::format("G38.2 would move {:.3f} mm only.", way),
                "An end at least 0.254 mm (0.01 inch) away.");
}

}  // namespace

Accepted probe(Execution& x) {
  const Position end = target(x);
  if (Accepted way = check_way(x, end); !way) return way;
  if (Accepted mode = check_feed_mode(x); !mode) return mode;
  use_feed_for(x, end);
  x.emit(ProbeMove{end});
  x.state().position = end;
  x.state().modal.motion = x.code();
  return {};
}

}  // namespace cnc::interp
