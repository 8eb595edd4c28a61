// Programmed moves in, moves of the compensated tool out (docs/cutter-compensation.md).
#pragma once

#include "interpreter/execution.h"
#include "interpreter/moves.h"

namespace cnc::interp {

enum class MoveKind : std::uint8_t { rapid, feed };

/// The straight move to `end`, the programmed point in machine coordinates.
[[nodiscard]] Accepted follow_line(Execution& x, MoveKind kind, const Position& end);
/// Likewise the arc, whose `end` is the programmed point.
[[nodiscard]] Accepted follow_arc(Execution& x, const ArcMove& arc);

/// The centre of an entry arc given by its radius; manual A.2, figure A-7.
[[nodiscard]] Parsed<PlanePoint> entry_arc_centre(const CutterCompensation& compensation,
                                                  PlanePoint end, double radius, bool clockwise,
                                                  Span span);
/// Refuses a centre from which the entry arc cannot be constructed.
[[nodiscard]] Accepted check_entry_centre(const CutterCompensation& compensation, PlanePoint end,
                                          PlanePoint centre, bool clockwise, LengthUnit unit,
                                          Span span);

}  // namespace cnc::interp
