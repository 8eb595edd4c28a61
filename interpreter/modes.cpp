// G17-G21, G61-G64, G90, G91, G98, G99, G53: what only changes how later words are read.
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"

namespace cnc::interp {
namespace {

/// A length of the line that must not be negative, in mm.
Parsed<std::optional<double>> tolerance_word(const Execution& x, char letter, double scale) {
  const auto value = x.block().find(letter);
  if (!value) return std::nullopt;
  if (*value >= 0.0) return *value * scale;
  return refuse(ErrorCode::word_out_of_range, x.block().span_of(letter),
                fmt::format("{} of {} cannot be negative.", letter, x.code_name()), "0 or more.");
}

}  // namespace

Accepted select_plane(Execution& x) {
  const Plane plane = plane_of(x.code());
  x.state().modal.plane = plane;
  x.emit(SelectPlane{plane});
  return {};
}

Accepted use_length_unit(Execution& x) {
  const LengthUnit unit = unit_of(x.code());
  x.state().modal.unit = unit;
  x.emit(UseLengthUnit{unit});
  return {};
}

Accepted set_path_control(Execution& x) {
  SetPathMode path;
  path.mode = x.code() == 640   ? PathMode::continuous
              : x.code() == 611 ? PathMode::exact_stop
                                : PathMode::exact_path;
  const double scale = x.state().scale();
  const auto tolerance = tolerance_word(x, 'P', scale);
  if (!tolerance) return std::unexpected(tolerance.error());
  const auto simplification = tolerance_word(x, 'Q', scale);
  if (!simplification) return std::unexpected(simplification.error());
  const auto angle = tolerance_word(x, 'R', 1.0);
  if (!angle) return std::unexpected(angle.error());
  path.tolerance = *tolerance;
  path.simplification = *simplification;
  path.laf_angle = *angle;
  x.state().modal.path = path;
  x.emit(path);
  return {};
}

// Contouring runs through where lines and arcs are tangent (PSCNC 3.2), which G61 does; without it
// every move ends at rest.
Accepted switch_contouring(Execution& x) {
  constexpr std::int32_t kContouringOn = 21;
  SetPathMode& path = x.state().modal.path;
  path.mode = x.code() == kContouringOn ? PathMode::exact_path : PathMode::exact_stop;
  x.emit(path);
  return {};
}

Accepted set_distance_mode(Execution& x) {
  x.state().modal.distance = x.code() == 900 ? DistanceMode::absolute : DistanceMode::incremental;
  return {};
}

Accepted set_arc_distance_mode(Execution& x) {
  x.state().modal.arc_distance =
      x.code() == 901 ? DistanceMode::absolute : DistanceMode::incremental;
  return {};
}

Accepted set_retract_mode(Execution& x) {
  x.state().modal.retract = x.code() == 980 ? RetractMode::old_position : RetractMode::r_position;
  return {};
}

// Read by the motion of the same line.
Accepted use_machine_coordinates(Execution&) { return {}; }

}  // namespace cnc::interp
