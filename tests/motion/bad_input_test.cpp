// Extreme moves and extreme orders: none leaves the limits or the path.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "tests/motion/path_judge.h"
#include "tests/motion/program_judge.h"
#include "tests/motion/program_text.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

constexpr const char* kMachine =
    "(X Y Z: 100 100 100 mm/s, 500 500 500 mm/s2; setpoints of 0.005 s)\n";

/// Without limits of jerk, with the usual one and with one that hardly is one.
std::string any_machine() {
  const char* jerk =
      GENERATE("", "(jerk: 20000 20000 20000 mm/s3)\n", "(jerk: 1000000 1000000 1000000 mm/s3)\n");
  std::string text = kMachine;
  text += jerk;
  return text;
}

/// Corners, an arc, chords and a rapid: 0.02 mm of tolerance, some 150 setpoints.
std::vector<ProgramStep> mixed_moves() {
  return program_of(std::string(kMachine) +
                    "G64 P0.02\n"
                    "G1 X5 F3000\n"
                    "G1 Y5 F3000\n"
                    "G17 G3 X-4 I-2 J0 F3000\n"
                    "G1 X-0.1 Y-0.05 F3000\n"
                    "G1 X-0.1 Y-0.02 F3000\n"
                    "G1 X-0.1 Y0.03 F3000\n"
                    "G0 Z2\n"
                    "G61\n"
                    "G1 X-3 Y-1 F6000\n"
                    "G1 X-3 Y-1.02 F6000\n"
                    "G1 Z-2 F6000\n")
      .steps;
}

void add(Planner& planner, const ProgramStep& step) {
  const Position start = planner.queue_end();
  const Position end = start + step.way;
  if (!step.is_arc) {
    REQUIRE(planner.add_line(end, step.options));
    return;
  }
  REQUIRE(planner.add_arc({end, step.plane, start[Axis::X] + step.first_centre,
                           start[Axis::Y] + step.second_centre, step.turns},
                          step.options));
}

PlannerSettings settings_with(double jerk) {
  PlannerSettings settings = reference_settings();
  settings.limits.max_jerk = Position::filled(jerk);
  return settings;
}

