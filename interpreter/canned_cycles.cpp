// G73 G81 G82 G83 G85 G86 G89: drilling and boring (manual 3.4.21), in the XY, XZ or YZ plane.
//
// G74 and G84 need a feed that follows the spindle, G87 a spindle that stops at an angle, G88 a
// retract by hand within the line: as long as the machine has none of these they are unknown codes.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/arc_geometry.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"

namespace cnc::interp {
namespace {

/// What happens between two steps of depth Q.
enum class Peck : std::uint8_t {
  none,        ///< one stroke to the bottom
  clear_hole,  ///< out of the hole
  break_chip,  ///< back by Q
};
enum class WayOut : std::uint8_t { rapid, feed, rapid_with_spindle_off };

struct Cycle {
  std::int32_t code;
  Peck peck;
  WayOut out;
  WordSet sticky;  ///< words that the first line of the cycle must have, besides the depth
};

constexpr auto kCycles = std::to_array<Cycle>({
    {730, Peck::break_chip, WayOut::rapid, words("RQ")},
    {810, Peck::none, WayOut::rapid, words("R")},
    {820, Peck::none, WayOut::rapid, words("RP")},
    {830, Peck::clear_hole, WayOut::rapid, words("RQ")},
    {850, Peck::none, WayOut::feed, words("R")},
    {860, Peck::none, WayOut::rapid_with_spindle_off, words("RP")},
    {890, Peck::none, WayOut::feed, words("RP")},
});

/// "Backed off a bit" (3.4.21.4) before the next step begins at feed rate, mm.
constexpr double kBackOff = 0.25;
/// A line is executed as a whole, so its strokes are bounded.
constexpr double kMaxStrokes = 10'000.0;

/// Heights along the axis of the hole, work coordinates.
struct Levels {
  double retract;  ///< R
  double bottom;
  double clear;  ///< where the cycle ends
};

[[nodiscard]] char depth_letter(const Execution& x) {
  return axis_name(axes_of(x.state().modal.plane).third)[0];
}

Accepted check_missing(const Execution& x, WordSet needed) {
  const char depth = depth_letter(x);
  for (const char letter : {depth, 'R', 'Q', 'P'}) {
    const bool needs = letter == depth || (needed & word_bit(letter)) != 0;
    if (!needs || x.block().has(letter)) continue;
    return refuse(
        ErrorCode::word_missing, x.code_span(),
        fmt::format("{} needs the word {} where the cycle begins.", x.code_name(), letter),
        "Words stay from line to line only within one cycle, plane and distance mode.");
  }
  return {};
}

/// The words of this line over those that stayed from the line before.
Parsed<CycleWords> cycle_words(const Execution& x, const Cycle& cycle) {
  const MachineState& state = x.state();
  const ModalState& modal = state.modal;
  CycleWords words{.plane = modal.plane, .distance = modal.distance};
  const bool goes_on = modal.motion == cycle.code && state.cycle.plane == modal.plane &&
                       state.cycle.distance == modal.distance;
  if (goes_on) {
    words = state.cycle;
  } else if (Accepted all = check_missing(x, cycle.sticky); !all) {
    return std::unexpected(all.error());
  }
  const Block& block = x.block();
  const char depth = depth_letter(x);
  if (block.has(depth)) words.bottom = block.value(depth) * state.scale();
  if (block.has('R')) words.retract = block.value('R') * state.scale();
  if (block.has('Q')) words.peck = block.value('Q') * state.scale();
  if (block.has('P')) words.dwell = block.value('P');
  return words;
}

Accepted check_values(const Execution& x, const Cycle& cycle, const CycleWords& words) {
  if (words.dwell < 0.0) {
    return refuse(ErrorCode::word_out_of_range, x.block().span_of('P'),
                  "A dwell cannot be negative.", "P of 0 or more seconds.");
  }
  if (cycle.peck != Peck::none && words.peck <= 0.0) {
    return refuse(ErrorCode::word_out_of_range, x.block().span_of('Q'),
                  fmt::format("{} cannot drill in steps of 0 or less.", x.code_name()),
                  "Q above 0.");
  }
  return {};
}

Accepted check_axes(const Execution& x) {
  const Block& block = x.block();
  if (!block.has('X') && !block.has('Y') && !block.has('Z')) {
    return refuse(ErrorCode::axis_words_missing, x.code_span(),
                  fmt::format("{} needs at least one of X Y Z.", x.code_name()), "X Y Z");
  }
  const Position end = target(x);
  for (const Axis axis : kRotaryAxes) {
    if (std::abs(end[axis] - x.state().position[axis]) < kSamePoint) continue;
    const char letter = axis_name(axis)[0];
    return refuse(ErrorCode::cycle_turns_axis, block.span_of(letter),
                  fmt::format("{} cannot turn {}.", x.code_name(), letter),
                  "The turn on a line of its own, before the cycle.");
  }
  return {};
}

Accepted check_modes(const Execution& x, const Cycle& cycle) {
  const ModalState& modal = x.state().modal;
  if (modal.feed_mode == FeedMode::inverse_time) {
    return refuse(ErrorCode::cycle_in_inverse_time, x.code_span(),
                  fmt::format("{} cannot use inverse time feed (G93).", x.code_name()),
                  "G94 and F before it.");
  }
  if (cycle.out == WayOut::rapid_with_spindle_off && modal.spindle == SpindleDirection::off) {
    return refuse(ErrorCode::cycle_without_spindle, x.code_span(),
                  fmt::format("{} needs a turning spindle.", x.code_name()), "M3 or M4 before it.");
  }
  return check_feed(x);
}

/// Under G91 R counts from where the tool is, the depth from R.
Parsed<Levels> levels_of(const Execution& x, const CycleWords& words) {
  const ModalState& modal = x.state().modal;
  const double old = x.state().work_position()[axes_of(modal.plane).third];
  const bool incremental = modal.distance == DistanceMode::incremental;
  Levels levels{};
  levels.retract = incremental ? old + words.retract : words.retract;
  levels.bottom = incremental ? levels.retract + words.bottom : words.bottom;
  const bool to_old = modal.retract == RetractMode::old_position;
  levels.clear = to_old ? std::max(old, levels.retract) : levels.retract;
  if (levels.retract >= levels.bottom) return levels;
  return refuse(
      ErrorCode::cycle_retract_below_bottom, x.code_span(),
      fmt::format("The retract position of {} is below the bottom of the hole.", x.code_name()),
      fmt::format("R at or above {}.", depth_letter(x)));
}

Parsed<std::int32_t> repeats_of(const Execution& x) {
  const double value = x.block().find('L').value_or(1.0);
  const auto count = whole_number(value);
  if (count && *count >= 1) return *count;
  return refuse(ErrorCode::word_out_of_range, x.block().span_of('L'),
                fmt::format("{} cannot be repeated {:.10g} times.", x.code_name(), value),
                "L of 1, 2, 3 …");
}

Accepted check_strokes(const Execution& x, const Cycle& cycle, const CycleWords& words,
                       const Levels& levels, std::int32_t repeats) {
  const double depth = levels.retract - levels.bottom;
  const double per_hole = cycle.peck == Peck::none ? 1.0 : std::max(1.0, depth / words.peck);
  if (per_hole * repeats <= kMaxStrokes) return {};
  return refuse(ErrorCode::word_out_of_range, x.code_span(),
                fmt::format("{} would take {:.0f} strokes.", x.code_name(), per_hole * repeats),
                fmt::format("At most {:.0f} on a line: a larger Q, a smaller L.", kMaxStrokes));
}

/// The moves of one line. Positions are work coordinates until they are emitted, so that the hole
/// lies where the work lies.
class Drilling {
 public:
  Drilling(Execution& x, const Cycle& cycle, const CycleWords& words, const Levels& levels)
      : x_(x),
        cycle_(cycle),
        words_(words),
        levels_(levels),
        axes_(axes_of(words.plane)),
        at_(x.state().work_position()) {}

