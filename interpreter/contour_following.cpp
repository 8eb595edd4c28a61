#include "interpreter/contour_following.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "interpreter/contour.h"

namespace cnc::interp {
namespace {

/// An outside corner whose arc would be shorter than this, mm, is passed straight: on a tool of
/// 0.1 mm that is 0.02 µm off.
constexpr double kShortestCorner = 1e-4;
/// Inside corners below this angle, rad, come from rounded programs, not from corners: NIST
/// RS274/NGC lets them pass (TOLERANCE_CONCAVE_CORNER).
constexpr double kCornerOfRounding = 0.01;
/// A path that turns back on itself, rad: the tool goes around its end on the outside.
constexpr double kReversal = 1e-6;

/// A move of the contour on its way out.
struct Leg {
  MoveKind kind;
  Position end;          ///< the programmed point
  ContourPiece contour;  ///< what the tool touches
  ContourPiece path;     ///< of the tool's centre, corners aside
  double length;         ///< of `path`
};

[[nodiscard]] Position at_tip(const MachineState& state, const Position& programmed,
                              PlanePoint centre) {
  return with_plane_point(programmed, state.modal.plane, centre + state.compensation.to_tip);
}

void emit_straight(Execution& x, MoveKind kind, const Position& end) {
  if (kind == MoveKind::rapid) {
    x.emit(RapidMove{end});
  } else {
    x.emit(FeedMove{end});
  }
}

void emit_arc(Execution& x, const Position& end, PlanePoint centre, std::int32_t turns) {
  const PlanePoint shifted = centre + x.state().compensation.to_tip;
  x.emit(ArcMove{end, shifted.first, shifted.second, turns, x.state().modal.plane});
}

// --- corners -------------------------------------------------------------------------------------

/// Whether the contour turns towards the tool. Where it turns back (a cusp) rounding decides over
/// the sign of the angle; there the new piece leaves on that side of the old one to which both
/// bend.
[[nodiscard]] bool is_inside(const ContourPiece& before, const ContourPiece& after, double angle,
                             double offset) {
  const double bend = curvature_of(before) + curvature_of(after);
  const double straightness = std::numbers::pi - std::abs(angle);
  if (straightness < kCornerOfRounding && bend != 0.0) return bend * offset < 0.0;
  return straightness > kReversal && angle * offset > 0.0;
}

std::unexpected<Refusal> refuse_corner(const Execution& x, double angle, std::string why,
                                       std::string allowed) {
  return refuse(ErrorCode::compensation_inside_corner, x.code_span(),
                fmt::format("The contour turns by {:.1f} degrees towards the tool here. {}",
                            std::abs(angle) * 180.0 / std::numbers::pi, why),
                std::move(allowed));
}

/// Where the tool changes over in an inside corner.
Parsed<Crossing> find_crossing(const Execution& x, const ContourPiece& before, const Leg& leg,
                               double angle) {
  const CutterCompensation& comp = x.state().compensation;
  const double radius = std::abs(comp.offset);
  if (x.settings().strict && std::abs(angle) > kCornerOfRounding) {
    return refuse_corner(x, angle, "A round tool cannot touch both sides of an inside corner.",
                         fmt::format("An arc of more than {:.6g} mm in the corner.", radius));
  }
  if (!comp.held) {
    return refuse_corner(x, angle, "The tool had to stop there before it knew this move.",
                         "The stop or message at another place of the contour.");
  }
  const auto crossing = crossing_of(before, leg.path);
  // A line may vanish between its corners, an arc would become a full turn.
  const double least_before = before.is_arc() ? kSamePoint : -kSamePoint;
  const double least_after = leg.path.is_arc() ? kSamePoint : -kSamePoint;
  if (crossing && comp.length_left - crossing->back >= least_before &&
      leg.length - crossing->forward >= least_after) {
    return *crossing;
  }
  return refuse_corner(
      x, angle,
      fmt::format("A tool of {:.6g} mm radius does not fit: the moves are too short.", radius),
      "A smaller tool, or longer moves.");
}

/// The held-back move ends at `crossing`, and so does all that followed it without moving on.
void shorten_held_move(Execution& x, PlanePoint crossing) {
  const MachineState& state = x.state();
  for (std::size_t i = *state.compensation.held; i < x.commands().size(); ++i) {
    CommandBody& body = x.commands()[i].body;
    const auto bend = [&](Position& end) { end = at_tip(state, end, crossing); };
    if (auto* rapid = std::get_if<RapidMove>(&body)) bend(rapid->end);
    if (auto* feed = std::get_if<FeedMove>(&body)) bend(feed->end);
    if (auto* arc = std::get_if<ArcMove>(&body)) bend(arc->end);
  }
}

/// Around an outside corner at rapid: outside of the arc, because a chord would cut the corner.
void round_corner_by_rapids(Execution& x, PlanePoint corner, PlanePoint normal, double angle) {
  const MachineState& state = x.state();
  const double parts = std::ceil(std::abs(angle) / (std::numbers::pi / 2.0) - kReversal);
  const double part = angle / parts;
  const double reach = state.compensation.offset / std::cos(part / 2.0);
  for (double i = 0.5; i < parts; i += 1.0) {
    x.emit(RapidMove{at_tip(state, state.position, corner + reach * turned(normal, i * part))});
  }
}

/// In inverse time corner arc and move share the time of the move; afterwards its own part is set.
void share_inverse_time(Execution& x, double part, double whole) {
  const ModalState& modal = x.state().modal;
  if (modal.feed_mode != FeedMode::inverse_time || part <= 0.0) return;
  x.emit(SetFeedRate{modal.feed_mode, modal.feed * whole / part});
}

/// Around the corner at the end of `last`, with the tool's edge on it.
void round_corner(Execution& x, const Leg& leg, double angle) {
  const MachineState& state = x.state();
  const CutterCompensation& comp = state.compensation;
  const Position behind = at_tip(state, state.position, leg.path.start);
  const double outside_angle = -std::copysign(angle, comp.offset);
  const double arc_length = std::abs(angle * comp.offset);
  if (arc_length < kShortestCorner) {
    emit_straight(x, leg.kind, behind);
  } else if (leg.kind == MoveKind::rapid) {
    round_corner_by_rapids(x, comp.last.end, left_of(direction_at_end(comp.last)), outside_angle);
  } else {
    share_inverse_time(x, arc_length, arc_length + leg.length);
    emit_arc(x, behind, comp.last.end, outside_angle < 0.0 ? -1 : 1);
    share_inverse_time(x, leg.length, arc_length + leg.length);
  }
}

/// From the move before to `leg`; returns how much of its path the corner takes.
Parsed<double> pass_corner(Execution& x, const Leg& leg) {
  const CutterCompensation& comp = x.state().compensation;
  if (!comp.has_entered) return 0.0;
  const auto before = offset_piece(comp.last, comp.offset);
  if (distance(before->end, leg.path.start) <= kSamePoint) return 0.0;
  const double angle = corner_angle(comp.last, leg.contour);
  if (!is_inside(comp.last, leg.contour, angle, comp.offset)) {
    round_corner(x, leg, angle);
    return 0.0;
  }
  if (!comp.held && std::abs(angle) <= kCornerOfRounding) {
    emit_straight(x, leg.kind, at_tip(x.state(), x.state().position, leg.path.start));
    return 0.0;
  }
  const auto crossing = find_crossing(x, *before, leg, angle);
  if (!crossing) return std::unexpected(crossing.error());
  shorten_held_move(x, crossing->point);
  return crossing->forward;
}

// --- moves ---------------------------------------------------------------------------------------

Accepted follow(Execution& x, MoveKind kind, const Position& end, const ContourPiece& contour) {
  MachineState& state = x.state();
  CutterCompensation& comp = state.compensation;
  const auto path = offset_piece(contour, comp.offset);
  if (!path) {
    return refuse(ErrorCode::compensation_arc_too_small, x.code_span(),
                  fmt::format("The tool, {:.6g} mm in radius, does not fit into this arc.",
                              std::abs(comp.offset)),
                  "An arc larger than the tool, or a smaller tool.");
  }
  const Leg leg{kind, end, contour, *path, length_of(*path)};
  use_feed_for(x, end);
  const auto taken = pass_corner(x, leg);
  if (!taken) return std::unexpected(taken.error());

  comp.held = x.commands().size();
  comp.length_left = leg.length - *taken;
  const Position tip = at_tip(state, end, path->end);
  if (path->is_arc()) {
    emit_arc(x, tip, path->centre, path->turns);
  } else {
    emit_straight(x, kind, tip);
  }
  comp.last = contour;
  comp.tip = path->end + comp.to_tip;
  comp.has_entered = true;
  state.position = end;
  return {};
}

std::unexpected<Refusal> refuse_entry(const Execution& x) {
  return refuse(ErrorCode::compensation_gouging, x.code_span(),
                fmt::format("The tool, {:.6g} mm in radius, covers the end of this first move with "
                            "compensation already.",
                            std::abs(x.state().compensation.offset)),
                "A first move that begins more than the tool's radius away from its end.");
}

}  // namespace

Accepted follow_line(Execution& x, MoveKind kind, const Position& end) {
  MachineState& state = x.state();
  const CutterCompensation& comp = state.compensation;
  const Plane plane = state.modal.plane;
  const PlanePoint target = in_plane(end, plane);
  const PlanePoint from = comp.has_entered ? comp.last.end : in_plane(state.position, plane);
  if (distance(from, target) < kSamePoint) {  // up, down, or a turn of a rotary axis
    if (kind == MoveKind::feed) use_feed_for(x, end);
    emit_straight(x, kind, with_plane_point(end, plane, comp.tip));
    state.position = end;
    return {};
  }
  if (comp.has_entered) return follow(x, kind, end, {.start = from, .end = target, .centre = {}});
  const auto entry = entry_line(comp.centre(), target, comp.offset);
  return entry ? follow(x, kind, end, *entry) : refuse_entry(x);
}

Accepted follow_arc(Execution& x, const ArcMove& arc) {
  const MachineState& state = x.state();
  const CutterCompensation& comp = state.compensation;
  ContourPiece contour{.start = in_plane(state.position, arc.plane),
                       .end = in_plane(arc.end, arc.plane),
                       .centre = {arc.first_centre, arc.second_centre},
                       .turns = arc.turns};
  if (comp.awaits_entry()) {
    if (distance(comp.centre(), contour.end) <= std::abs(comp.offset)) return refuse_entry(x);
    // The auxiliary arc begins where it touches the tool.
    const PlanePoint outwards = comp.centre() - contour.centre;
    contour.start = contour.centre + distance(contour.centre, contour.end) /
                                         std::sqrt(dot(outwards, outwards)) * outwards;
  }
  return follow(x, MoveKind::feed, arc.end, contour);
}

// --- entry by an arc -----------------------------------------------------------------------------

namespace {

std::unexpected<Refusal> refuse_entry_arc(Span span, double missing) {
  return refuse(
      ErrorCode::compensation_entry_arc, span,
      fmt::format("This arc cannot lead the tool to the contour: it misses the tool's edge "
                  "by {:.4g} mm.",
                  missing),
      "A straight entry move before the arc.");
}

}  // namespace

// A triangle of tool, end and centre: the tool is `shorter` away from the centre, the end `size`.
Parsed<PlanePoint> entry_arc_centre(const CutterCompensation& compensation, PlanePoint end,
                                    double radius, bool clockwise, Span span) {
  const double size = std::abs(radius);
  const double at_tool = size + (clockwise ? 1.0 : -1.0) * compensation.offset;
  if (at_tool <= kSamePoint) {
    return refuse(ErrorCode::compensation_arc_too_small, span,
                  fmt::format("The tool, {:.6g} mm in radius, does not fit into this arc.",
                              std::abs(compensation.offset)),
                  "An arc larger than the tool, or a smaller tool.");
  }
  const PlanePoint tool = compensation.centre();
  const double apart = distance(tool, end);
  if (apart <= std::abs(compensation.offset)) {
    return refuse(ErrorCode::compensation_gouging, span,
                  "The tool covers the end of this first move with compensation already.",
                  "A first move that begins more than the tool's radius away from its end.");
  }
  if (apart > at_tool + size) return refuse_entry_arc(span, apart - at_tool - size);
  const PlanePoint along = 1.0 / apart * (end - tool);
  const double foot = (apart + (at_tool - size) * (at_tool + size) / apart) / 2.0;
  const double height = std::sqrt(std::max(0.0, (at_tool - foot) * (at_tool + foot)));
  const double side = clockwise != (radius < 0.0) ? -1.0 : 1.0;
  return tool + foot * along + side * height * left_of(along);
}

Accepted check_entry_centre(const CutterCompensation& compensation, PlanePoint end,
                            PlanePoint centre, bool clockwise, LengthUnit unit, Span span) {
  const double size = distance(centre, end);
  const double wanted = size + (clockwise ? 1.0 : -1.0) * compensation.offset;
  const double missing = std::abs(distance(centre, compensation.centre()) - wanted);
  if (wanted > kSamePoint && missing <= radius_tolerance(unit, size)) return {};
  return refuse_entry_arc(span, missing);
}

}  // namespace cnc::interp
