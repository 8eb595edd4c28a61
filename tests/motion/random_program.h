// Random programs for property tests: how they are made, and made smaller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "motion/planner.h"
#include "tests/motion/dice.h"

namespace cnc::motion::test {

/// What the operator does before a move is added.
enum class Event : std::uint8_t { none, hold, overrides };

/// A move, relative to where the one before it ends, so that any other may be left out.
struct ProgramStep {
  bool is_arc = false;
  Position way;
  Plane plane = Plane::xy;    // of an arc, as the following
  double first_centre = 0.0;  // from its start
  double second_centre = 0.0;
  std::int32_t turns = 1;
  MoveOptions options;
  Event event = Event::none;
  int draws = 0;  // setpoints drawn before the event
  double feed_override = 1.0;
  double rapid_override = 1.0;
};

struct RandomProgram {
  PlannerSettings settings;
  std::vector<ProgramStep> steps;

  [[nodiscard]] std::size_t size() const { return steps.size(); }
  [[nodiscard]] RandomProgram without(std::size_t first, std::size_t count) const;
  /// Offers programs that are simpler in one thing each, an option less, a number halved or
  /// rounded, until one is accepted; whether one was.
  using Accept = std::function<bool(RandomProgram)>;
  bool simplify(const Accept& accept) const;
};

/// What a random program may contain besides lines, arcs and rapids with one P.
struct Variety {
  bool modes = true;   ///< G61, G61.1, other P and Q in between
  bool events = true;  ///< hold, overrides, and a source that is slow now and then
  bool jerk = false;   ///< limits of jerk
};

/// Lines of 0.001 … 30 mm, arcs and helices, with random turns, limits of the axes and tolerances.
[[nodiscard]] RandomProgram random_program(Dice& dice, int moves, const Variety& variety = {});

}  // namespace cnc::motion::test