  void run(std::int32_t repeats) {
    if (at_[axes_.third] < levels_.retract) rapid_to(levels_.retract);
    for (std::int32_t i = 0; i < repeats; ++i) {
      go_over_hole();
      rapid_to(levels_.retract);
      go_down();
      if (words_.dwell > 0.0) x_.emit(Dwell{words_.dwell});
      go_out();
    }
  }

 private:
  void go_over_hole() {
    Position over = at_;
    for (const Axis axis : {axes_.first, axes_.second}) {
      if (!x_.block().has(axis)) continue;
      const double value = x_.block().value(axis) * x_.state().scale();
      over[axis] = words_.distance == DistanceMode::incremental ? at_[axis] + value : value;
    }
    if (linear_length(over - at_) < kSamePoint) return;
    at_ = over;
    move_rapid(x_, machine_position());
  }

  void go_down() {
    if (cycle_.peck != Peck::none) peck();
    feed_to(levels_.bottom);
  }

  // Depths are counted from R, not added up, so that rounding makes no extra step.
  void peck() {
    for (double step = 1.0;; step += 1.0) {
      const double depth = levels_.retract - step * words_.peck;
      if (depth <= levels_.bottom + kSamePoint) return;
      const double up = cycle_.peck == Peck::clear_hole ? levels_.clear : depth + words_.peck;
      feed_to(depth);
      rapid_to(up);
      rapid_to(std::min({depth + kBackOff, up, levels_.retract}));
    }
  }

