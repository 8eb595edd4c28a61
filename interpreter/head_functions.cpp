// M90 … M97: which spindle, probe or camera is at the tool point, and where it sits beside the
// first spindle (manual 3.5.2, 3.5.6, probing and camera set-up).
#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"
#include "interpreter/spindle.h"
#include "interpreter/words.h"

namespace cnc::interp {
namespace {

struct HeadCode {
  std::int32_t code;
  Head head;
};
// Spindle 2 is M92 in the manual's text (3.5.2, 3.5.6, #5390) and M93 in table 3-6.
constexpr auto kHeadCodes = std::to_array<HeadCode>({{90, Head::spindle_0},
                                                     {91, Head::spindle_1},
                                                     {92, Head::spindle_2},
                                                     {93, Head::spindle_2},
                                                     {95, Head::probe},
                                                     {97, Head::camera}});

[[nodiscard]] Head head_of(std::int32_t code) {
  return std::ranges::find(kHeadCodes, code, &HeadCode::code)->head;
}

/// The first spindle has set work zero on a point, and the head stands on the same point now: the
/// way between the two is its offset.
Parsed<Position> measured_offset(const Execution& x) {
  const MachineState& state = x.state();
  if (state.modal.head != Head::spindle_0) {
    return refuse(ErrorCode::head_not_measurable, x.block().span_of('Q'),
                  fmt::format("{} Q1 measures from the first spindle, and another head is active.",
                              x.code_name()),
                  "M90, zero X Y Z at a point, move the head to that point, then Q1.");
  }
  const Position way = state.position - state.coordinates.to_machine({});
  Position offset;
  for (const Axis axis : kLinearAxes) offset[axis] = way[axis];
  return offset;
}

/// Up before the way across, down behind it: the heads are not equally long.
void move_across(Execution& x, const Position& end) {
  Position corner = x.state().position;
  const bool goes_up = end[Axis::Z] > corner[Axis::Z];
  if (goes_up) {
    corner[Axis::Z] = end[Axis::Z];
  } else {
    corner = end;
    corner[Axis::Z] = x.state().position[Axis::Z];
  }
  for (const Position& point : {corner, end}) {
    if (point != x.state().position) move_rapid(x, point);
  }
}

}  // namespace

// The spindle is stopped: what would stop it afterwards are the outputs of the new head.
Accepted select_head(Execution& x) {
  if (Accepted one = check_not_both(x, 'P', 'Q'); !one) return one;
  const auto moves = switch_word(x, 'P', false);
  if (!moves) return std::unexpected(moves.error());
  const auto measures = switch_word(x, 'Q', false);
  if (!measures) return std::unexpected(measures.error());

  MachineState& state = x.state();
  const Head head = head_of(x.code());
  Position offset = x.head_offset(head);
  // Checks, predictions and searches do not stand where the operator would have moved the head.
  if (*measures && !state.rendering) {
    const auto measured = measured_offset(x);
    if (!measured) return std::unexpected(measured.error());
    offset = *measured;
    x.keep_head_offset({head, offset});
  }
  const Position way = offset - state.coordinates.head_offset();
  if (head != state.modal.head) stop_spindle(x);
  state.modal.head = head;
  state.coordinates.set_head_offset(offset);
  x.emit(SelectHead{head, offset});
  if (*moves) move_across(x, state.position + way);
  return {};
}

}  // namespace cnc::interp
