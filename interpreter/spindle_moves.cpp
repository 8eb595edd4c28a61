// G33 and G33.1: straight lines that follow the spindle (manual 3.4.9).
#include "interpreter/spindle_moves.h"

#include <fmt/format.h>

#include "interpreter/handlers.h"
#include "interpreter/moves.h"

namespace cnc::interp {
namespace {

struct SpindleMove {
  Position end;
  double pitch;
};

Parsed<SpindleMove> spindle_move_of(const Execution& x) {
  const Position end = target(x);
  if (Accepted leads = check_spindle_leads(x); !leads) return std::unexpected(leads.error());
  if (Accepted stay = check_rotary_axes_stay(x, end, ErrorCode::rotary_axis_would_turn); !stay) {
    return std::unexpected(stay.error());
  }
  const double pitch = x.block().value('K') * x.state().scale();
  if (pitch > 0.0) return SpindleMove{end, pitch};
  return refuse(
      ErrorCode::word_out_of_range, x.block().span_of('K'),
      fmt::format("{} cannot move {:.10g} per revolution.", x.code_name(), x.block().value('K')),
      "K above 0.");
}

}  // namespace

Accepted check_spindle_leads(const Execution& x) {
  const ModalState& modal = x.state().modal;
  if (modal.spindle == SpindleDirection::off) {
    return refuse(ErrorCode::spindle_not_turning, x.code_span(),
                  fmt::format("{} follows the spindle, which is off.", x.code_name()),
                  "M3 or M4 before it.");
  }
  if (!modal.speed_by_surface) return {};
  return refuse(
      ErrorCode::thread_in_surface_speed, x.code_span(),
      fmt::format("{} cannot follow a spindle whose speed changes with X (G96).", x.code_name()),
      "G97 and S before it.");
}

void move_with_spindle(Execution& x, const Position& end, double pitch) {
  x.emit(SyncMove{end, pitch});
  x.state().position = end;
}

Accepted spindle_move(Execution& x) {
  const auto move = spindle_move_of(x);
  if (!move) return std::unexpected(move.error());
  move_with_spindle(x, move->end, move->pitch);
  x.state().modal.motion = x.code();
  return {};
}

// The manual ends with the way back; the spindle then turns as the modal state says, so that the
// next hole needs no M3.
Accepted spindle_move_there_and_back(Execution& x) {
  const auto move = spindle_move_of(x);
  if (!move) return std::unexpected(move.error());
  const Position start = x.state().position;
  const SpindleDirection direction = x.state().modal.spindle;
  move_with_spindle(x, move->end, move->pitch);
  x.emit(TurnSpindle{reversed(direction)});
  move_with_spindle(x, start, move->pitch);
  x.emit(TurnSpindle{direction});
  x.state().modal.motion = x.code();
  return {};
}

}  // namespace cnc::interp