  void go_out() {
    switch (cycle_.out) {
      case WayOut::rapid:
        rapid_to(levels_.clear);
        return;
      case WayOut::feed:
        feed_to(levels_.clear);
        return;
      case WayOut::rapid_with_spindle_off:
        x_.emit(TurnSpindle{SpindleDirection::off});
        rapid_to(levels_.clear);
        x_.emit(TurnSpindle{x_.state().modal.spindle});
        return;
    }
  }

  void rapid_to(double level) {
    if (reach(level)) move_rapid(x_, machine_position());
  }
  void feed_to(double level) {
    if (reach(level)) move_feed(x_, machine_position());
  }
  /// False when the tool is there already.
  bool reach(double level) {
    if (std::abs(level - at_[axes_.third]) < kSamePoint) return false;
    at_[axes_.third] = level;
    return true;
  }
  [[nodiscard]] Position machine_position() const { return x_.state().coordinates.to_machine(at_); }

  Execution& x_;
  const Cycle& cycle_;
  const CycleWords& words_;
  const Levels& levels_;
  PlaneAxes axes_;
  Position at_;
};

}  // namespace

Accepted canned_cycle(Execution& x) {
  const Cycle& cycle = *std::ranges::find(kCycles, x.code(), &Cycle::code);
  if (Accepted axes = check_axes(x); !axes) return axes;
  const auto words = cycle_words(x, cycle);
  if (!words) return std::unexpected(words.error());
  if (Accepted values = check_values(x, cycle, *words); !values) return values;
  if (Accepted modes = check_modes(x, cycle); !modes) return modes;
  const auto levels = levels_of(x, *words);
  if (!levels) return std::unexpected(levels.error());
  const auto repeats = repeats_of(x);
  if (!repeats) return std::unexpected(repeats.error());
  if (Accepted few = check_strokes(x, cycle, *words, *levels, *repeats); !few) return few;

  // As in NIST RS274/NGC holes are drilled in exact path mode: a rounded corner between rapid and
  // feed would cut the way to R short.
  const SetPathMode path = x.state().modal.path;
  const bool rounds_corners = path.mode == PathMode::continuous;
  if (rounds_corners) x.emit(SetPathMode{});
  Drilling(x, cycle, *words, *levels).run(*repeats);
  if (rounds_corners) x.emit(path);
  x.state().cycle = *words;
  x.state().modal.motion = cycle.code;
  return {};
}

}  // namespace cnc::interp
