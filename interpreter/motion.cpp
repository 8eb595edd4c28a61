// G0 G1 G2 G3 G80, G4, G28 G30: everything that moves the machine or lets it stand still.
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/arc_geometry.h"
#include "interpreter/contour_following.h"
#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"

namespace cnc::interp {
namespace {

constexpr std::int32_t kClockwiseArc = 20;  // G2
constexpr std::int32_t kCancelMotion = 800;

[[nodiscard]] bool turns_clockwise(const Execution& x) {
  return (x.code() == kClockwiseArc) != is_mirrored(x);
}

/// I J K of the arc's plane; the third is an error.
struct CentreWords {
  char first;
  char second;
  char third;
};
[[nodiscard]] CentreWords centre_words(Plane plane) {
  constexpr auto kWords =
      std::to_array<CentreWords>({{'I', 'J', 'K'}, {'K', 'I', 'J'}, {'J', 'K', 'I'}});
  return kWords.at(static_cast<std::size_t>(plane));
}

Accepted check_arc_words(Execution& x, const CentreWords& centre, const PlaneAxes& axes) {
  const Block& block = x.block();
  // FreeCAD and others write all three; K0 in the XY plane does no harm.
  if (block.find(centre.third).value_or(0.0) != 0.0) {
    return refuse(ErrorCode::arc_centre_off_plane, block.span_of(centre.third),
                  fmt::format("{} does not belong to an arc in this plane.", centre.third),
                  fmt::format("{} and {}.", centre.first, centre.second));
  }
  if (block.has(centre.third)) {
    Accepted tolerated = x.tolerate(Habit::third_centre_word, block.span_of(centre.third));
    if (!tolerated) return tolerated;
  }
  const bool has_centre = block.has(centre.first) || block.has(centre.second);
  if (has_centre && block.has('R')) {
    return refuse(ErrorCode::arc_format_mixed, block.span_of('R'),
                  "This arc has both a radius and a centre.", "R, or I J K.");
  }
  const bool has_end = block.has(axes.first) || block.has(axes.second);
  if (block.has('R') && !has_end) {
    return refuse(ErrorCode::axis_words_missing, x.code_span(),
                  fmt::format("{} with R needs an end point in its plane.", x.code_name()),
                  fmt::format("{} or {}.", axis_name(axes.first), axis_name(axes.second)));
  }
  if (has_centre && !has_end && dialect(x.settings().dialect).circle_needs_end) {
    return x.tolerate(Habit::circle_without_end, x.code_span());
  }
  if (has_centre || block.has('R')) return {};
  return refuse(ErrorCode::arc_centre_missing, x.code_span(),
                fmt::format("{} has neither a centre nor a radius.", x.code_name()),
                fmt::format("{} or {}, or R.", centre.first, centre.second));
}

Accepted check_stays_round(const Execution& x) {
  const MachineState& state = x.state();
  if (state.coordinates.transform().keeps_arcs(state.modal.plane)) return {};
  return refuse(ErrorCode::arc_not_round, x.code_span(),
                fmt::format("{} would not be an arc: G51 or G68 is active.", x.code_name()),
                "Arcs in the XY plane, scaled alike in X and Y; G50 and G69 otherwise.");
}

Parsed<PlanePoint> centre_from_words(const Execution& x, const CentreWords& words,
                                     const PlaneAxes& axes, PlanePoint start) {
  const Block& block = x.block();
  const MachineState& state = x.state();
  Position given;
  given[axes.first] = block.find(words.first).value_or(0.0) * state.scale();
  given[axes.second] = block.find(words.second).value_or(0.0) * state.scale();
  if (state.modal.arc_distance == DistanceMode::incremental) {
    given = state.coordinates.transform().apply_to_distance(given);
    return PlanePoint{start.first + given[axes.first], start.second + given[axes.second]};
  }
  for (const char letter : {words.first, words.second}) {
    if (block.has(letter)) continue;
    return refuse(
        ErrorCode::word_missing, x.code_span(),
        fmt::format("{} needs the word {}: centres are absolute (G90.1).", x.code_name(), letter));
  }
  return in_plane(state.coordinates.to_machine(given), state.modal.plane);
}

Parsed<PlanePoint> arc_centre(const Execution& x, const PlaneAxes& axes, const CentreWords& words,
                              PlanePoint start, PlanePoint end) {
  const MachineState& state = x.state();
  const LengthUnit unit = state.modal.unit;
  const CutterCompensation& comp = state.compensation;
  const bool clockwise = turns_clockwise(x);
  if (x.block().has('R')) {
    const double radius =
        x.block().value('R') * state.scale() * state.coordinates.transform().x_factor();
    const Dialect& rules = dialect(x.settings().dialect);
    const Span span = x.block().span_of('R');
    if (radius < 0.0 && rules.radius_is_positive) {
      return refuse(ErrorCode::word_out_of_range, span, "R cannot be negative in this dialect.",
                    "R above 0; arcs above 180 degrees with I J K.");
    }
    if (comp.awaits_entry()) return entry_arc_centre(comp, end, radius, clockwise, span);
    return centre_of_radius(
        start, end, radius, clockwise, unit,
        rules.short_radius_is_half_circle ? ShortRadius::half_circle : ShortRadius::refused, span);
  }
  const auto centre = centre_from_words(x, words, axes, start);
  if (!centre) return centre;
  const Accepted fits = comp.awaits_entry()
                            ? check_entry_centre(comp, end, *centre, clockwise, unit, x.code_span())
                            : check_centre(start, end, *centre, unit, x.code_span());
  if (!fits) return std::unexpected(fits.error());
  return centre;
}

[[nodiscard]] bool has_axis_words(const Block& block) { return (block.words() & kAxisWords) != 0; }

/// "G0 G28 Z0": the axis words belong to G28 (check_block.cpp).
[[nodiscard]] bool non_modal_takes_axes(const Block& block) {
  return block.has(Step::non_modal) && block.code(Step::non_modal).axes != AxisUse::none;
}

Accepted straight_move(Execution& x, MoveKind kind) {
  const Position end = target(x);
  if (x.state().compensation.acts()) return follow_line(x, kind, end);
  if (kind == MoveKind::rapid) {
    move_rapid(x, end);
  } else {
    move_feed(x, end);
  }
  return {};
}

}  // namespace

Accepted rapid_move(Execution& x) {
  x.state().modal.motion = x.code();
  if (!has_axis_words(x.block()) || non_modal_takes_axes(x.block())) return {};
  return straight_move(x, MoveKind::rapid);
}

Accepted feed_move(Execution& x) {
  x.state().modal.motion = x.code();
  if (!has_axis_words(x.block())) return {};  // "G1 F300"
  if (Accepted feed = check_feed(x); !feed) return feed;
  return straight_move(x, MoveKind::feed);
}

Accepted arc_move(Execution& x) {
  MachineState& state = x.state();
  const Plane plane = state.modal.plane;
  const PlaneAxes axes = axes_of(plane);
  const CentreWords words = centre_words(plane);
  if (Accepted given = check_arc_words(x, words, axes); !given) return given;
  if (Accepted round = check_stays_round(x); !round) return round;
  if (Accepted feed = check_feed(x); !feed) return feed;

  const Position end = target(x);
  const auto centre =
      arc_centre(x, axes, words, in_plane(state.position, plane), in_plane(end, plane));
  if (!centre) return std::unexpected(centre.error());
  state.modal.motion = x.code();
  const ArcMove arc{end, centre->first, centre->second, turns_clockwise(x) ? -1 : 1, plane};
  if (state.compensation.acts()) return follow_arc(x, arc);
  use_feed_for(x, end);
  x.emit(arc);
  state.position = end;
  return {};
}

Accepted cancel_motion(Execution& x) {
  x.state().modal.motion = kCancelMotion;
  return {};
}

Accepted dwell(Execution& x) {
  const double seconds = x.block().value('P');
  if (seconds < 0.0) {
    return refuse(ErrorCode::word_out_of_range, x.block().span_of('P'),
                  "A dwell cannot be negative.", "P of 0 or more seconds.");
  }
  x.emit(Dwell{seconds});
  return {};
}

// G28 G30: by way of the programmed point to the stored position. The manual sends "the machine"
// home; as on Fanuc-like controls and LinuxCNC only the named axes go, all of them if none is
// named: CAM systems write "G91 G28 Z0" to lift the tool, and X Y must not move then.
Accepted go_home(Execution& x) {
  constexpr std::int32_t kG28 = 280;
  const config::ParameterStore& stored = x.parameters();
  const Position home = x.code() == kG28 ? stored.g28_position() : stored.g30_position();
  const bool some_named = has_axis_words(x.block());
  if (some_named) move_rapid(x, target(x));
  Position end = x.state().position;
  for (const Axis axis : kAllAxes) {
    if (!some_named || x.block().has(axis)) end[axis] = home[axis];
  }
  move_rapid(x, end);
  return {};
}

}  // namespace cnc::interp