/// Without and with limits of jerk.
double any_jerk() { return GENERATE(0.0, 20'000.0); }

/// A planner with mixed_moves(), what it does and where it goes.
class Machine {
 public:
  explicit Machine(double limit_of_jerk) : jerk(limit_of_jerk) {
    for (const ProgramStep& step : mixed_moves()) add(planner, step);
  }

  /// False when it stands.
  bool draw(int count) {
    for (int i = 0; i < count; ++i) {
      const auto setpoint = planner.next();
      if (!setpoint) return false;
      for (int part = 1; part <= 8; ++part) {
        Position p;
        for (const Axis axis : kLinearAxes) {
          p[axis] = cubic_of(axis, judge.position, judge.velocity, *setpoint)
                        .position(setpoint->duration * part / 8);
        }
        path.push_back(point_of(p));
      }
      judge.take(*setpoint);
    }
    return true;
  }
  void draw_to_the_end() {
    while (draw(1)) continue;
  }

  double jerk;
  Planner planner{settings_with(jerk), {}};
  LimitJudge judge{.limits = settings_with(jerk).limits, .position = {}, .velocity = {}};
  std::vector<Point> path;
};

/// The path of mixed_moves(), undisturbed, in steps that are small against the tolerance.
Polyline path_of(Machine& machine) {
  machine.draw_to_the_end();
  Polyline line(0.25);
  line.add({});
  for (const Point& point : machine.path) line.add(point);
  return line;
}

Polyline& undisturbed_path(double jerk) {
  static std::map<double, Polyline> paths;
  if (const auto known = paths.find(jerk); known != paths.end()) return known->second;
  Machine machine(jerk);
  return paths.emplace(jerk, path_of(machine)).first->second;
}

void require_limits(const Machine& machine) {
  CHECK(machine.judge.velocity_ratio <= 1.0 + 1e-6);
  CHECK(machine.judge.acceleration_ratio <= 1.0 + 1e-4);
  CHECK(machine.judge.jerk_ratio <= 1.0 + 1e-4);
}

void require_on_path(const Machine& machine) {
  require_limits(machine);
  double farthest = 0.0;
  for (const Point& point : machine.path) {
    farthest = std::max(farthest, undisturbed_path(machine.jerk).distance(point, farthest));
  }
  // Chords of 0.6 ms at 500 mm/s² lie within a t²/8 = 0.02 µm of the curve, twice.
  CHECK(farthest < 2e-4);
}

int setpoints_of_mixed_moves(double jerk) {
  Machine machine(jerk);
  machine.draw_to_the_end();
  return static_cast<int>(machine.judge.setpoints);
}

}  // namespace

TEST_CASE("Extreme moves, exact and smoothed, keep limits and path", "[MOT-2][MOT-4]") {
  const std::string machine = any_machine();
  const std::string mode = GENERATE("G61\n", "G61.1\n", "G64 P0.02\n", "G64 P0.02 Q0.005\n");
  const auto [name, moves] = GENERATE(table<std::string, std::string>({
      {"moves of a nanometre and less between long ones",
       "G1 X10 F6000\nG1 X1e-06 F6000\nG1 Y1e-07 F6000\nG1 Y5 F6000\nG1 X-2e-06 Y1e-06 F6000\n"
       "G1 X-3 F6000\n"},
      {"nothing but moves of zero length", "G1 X0 F6000\nG1 X0 F6000\nG1 F6000\n"},
      {"arcs of ten nanometres", "G1 X1 F6000\nG17 G3 X2e-05 I1e-05 J0 F6000\nG1 X1 F6000\n"},
      {"a full circle of a micrometre", "G1 X1 F6000\nG17 G2 I0.001 J0 F6000\nG1 X1 F6000\n"},
      {"a hundred millimetres of an arc of a kilometre",
       "G1 X1 F6000\nG17 G3 X-0.005 Y100 I-1000000 J0 F6000\nG1 X1 F6000\n"},
      {"full circles in all planes",
       "G17 G3 I5 J0 F6000\nG18 G2 I2 K1 F6000\nG19 G3 J-3 K0 F6000\n"},
      {"a helix of three turns", "G17 G3 X0 Z6 I4 J0 (turns 3) F6000\nG1 X1 F6000\n"},
      {"there and back, the same way",
       "G1 X5 F6000\nG1 X-5 F6000\nG1 X5 F6000\nG1 X-4.999 F6000\nG1 Y1 F6000\n"},
      {"reversals between moves of a micrometre",
       "G1 X0.001 F6000\nG1 X-0.001 F6000\nG1 X0.001 F6000\nG1 X-0.001 F6000\nG1 X1 F6000\n"},
      {"half circles that reverse into each other",
       "G17 G3 X-4 I-2 J0 F6000\nG17 G2 X4 I2 J0 F6000\nG17 G3 X-4 I-2 J0 F6000\n"},
      {"feeds far beyond the machine and next to nothing",
       "G1 X5 F60000000\nG1 Y5 F60000000\nG1 X0.01 F0.6\nG17 G3 X-4 I-2 J0 F60000000\n"},
  }));
  const Verdict verdict = judge(program_of(machine + mode + moves));
  INFO(machine << mode << name << ": " << verdict.to_string());
  CHECK(verdict.is_sound());
  CHECK(verdict.refused == 0);
}

TEST_CASE("A full circle of a kilometre is driven at the speed of fast axes", "[MOT-4]") {
  PlannerSettings settings = reference_settings();
  const double jerk = GENERATE(0.0, 1e6);
  settings.limits = {Position::filled(1e5), Position::filled(1e5), Position::filled(jerk)};
  Planner planner(settings, {});
  REQUIRE(planner.add_arc({{}, Plane::xy, 1e6, 0.0, 1}, feed_of(1e5)));
  const Trajectory trajectory = draw_all(planner);
  // Its 2π km at 100 m/s, of which the centripetal acceleration takes 10 of 100 m/s²: one second of
  // acceleration at either end costs half a second each, and 0.1 s to build it up.
  const double building_up = jerk > 0.0 ? 1e5 / jerk : 0.0;
  CHECK(trajectory.duration() == Approx(2e6 * 3.14159265 / 1e5 + 1.0 + building_up).epsilon(2e-3));
  CHECK(usage_of(trajectory, settings.limits).acceleration <= 1.0 + 1e-4);
  // Positions of 1e6 have a last digit of 1e-10, seen over the cube of the duration.
  double shortest = 1.0;
  for (const Setpoint& setpoint : trajectory.setpoints)
    shortest = std::min(shortest, setpoint.duration);
  const double rounding = 24.0 * 2e-10 / std::pow(shortest, 3);
  if (jerk > 0.0) CHECK(usage_of(trajectory, settings.limits).jerk <= 1.0 + rounding / jerk);
  CHECK(trajectory.end() == Position{});
}

TEST_CASE("Limits that are none are refused for every move that needs them", "[MOT-1]") {
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()}) {
    for (Position AxisLimits::*limit : {&AxisLimits::max_velocity, &AxisLimits::max_acceleration}) {
      PlannerSettings settings = reference_settings();
      settings.limits.*limit = Position::filled(none);
      Planner planner(settings, {});
      const auto refused = planner.add_line(xyz(1, 0), rapid());
      REQUIRE_FALSE(refused.has_value());
      CHECK(refused.error().code == ErrorCode::move_axis_without_limits);
      CHECK_FALSE(planner.add_arc({xyz(2, 0), Plane::xy, 1.0, 0.0, 1}, feed_of(10)));
      CHECK(planner.idle());
    }
  }
}

