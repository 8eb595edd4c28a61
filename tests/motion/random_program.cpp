#include "tests/motion/random_program.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/core.h>
#include <fmt/format.h>
#include <iterator>

namespace cnc::motion::test {

namespace {

// --- making them ---------------------------------------------------------------------------------

AxisLimits random_limits(Dice& dice) {
  AxisLimits limits{Position::filled(360.0), Position::filled(1800.0)};
  const double velocity = dice.scale(10.0, 500.0);
  const double acceleration = dice.scale(50.0, 10'000.0);
  const bool alike = dice.chance(0.3);
  for (const Axis axis : kLinearAxes) {
    limits.max_velocity[axis] = alike ? velocity : velocity * dice.scale(0.2, 5.0);
    limits.max_acceleration[axis] = alike ? acceleration : acceleration * dice.scale(0.2, 5.0);
  }
  return limits;
}

/// X Y Z reach their acceleration within 5 … 200 ms, the rotary axes within 50 ms.
Position random_jerk(Dice& dice, const Position& acceleration) {
  Position jerk = acceleration * 20.0;
  const double time = dice.scale(0.005, 0.2);
  const bool alike = dice.chance(0.5);
  for (const Axis axis : kLinearAxes) {
    jerk[axis] = acceleration[axis] / (alike ? time : time * dice.scale(0.5, 2.0));
  }
  return jerk;
}

/// How the moves of one program look, and the modes that are in force.
struct Manner {
  double size;
  double turn;
  double arcs;
  double rapids;
  double tolerance;
  double simplify = 0.0;
  bool exact_stop = false;
  double heading = 0.0;
};

void change_mode(Dice& dice, Manner& manner) {
  const int mode = dice.pick(4);
  manner.exact_stop = mode == 1;
  manner.tolerance = mode < 2 ? 0.0 : dice.scale(0.002, 1.0);
  manner.simplify = mode != 1 && dice.chance(0.3) ? dice.scale(1e-4, 0.1) : 0.0;
}

MoveOptions random_options(Dice& dice, const Manner& manner) {
  MoveOptions options;
  options.kind = dice.chance(manner.rapids) ? MoveKind::rapid : MoveKind::feed;
  options.feed = options.kind == MoveKind::feed ? dice.scale(0.5, 500.0) : 0.0;
  options.tolerance = manner.tolerance;
  options.simplify = manner.simplify;
  options.stop_at_end = manner.exact_stop || dice.chance(0.01);
  return options;
}

void random_line(Dice& dice, Manner& manner, ProgramStep& step) {
  manner.heading += dice.between(-manner.turn, manner.turn);
  const double length = dice.scale(0.001, manner.size);
  step.way[Axis::X] = length * std::cos(manner.heading);
  step.way[Axis::Y] = length * std::sin(manner.heading);
  if (dice.chance(0.3)) step.way[Axis::Z] = length * dice.between(-1.0, 1.0);
  if (dice.chance(0.02)) step.way[Axis::A] = dice.between(-5.0, 5.0);
}

void random_arc_step(Dice& dice, const Manner& manner, ProgramStep& step) {
  const ArcShape arc = random_arc(dice, {}, manner.size);
  step.is_arc = true;
  step.way = arc.end;
  step.plane = arc.plane;
  step.first_centre = arc.first_centre;
  step.second_centre = arc.second_centre;
  step.turns = arc.turns;
}

void random_event(Dice& dice, ProgramStep& step) {
  step.draws = dice.chance(0.05) ? dice.pick(40) : 0;
  if (!dice.chance(0.02)) return;
  step.draws = dice.pick(100);
  step.event = dice.chance(0.5) ? Event::hold : Event::overrides;
  if (step.event == Event::hold) return;
  step.feed_override = dice.chance(0.1) ? 0.0 : dice.scale(0.05, 3.0);
  step.rapid_override = dice.chance(0.1) ? 0.0 : dice.scale(0.05, 1.0);
}

// --- simpler ones --------------------------------------------------------------------------------

/// Smaller numbers are not halved any more.
constexpr double kSmallest = 0.002;

double rounded(double value, int digits) {
  return value == 0.0 ? 0.0 : std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

/// Calls accept(number) with simpler numbers than `value`.
template <typename Accept>
void simpler_numbers(double value, Accept accept) {
  if (value == 0.0) return;
  accept(0.0);
  for (const int digits : {1, 2, 3}) {
    if (rounded(value, digits) == value) break;
    accept(rounded(value, digits));
  }
  if (std::abs(value) >= kSmallest) accept(0.5 * value);
}

/// Offers programs that differ from `program` in one thing, until one is accepted.
class Simplifications {
 public:
  Simplifications(const RandomProgram& program, const RandomProgram::Accept& accept)
      : program_(program), accept_(accept) {}

  template <typename Change>
  void add(Change change) {
    if (accepted_) return;
    RandomProgram candidate = program_;
    change(candidate);
    accepted_ = accept_(std::move(candidate));
  }
  /// `field` gives the number in a program.
  template <typename Field>
  void number(Field field) {
    if (accepted_) return;
    RandomProgram copy = program_;
    simpler_numbers(field(copy), [&](double value) {
      add([&](RandomProgram& candidate) { field(candidate) = value; });
    });
  }
  [[nodiscard]] bool accepted() const { return accepted_; }

 private:
  const RandomProgram& program_;
  const RandomProgram::Accept& accept_;
  bool accepted_ = false;
};

void simplify_settings(const RandomProgram& program, Simplifications& offers) {
  const PlannerSettings plain;
  if (program.settings.max_setpoint_duration != plain.max_setpoint_duration) {
    offers.add(
        [&](RandomProgram& p) { p.settings.max_setpoint_duration = plain.max_setpoint_duration; });
  }
  const auto all_alike = [](const Position& values) {
    return values[Axis::X] == values[Axis::Y] && values[Axis::Y] == values[Axis::Z];
  };
  if (program.settings.limits.limit_jerk()) {
    offers.add([](RandomProgram& p) { p.settings.limits.max_jerk = {}; });
  }
  for (Position AxisLimits::*limit :
       {&AxisLimits::max_velocity, &AxisLimits::max_acceleration, &AxisLimits::max_jerk}) {
    if (!all_alike(program.settings.limits.*limit)) {
      offers.add([&](RandomProgram& p) {
        Position& values = p.settings.limits.*limit;
        values[Axis::Y] = values[Axis::Z] = values[Axis::X];
      });
    }
    for (const Axis axis : kLinearAxes) {
      const double value = (program.settings.limits.*limit)[axis];
      for (const int digits : {1, 2}) {
        if (rounded(value, digits) == value) break;
        offers.add(
            [&](RandomProgram& p) { (p.settings.limits.*limit)[axis] = rounded(value, digits); });
      }
    }
  }
}

void simplify_options(const RandomProgram& program, std::size_t i, Simplifications& offers) {
  const ProgramStep& step = program.steps[i];
  if (step.event != Event::none || step.draws > 0) {
    offers.add([i](RandomProgram& p) {
      p.steps[i].event = Event::none;
      p.steps[i].draws = 0;
    });
    if (step.draws > 0) offers.add([i](RandomProgram& p) { p.steps[i].draws /= 2; });
  }
  if (step.options.stop_at_end) {
    offers.add([i](RandomProgram& p) { p.steps[i].options.stop_at_end = false; });
  }
  if (step.options.kind == MoveKind::feed && step.options.feed != 100.0) {
    offers.add([i](RandomProgram& p) { p.steps[i].options.feed = 100.0; });
  }
  offers.number([i](RandomProgram& p) -> double& { return p.steps[i].options.simplify; });
  offers.number([i](RandomProgram& p) -> double& { return p.steps[i].options.tolerance; });
  if (i > 0 && step.options.tolerance != program.steps[i - 1].options.tolerance) {
    offers.add(
        [i](RandomProgram& p) { p.steps[i].options.tolerance = p.steps[i - 1].options.tolerance; });
  }
}

void simplify_geometry(const RandomProgram& program, std::size_t i, Simplifications& offers) {
  const ProgramStep& step = program.steps[i];
  if (step.is_arc) {
    offers.add([i](RandomProgram& p) { p.steps[i].is_arc = false; });
    // Its ends have to stay on the circle, so that it is halved as a whole.
    if (std::hypot(step.first_centre, step.second_centre) >= kSmallest) {
      offers.add([i](RandomProgram& p) {
        p.steps[i].way *= 0.5;
        p.steps[i].first_centre *= 0.5;
        p.steps[i].second_centre *= 0.5;
      });
    }
    const Axis third = axes_of(step.plane).third;
    offers.number([=](RandomProgram& p) -> double& { return p.steps[i].way[third]; });
    offers.number([=](RandomProgram& p) -> double& { return p.steps[i].way[Axis::A]; });
    return;
  }
  for (const Axis axis : kAllAxes) {
    offers.number([=](RandomProgram& p) -> double& { return p.steps[i].way[axis]; });
  }
}

}  // namespace

RandomProgram random_program(Dice& dice, int moves, const Variety& variety) {
  RandomProgram program;
  program.settings.limits = random_limits(dice);
  if (variety.jerk) {
    AxisLimits& limits = program.settings.limits;
    limits.max_jerk = random_jerk(dice, limits.max_acceleration);
  }
  program.settings.max_setpoint_duration = dice.scale(0.001, 0.02);
  Manner manner{.size = dice.scale(0.01, 30.0),
                .turn = dice.scale(0.01, 3.14),
                .arcs = dice.chance(0.5) ? 0.0 : dice.scale(0.01, 0.5),
                .rapids = dice.chance(0.5) ? 0.0 : dice.scale(0.005, 0.2),
                .tolerance = dice.scale(0.002, 1.0)};
  for (int i = 0; i < moves; ++i) {
    if (variety.modes && dice.chance(0.02)) change_mode(dice, manner);
    ProgramStep step;
    step.options = random_options(dice, manner);
    if (step.options.kind == MoveKind::feed && dice.chance(manner.arcs)) {
      random_arc_step(dice, manner, step);
    } else {
      random_line(dice, manner, step);
    }
    if (variety.events) random_event(dice, step);
    program.steps.push_back(step);
  }
  return program;
}

RandomProgram RandomProgram::without(std::size_t first, std::size_t count) const {
  RandomProgram shorter{settings, {}};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i < first || i >= first + count) shorter.steps.push_back(steps[i]);
  }
  return shorter;
}

bool RandomProgram::simplify(const Accept& accept) const {
  Simplifications offers(*this, accept);
  simplify_settings(*this, offers);
  for (std::size_t i = 0; i < steps.size() && !offers.accepted(); ++i) {
    simplify_options(*this, i, offers);
    simplify_geometry(*this, i, offers);
  }
  return offers.accepted();
}

}  // namespace cnc::motion::test
