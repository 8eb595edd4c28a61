// G73 G74 G81 … G89: drilling, tapping and boring (manual 3.4.21) in the XY, XZ or YZ plane. Which
// cycles there are, and the words of a line; the moves are in cycle_strokes.cpp.
#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "interpreter/cycle_strokes.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"
#include "interpreter/spindle_moves.h"

namespace cnc::interp {
namespace {

enum class SpindleNeed : std::uint8_t { none, turning, clockwise, counterclockwise };

struct Cycle {
  std::int32_t code;
  WordSet sticky;  ///< words that the first line of the cycle must have, besides the depth
  SpindleNeed spindle;
  void (CycleStrokes::*make_hole)();
};

// F stands on the first line of a tapping cycle, where it is the pitch: a feed from before it,
// meant for milling, would be a pitch of hundreds of millimetres.
constexpr auto kCycles = std::to_array<Cycle>({
    {730, words("RQ"), SpindleNeed::none, &CycleStrokes::drill_and_break},
    {740, words("RF"), SpindleNeed::counterclockwise, &CycleStrokes::tap},
    {810, words("R"), SpindleNeed::none, &CycleStrokes::drill},
    {820, words("RP"), SpindleNeed::none, &CycleStrokes::drill},
    {830, words("RQ"), SpindleNeed::none, &CycleStrokes::drill_and_clear},
    {840, words("RF"), SpindleNeed::clockwise, &CycleStrokes::tap},
    {850, words("R"), SpindleNeed::none, &CycleStrokes::bore},
    {860, words("RP"), SpindleNeed::turning, &CycleStrokes::bore_and_stop},
    {870, words("RIJK"), SpindleNeed::turning, &CycleStrokes::bore_upwards},
    {880, words("RP"), SpindleNeed::turning, &CycleStrokes::bore_and_wait},
    {890, words("RP"), SpindleNeed::none, &CycleStrokes::bore},
});

/// A line is executed as a whole, so its strokes are bounded.
constexpr double kMaxStrokes = 10'000.0;
/// The coarsest standard taps have 4 threads per inch, 6.35 mm. An F above this is mm per minute
/// from another control.
constexpr double kMaxTapPitch = 10.0;

[[nodiscard]] bool needs(const Cycle& cycle, char letter) {
  return (cycle.sticky & word_bit(letter)) != 0;
}
[[nodiscard]] bool taps(const Cycle& cycle) { return needs(cycle, 'F'); }
[[nodiscard]] bool pecks(const Cycle& cycle) { return needs(cycle, 'Q'); }
[[nodiscard]] bool bores_upwards(const Cycle& cycle) { return needs(cycle, 'K'); }

/// I for X, J for Y, K for Z.
[[nodiscard]] char distance_letter(Axis linear) {
  return static_cast<char>('I' + (axis_name(linear)[0] - 'X'));
}

[[nodiscard]] char depth_letter(const Execution& x) {
  return axis_name(axes_of(x.state().modal.plane).third)[0];
}

/// Where a word that may stay from line to line stands, or else the code.
[[nodiscard]] Span span_of(const Execution& x, char letter) {
  return x.block().has(letter) ? x.block().span_of(letter) : x.code_span();
}

Accepted check_missing(const Execution& x, const Cycle& cycle) {
  const char depth = depth_letter(x);
  for (const char letter : {depth, 'R', 'Q', 'P', 'F', 'I', 'J', 'K'}) {
    if (x.block().has(letter) || (letter != depth && !needs(cycle, letter))) continue;
    return refuse(
        ErrorCode::word_missing, x.code_span(),
        fmt::format("{} needs the word {} where the cycle begins.", x.code_name(), letter),
        letter == 'F' ? "F per revolution: the pitch."
                      : "Words stay from line to line only within one cycle, plane and distance "
                        "mode.");
  }
  return {};
}

/// Puts the words of this line over those that stayed from the line before.
void read_words(const Execution& x, const Cycle& cycle, CycleWords& words) {
  const Block& block = x.block();
  const MachineState& state = x.state();
  const PlaneAxes axes = axes_of(words.plane);
  const auto read = [&](char letter, double scale, double& value) {
    if (block.has(letter)) value = block.value(letter) * scale;
  };
  const double depth_scale = state.scale(axes.third);
  read(depth_letter(x), depth_scale, words.bottom);
  read('R', depth_scale, words.retract);
  read('Q', depth_scale, words.peck);
  read('P', 1.0, words.dwell);
  if (taps(cycle)) read('F', state.scale(), words.pitch);
  if (!bores_upwards(cycle)) return;
  read(distance_letter(axes.first), state.scale(axes.first), words.insert_first);
  read(distance_letter(axes.second), state.scale(axes.second), words.insert_second);
  read(distance_letter(axes.third), depth_scale, words.back);
}

Parsed<CycleWords> cycle_words(const Execution& x, const Cycle& cycle) {
  const MachineState& state = x.state();
  const ModalState& modal = state.modal;
  CycleWords words{.plane = modal.plane, .distance = modal.distance};
  const bool goes_on = modal.motion == cycle.code && state.cycle.plane == modal.plane &&
                       state.cycle.distance == modal.distance;
  if (goes_on) {
    words = state.cycle;
  } else if (Accepted all = check_missing(x, cycle); !all) {
    return std::unexpected(all.error());
  }
  read_words(x, cycle, words);
  return words;
}

Accepted check_pitch(const Execution& x, double pitch) {
  if (pitch > 0.0 && pitch <= kMaxTapPitch) return {};
  return refuse(ErrorCode::word_out_of_range, span_of(x, 'F'),
                fmt::format("{} cannot cut a thread of {:.10g} mm pitch: F is per revolution.",
                            x.code_name(), pitch),
                fmt::format("F above 0, up to {} mm.", kMaxTapPitch));
}

Accepted check_values(const Execution& x, const Cycle& cycle, const CycleWords& words) {
  if (words.dwell < 0.0) {
    return refuse(ErrorCode::word_out_of_range, span_of(x, 'P'), "A dwell cannot be negative.",
                  "P of 0 or more seconds.");
  }
  if (pecks(cycle) && words.peck <= 0.0) {
    return refuse(ErrorCode::word_out_of_range, span_of(x, 'Q'),
                  fmt::format("{} cannot drill in steps of 0 or less.", x.code_name()),
                  "Q above 0.");
  }
  return taps(cycle) ? check_pitch(x, words.pitch) : Accepted{};
}

Accepted check_axes(const Execution& x) {
  const Block& block = x.block();
  if (!block.has('X') && !block.has('Y') && !block.has('Z')) {
    return refuse(ErrorCode::axis_words_missing, x.code_span(),
                  fmt::format("{} needs at least one of X Y Z.", x.code_name()), "X Y Z");
  }
  return check_rotary_axes_stay(x, target(x), ErrorCode::cycle_turns_axis);
}

Accepted check_spindle_turns(const Execution& x) {
  if (x.state().modal.spindle != SpindleDirection::off) return {};
  return refuse(ErrorCode::cycle_without_spindle, x.code_span(),
                fmt::format("{} needs a turning spindle.", x.code_name()), "M3 or M4 before it.");
}

Accepted check_spindle_taps(const Execution& x, SpindleDirection direction) {
  if (Accepted leads = check_spindle_leads(x); !leads) return leads;
  if (x.state().modal.spindle == direction) return {};
  const bool right_hand = direction == SpindleDirection::clockwise;
  return refuse(
      ErrorCode::tapping_direction, x.code_span(),
      fmt::format("{} taps a {}-hand thread: the spindle must turn {}.", x.code_name(),
                  right_hand ? "right" : "left", right_hand ? "clockwise" : "counter-clockwise"),
      right_hand ? "M3 before it; G74 for a left-hand thread."
                 : "M4 before it; G84 for a right-hand thread.");
}

Accepted check_spindle(const Execution& x, SpindleNeed need) {
  switch (need) {
    case SpindleNeed::none:
      return {};
    case SpindleNeed::turning:
      return check_spindle_turns(x);
    case SpindleNeed::clockwise:
      return check_spindle_taps(x, SpindleDirection::clockwise);
    case SpindleNeed::counterclockwise:
      return check_spindle_taps(x, SpindleDirection::counterclockwise);
  }
  return {};
}

Accepted check_modes(const Execution& x, const Cycle& cycle) {
  if (x.state().modal.feed_mode == FeedMode::inverse_time) {
    return refuse(ErrorCode::cycle_in_inverse_time, x.code_span(),
                  fmt::format("{} cannot use inverse time feed (G93).", x.code_name()),
                  "G94 and F before it.");
  }
  if (Accepted spindle = check_spindle(x, cycle.spindle); !spindle) return spindle;
  return taps(cycle) ? Accepted{} : check_feed(x);
}

Accepted check_back(const Execution& x, const CycleLevels& levels) {
  if (levels.back >= levels.bottom && levels.back <= levels.retract) return {};
  const char letter = distance_letter(axes_of(x.state().modal.plane).third);
  return refuse(ErrorCode::word_out_of_range, span_of(x, letter),
                fmt::format("{} cannot bore from the bottom up to there.", x.code_name()),
                fmt::format("{} between {} and R.", letter, depth_letter(x)));
}

/// Under G91 R counts from where the tool is, the depth from R, K of G87 from the depth.
Parsed<CycleLevels> levels_of(const Execution& x, const Cycle& cycle, const CycleWords& words) {
  const ModalState& modal = x.state().modal;
  const double old = x.state().work_position()[axes_of(modal.plane).third];
  const bool incremental = modal.distance == DistanceMode::incremental;
  CycleLevels levels;
  levels.retract = incremental ? old + words.retract : words.retract;
  levels.bottom = incremental ? levels.retract + words.bottom : words.bottom;
  const bool to_old = modal.retract == RetractMode::old_position;
  levels.clear = to_old ? std::max(old, levels.retract) : levels.retract;
  levels.back = incremental ? levels.bottom + words.back : words.back;
  if (levels.retract < levels.bottom) {
    return refuse(
        ErrorCode::cycle_retract_below_bottom, x.code_span(),
        fmt::format("The retract position of {} is below the bottom of the hole.", x.code_name()),
        fmt::format("R at or above {}.", depth_letter(x)));
  }
  if (!bores_upwards(cycle)) return levels;
  if (Accepted back = check_back(x, levels); !back) return std::unexpected(back.error());
  return levels;
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
                       const CycleLevels& levels, std::int32_t repeats) {
  const double depth = levels.retract - levels.bottom;
  const double per_hole = pecks(cycle) ? std::max(1.0, depth / words.peck) : 1.0;
  if (per_hole * repeats <= kMaxStrokes) return {};
  return refuse(ErrorCode::word_out_of_range, x.code_span(),
                fmt::format("{} would take {:.0f} strokes.", x.code_name(), per_hole * repeats),
                fmt::format("At most {:.0f} on a line: a larger Q, a smaller L.", kMaxStrokes));
}

void make_holes(Execution& x, const Cycle& cycle, const CycleWords& words,
                const CycleLevels& levels, std::int32_t repeats) {
  CycleStrokes strokes(x, words, levels);
  strokes.begin();
  for (std::int32_t i = 0; i < repeats; ++i) {
    strokes.go_over_hole();
    (strokes.*cycle.make_hole)();
  }
}

}  // namespace

Accepted canned_cycle(Execution& x) {
  const Cycle& cycle = *std::ranges::find(kCycles, x.code(), &Cycle::code);
  if (Accepted axes = check_axes(x); !axes) return axes;
  const auto words = cycle_words(x, cycle);
  if (!words) return std::unexpected(words.error());
  if (Accepted values = check_values(x, cycle, *words); !values) return values;
  if (Accepted modes = check_modes(x, cycle); !modes) return modes;
  const auto levels = levels_of(x, cycle, *words);
  if (!levels) return std::unexpected(levels.error());
  const auto repeats = repeats_of(x);
  if (!repeats) return std::unexpected(repeats.error());
  if (Accepted few = check_strokes(x, cycle, *words, *levels, *repeats); !few) return few;

  in_exact_path(x, [&] { make_holes(x, cycle, *words, *levels, *repeats); });
  x.state().cycle = *words;
  x.state().modal.motion = cycle.code;
  return {};
}

}  // namespace cnc::interp