TEST_CASE("A limit of jerk that is none is no limit, or that of a millisecond", "[MOT-3]") {
  // 25 mm and back: 0.45 s each at 100 mm/s, with 0.1 s for each ramp; a millisecond for each half.
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(), 1e300}) {
    CAPTURE(none);
    PlannerSettings settings = settings_with(none);
    Planner planner(settings, {});
    REQUIRE(planner.add_line(xyz(25, 0), rapid()));
    REQUIRE(planner.add_line(xyz(0, 0), rapid()));
    const Trajectory driven = draw_all(planner);
    CHECK(driven.end() == Position{});
    CHECK(driven.duration() == Approx(0.9).epsilon(0.02));
    CHECK(usage_of(driven, reference_limits()).acceleration <= 1.0 + 1e-4);
  }
}

TEST_CASE("A hold at any setpoint, in a blend too, stays on the very path", "[MOT-2][MAN-9]") {
  const double jerk = any_jerk();
  for (int tick = 0; tick <= setpoints_of_mixed_moves(jerk); ++tick) {
    CAPTURE(tick);
    Machine machine(jerk);
    machine.draw(tick);
    machine.planner.hold();
    machine.draw_to_the_end();
    CHECK(machine.judge.velocity == Position{});
    machine.planner.resume();
    machine.draw_to_the_end();
    CHECK(machine.planner.idle());
    CHECK(machine.judge.position == machine.planner.queue_end());
    require_on_path(machine);
  }
}

TEST_CASE("Hold during hold, and resume while it still brakes", "[MOT-2][MAN-9]") {
  const double jerk = any_jerk();
  for (int tick = 1; tick <= setpoints_of_mixed_moves(jerk); tick += 3) {
    CAPTURE(tick);
    Machine machine(jerk);
    machine.draw(tick);
    for (const int later : {1, 2, 5, 3}) {
      machine.planner.hold();
      machine.draw(later);
      machine.planner.hold();
      machine.draw(1);
      CHECK(machine.planner.held());
      machine.planner.resume();
      machine.draw(2);
    }
    machine.draw_to_the_end();
    CHECK(machine.planner.idle());
    require_on_path(machine);
  }
}

TEST_CASE("An override of 0 at any setpoint stops on the path, and rapids go on",
          "[MOT-2][MAN-8]") {
  const double jerk = any_jerk();
  for (int tick = 0; tick <= setpoints_of_mixed_moves(jerk); tick += 2) {
    CAPTURE(tick);
    Machine machine(jerk);
    machine.draw(tick);
    machine.planner.set_overrides(0.0, 0.0);
    machine.draw_to_the_end();
    CHECK(machine.judge.velocity == Position{});
    machine.planner.set_overrides(2.0, 1.0);
    machine.draw_to_the_end();
    CHECK(machine.planner.idle());
    require_on_path(machine);
  }
}

TEST_CASE("An abort at any setpoint stops on the path, and other moves can follow from there",
          "[MOT-2][MAN-9]") {
  const double jerk = any_jerk();
  for (int tick = 0; tick <= setpoints_of_mixed_moves(jerk); ++tick) {
    CAPTURE(tick);
    Machine machine(jerk);
    machine.draw(tick);
    machine.planner.hold();
    machine.draw_to_the_end();
    require_on_path(machine);
    const Position stopped = machine.judge.position;
    REQUIRE(machine.planner.clear());
    CHECK(machine.planner.idle());
    CHECK(machine.planner.queue_end() == stopped);
    CHECK(machine.planner.position() == stopped);
    machine.planner.resume();
    CHECK_FALSE(machine.planner.next().has_value());
    REQUIRE(machine.planner.add_line(xyz(1, 1, 1), rapid()));
    machine.draw_to_the_end();
    CHECK(machine.judge.position == xyz(1, 1, 1));
    require_limits(machine);
  }
}

}  // namespace cnc::motion::test
