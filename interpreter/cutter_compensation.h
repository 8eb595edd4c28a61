// G40, G41, G42, G41.1, G42.1: the tool beside the programmed path (manual 3.4.11 and chapter 5,
// docs/cutter-compensation.md).
//
// Moves are understood as always: MachineState::position is the programmed point. On their way out
// they pass through contour_following.h, which sends the tool's centre along beside them. An inside
// corner shortens the move before it, so the last move is held back until the next one is known,
// and with it what follows it in the queue (Execution::ready_count()).
#pragma once

#include <cstddef>
#include <optional>

#include "interpreter/contour.h"

namespace cnc::interp {

class Execution;

/// What compensation knows from line to line. Points are machine coordinates in the active plane.
struct CutterCompensation {
  /// Of the tool's centre to the left of the path, mm; negative = to the right. 0 = nothing to do.
  double offset = 0.0;
  PlanePoint to_tip;         ///< from the centre to the controlled point: turning tools
  PlanePoint tip;            ///< where the commands so far take the controlled point
  bool has_entered = false;  ///< the entry move is made: what follows has a meaning
  ContourPiece last;         ///< of the contour
  double length_left = 0.0;  ///< of the path beside it, of what the corner at its start left, mm
  /// Index in the queue of the move beside `last`, while its end is still open.
  std::optional<std::size_t> held;

  [[nodiscard]] bool acts() const { return offset != 0.0; }
  [[nodiscard]] bool awaits_entry() const { return acts() && !has_entered; }
  [[nodiscard]] PlanePoint centre() const { return tip - to_tip; }
  /// The controlled point has been moved by hand: the next move is an entry move again.
  void put_tip(PlanePoint point);

  friend bool operator==(const CutterCompensation&, const CutterCompensation&) = default;
};

/// Refuses a code that cannot be carried out while compensation is on.
[[nodiscard]] Accepted check_under_compensation(const Execution& x);
/// The tool stays where it is; that is the programmed point from now on.
void end_compensation(Execution& x);

}  // namespace cnc::interp
