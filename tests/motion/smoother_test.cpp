// G64: the path stays inside its tube, globally and both ways, and is fast because it uses it.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/motion/dice.h"
#include "tests/motion/path_judge.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

MoveOptions smooth(double feed, double tolerance) {
  MoveOptions options = feed_of(feed);
  options.tolerance = tolerance;
  return options;
}

/// A planner that is drawn from while moves are added, and what came of it.
class Drive {
 public:
  explicit Drive(const PlannerSettings& settings, double tolerance)
      : planner_(settings, {}),
        programmed_(std::max(0.25, 3.0 * tolerance)),
        driven_(std::max(0.25, 3.0 * tolerance)),
        tolerance_(tolerance),
        judge_{.limits = settings.limits, .position = {}, .velocity = {}} {
    programmed_.add({});
    driven_.add({});
  }

  void line(const Position& end, const MoveOptions& options) {
    REQUIRE(planner_.add_line(end, options));
    programmed_.add(point_of(end));
    draw_while_full();
  }
  void arc(const ArcShape& shape, const MoveOptions& options) {
    const auto arc = make_arc(planner_.queue_end(), shape);
    REQUIRE(arc);
    REQUIRE(planner_.add_arc(shape, options));
    // Chords that leave the arc by a thousandth of the tolerance: R φ²/8.
    const double radius = std::max(arc->radius(0.0), arc->radius(arc->length()));
    const double angle = std::sqrt(8e-3 * options.tolerance / radius);
    const int chords = 1 + static_cast<int>(std::abs(arc->sweep()) / angle);
    for (int i = 1; i <= chords; ++i) {
      programmed_.add(point_of(arc->point(arc->length() * i / chords)));
    }
    draw_while_full();
  }
  void finish() {
    while (!planner_.idle()) draw();
  }
  void draw() {
    const auto setpoint = planner_.next();
    if (!setpoint) return;
    // Chords that leave the motion by a hundredth of the tolerance: a t²/8.
    const double a = judge_.limits.max_acceleration[Axis::X];
    const int parts = 1 + static_cast<int>(setpoint->duration / std::sqrt(0.05 * tolerance_ / a));
    for (int i = 1; i <= parts; ++i) {
      Position p;
      for (const Axis axis : kAllAxes) {
        p[axis] = cubic_of(axis, judge_.position, judge_.velocity, *setpoint)
                      .position(setpoint->duration * i / parts);
      }
      driven_.add(point_of(p));
    }
    judge_.take(*setpoint);
  }

  [[nodiscard]] const LimitJudge& judge() const { return judge_; }
  [[nodiscard]] const Planner& planner() const { return planner_; }
  [[nodiscard]] double path_to_program() const { return largest_distance(driven_, programmed_); }
  [[nodiscard]] double program_to_path() const { return largest_distance(programmed_, driven_); }

 private:
  void draw_while_full() {
    while (planner_.full()) draw();
  }

  Planner planner_;
  Polyline programmed_;
  Polyline driven_;
  double tolerance_;
  LimitJudge judge_;
};

void circle_of_chords(Drive& drive, int chords, double radius, const MoveOptions& options) {
  for (int i = 1; i <= chords; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / chords;
    drive.line(xyz(radius * std::cos(phi) - radius, radius * std::sin(phi)), options);
  }
  drive.finish();
}

void require_inside(const Drive& drive, double tolerance) {
  CHECK(drive.judge().velocity_ratio <= 1.0 + 1e-6);
  CHECK(drive.judge().acceleration_ratio <= 1.0 + 1e-4);
  CHECK(drive.judge().feed_ratio <= 1.0 + 1e-6);
  CHECK(drive.path_to_program() <= tolerance);
  CHECK(drive.program_to_path() <= tolerance);
  CHECK(drive.judge().position == drive.planner().queue_end());
}

}  // namespace

TEST_CASE("The manual's circle of 6° chords runs at F6000 with G64 P0.05", "[MOT-2][GCO-6]") {
  Drive drive(reference_settings(), 0.05);
  circle_of_chords(drive, 60, 50.0, smooth(100.0, 0.05));
  require_inside(drive, 0.05);
  // 314.0 mm at 100 mm/s and two ramps of 0.1 s: 3.34 s.
  CHECK(drive.judge().time < 3.36);
}

TEST_CASE("A tighter tube costs time, and the path stays in it", "[MOT-2]") {
  Drive drive(reference_settings(), 0.01);
  circle_of_chords(drive, 60, 50.0, smooth(100.0, 0.01));
  require_inside(drive, 0.01);
  CHECK(drive.judge().time < 4.0);
  CHECK(drive.judge().time > 3.34);
}

TEST_CASE("The manual's square is rounded by no more than P", "[MOT-2]") {
  const double p = GENERATE(0.1, 0.2, 0.5, 1.0);
  CAPTURE(p);
  Drive drive(reference_settings(), p);
  for (const Position& corner : {xyz(10, 0), xyz(10, 10), xyz(0, 10), xyz(0, 0)}) {
    drive.line(corner, smooth(2000.0 / 60.0, p));
  }
  drive.finish();
  require_inside(drive, p);
  // Exact stops: four times 10 mm at 33.3 mm/s with ramps of 66.7 ms.
  CHECK(drive.judge().time < 4.0 * (10.0 / (2000.0 / 60.0) + (2000.0 / 60.0) / 500.0) - 0.04);
}

TEST_CASE("Less use of the tolerance brings the path nearer and takes longer", "[MOT-2]") {
  PlannerSettings near = reference_settings();
  near.tolerance_use = 0.0;
  Drive careful(near, 0.05);
  Drive fast(reference_settings(), 0.05);
  for (Drive* drive : {&careful, &fast}) {
    for (int i = 1; i <= 200; ++i) {
      drive->line(xyz(0.5 * i, i % 2 == 0 ? 0.0 : 0.1), smooth(100.0, 0.05));
    }
    drive->finish();
    require_inside(*drive, 0.05);
  }
  CHECK(careful.path_to_program() < fast.path_to_program());
  CHECK(careful.judge().time > fast.judge().time);
}

TEST_CASE("A straight line cut into pieces takes no longer than in one", "[MOT-1]") {
  Drive drive(reference_settings(), 0.02);
  for (int i = 1; i <= 1000; ++i) drive.line(xyz(0.1 * i, 0.05 * i), smooth(80.0, 0.02));
  drive.finish();
  require_inside(drive, 1e-6);
  // 111.80 mm at 80 mm/s; X may use 500 mm/s², the path 559.0: a ramp of 0.1431 s at each end.
  CHECK(drive.judge().time == Approx(111.8034 / 80.0 + 80.0 / 559.017).epsilon(2e-3));
}

TEST_CASE("The direction reversed is a stop at the very point", "[MOT-2]") {
  Drive drive(reference_settings(), 0.5);
  drive.line(xyz(20, 0), smooth(100.0, 0.5));
  drive.line(xyz(0, 1), smooth(100.0, 0.5));
  drive.finish();
  require_inside(drive, 1e-6);
}

TEST_CASE("Rapids and exact stops end a smoothed run exactly", "[MOT-2]") {
  Drive drive(reference_settings(), 0.5);
  MoveOptions exact = smooth(100.0, 0.5);
  exact.stop_at_end = true;
  drive.line(xyz(10, 0), exact);
  drive.line(xyz(10, 10), smooth(100.0, 0.5));
  drive.line(xyz(0, 10), rapid());
  drive.line(xyz(0, 0), smooth(100.0, 0.5));
  drive.finish();
  require_inside(drive, 1e-6);
}

TEST_CASE("A hole drilled with G64 is entered without a stop between rapid and feed", "[MOT-1]") {
  Drive drive(reference_settings(), 0.02);
  drive.line(xyz(0, 0, -20), rapid());
  drive.line(xyz(0, 0, -40), smooth(25, 0.02));
  drive.finish();
  // To 100 mm/s and down to 25: 10 mm in 0.2 s, 0.625 mm in 0.00625 s, 9.375 mm in 0.15 s; then
  // 19.375 mm in 0.775 s and 0.625 mm in 0.05 s.
  CHECK(drive.judge().time == Approx(1.18125).epsilon(1e-6));
  require_inside(drive, 1e-6);
}

TEST_CASE("While more is coming the smoothed path stays open", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  const MoveOptions options = smooth(100.0, 0.02);
  REQUIRE(planner.add_line(xyz(1, 0), options));
  CHECK_FALSE(planner.next(Supply::coming));  // not even placed: the next vertices decide
  CHECK_FALSE(planner.idle());
  REQUIRE(planner.add_line(xyz(2, 0), options));
  double time = 0.0;
  while (const auto setpoint = planner.next()) time += setpoint->duration;
  CHECK(planner.position() == xyz(2, 0));
  // One motion of 2 mm from rest to rest: 2 √(2/500).
  CHECK(time == Approx(2.0 * std::sqrt(2.0 / 500.0)).epsilon(1e-2));
}

TEST_CASE("Extreme moves are smoothed within the limits", "[MOT-2]") {
  const double p = GENERATE(1e-3, 0.02, 1.0, 100.0);
  CAPTURE(p);
  const MoveOptions options = smooth(100.0, p);
  Drive drive(reference_settings(), p);
  SECTION("moves of a nanometre to a kilometre, back and forth") {
    double x = 0.0;
    for (const double length : {1e-6, 1e-3, 1e3, 1e-5, 1.0, 1e-2, -1e2, 1e-4, 1e1, 1e-6}) {
      x += length;
      drive.line(xyz(x, std::abs(length)), options);
    }
  }
  SECTION("the same point over and over") {
    for (int i = 0; i < 20; ++i) drive.line(xyz(1, 1), options);
  }
  SECTION("full circles, a micrometre to ten metres") {
    for (const double radius : {1e-3, 0.1, 5.0, 1e4}) {
      const Position at = drive.planner().queue_end();
      drive.arc({at, Plane::xy, at[Axis::X] + radius, at[Axis::Y], 1}, options);
      drive.line(xyz(at[Axis::X] + 3.0, at[Axis::Y] + 1.0), options);
    }
  }
  SECTION("there and back") {
    for (int i = 0; i < 6; ++i) drive.line(xyz(i % 2 == 0 ? 10.0 : 0.0, 0), options);
  }
  drive.finish();
  require_inside(drive, p);
}

TEST_CASE("A tolerance that is none is refused and nothing queued", "[MOT-2]") {
  Planner planner(reference_settings(), {});
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {-1e-9, std::nan(""), infinite}) {
    CHECK_FALSE(planner.add_line(xyz(1, 0), smooth(100.0, bad)));
    MoveOptions options = feed_of(100.0);
    options.simplify = bad;
    CHECK_FALSE(planner.add_line(xyz(1, 0), options));
  }
  CHECK(planner.idle());
}

TEST_CASE("Tolerances that change from move to move are kept", "[MOT-2][property]") {
  const auto seed = static_cast<std::uint32_t>(GENERATE(range(1, 41)));
  CAPTURE(seed);
  Dice dice(seed);
  const double tight = dice.scale(1e-4, 1e-2);
  const double wide = dice.scale(0.1, 2.0);
  const double size = dice.scale(0.01, 5.0);
  Drive drive(reference_settings(), wide);
  double heading = 0.0;
  for (int i = 0; i < 200; ++i) {
    heading += dice.between(-2.4, 2.4);
    Position end = drive.planner().queue_end();
    const double length = dice.scale(0.1 * size, size);
    end[Axis::X] += length * std::cos(heading);
    end[Axis::Y] += length * std::sin(heading);
    drive.line(end, smooth(100.0, dice.chance(0.5) ? tight : wide));
  }
  drive.finish();
  require_inside(drive, wide);
}

TEST_CASE("Axes that turn along are in the tube with their degrees", "[MOT-2][GCO-6][property]") {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Dice dice(seed);
    const double tolerance = dice.scale(0.01, 0.2);
    Planner planner(reference_settings(), {});
    Path path({});
    Position end;
    for (int i = 0; i < 150; ++i) {
      const double size = dice.scale(0.02, 5.0);
      for (const Axis axis : {Axis::X, Axis::Y, Axis::A, Axis::B}) {
        end[axis] += size * dice.between(-0.4, 1.0);
      }
      add_line(planner, path, end, smooth(80.0, tolerance));
    }
    const Trajectory trajectory = draw_all(planner);
    const Usage usage = usage_of(trajectory, reference_limits());
    INFO("seed " << seed << ", P " << tolerance);
    CHECK(usage.velocity <= 1.0 + 1e-6);
    CHECK(usage.acceleration <= 1.0 + 1e-4);
    CHECK(path.deviation_of(trajectory, 0.002) <= tolerance);
    CHECK(planner.position() == end);
  }
}

TEST_CASE("A prediction takes exactly as long as the setpoints", "[JOB-5][MOT-1][property]") {
  const auto seed = static_cast<std::uint32_t>(GENERATE(range(1, 31)));
  CAPTURE(seed);
  Dice dice(seed);
  Planner sampled(reference_settings(), {});
  Planner predicted(reference_settings(), {});
  const double p = dice.chance(0.3) ? 0.0 : dice.scale(0.005, 0.2);
  double setpoints = 0.0;
  double stretches = 0.0;
  const auto draw = [&] {
    while (sampled.full()) setpoints += sampled.next().value_or(Setpoint{}).duration;
    while (predicted.full()) stretches += predicted.skip().value_or(Stretch{}).duration;
  };
  for (int i = 0; i < 400; ++i) {
    Position end = sampled.queue_end();
    MoveOptions options = dice.chance(0.05) ? rapid() : smooth(dice.scale(5.0, 100.0), p);
    options.simplify = dice.chance(0.5) ? 0.002 : 0.0;
    if (dice.chance(0.2)) {
      const ArcShape arc = random_arc(dice, end, 5.0);
      REQUIRE(sampled.add_arc(arc, options));
      REQUIRE(predicted.add_arc(arc, options));
    } else {
      for (const Axis axis : kLinearAxes) end[axis] += dice.between(-1.0, 1.0);
      REQUIRE(sampled.add_line(end, options));
      REQUIRE(predicted.add_line(end, options));
    }
    draw();
  }
  while (!sampled.idle()) setpoints += sampled.next().value_or(Setpoint{}).duration;
  while (!predicted.idle()) stretches += predicted.skip().value_or(Stretch{}).duration;
  CHECK(stretches == Approx(setpoints).epsilon(1e-7));
  CHECK(predicted.position() == sampled.position());
}

TEST_CASE("No random program leaves the tube or the limits", "[MOT-1][MOT-2][property]") {
  const auto seed = static_cast<std::uint32_t>(GENERATE(range(1, 31)));
  CAPTURE(seed);
  Dice dice(seed);
  PlannerSettings settings = reference_settings();
  settings.limits.max_velocity = Position::filled(dice.scale(10.0, 500.0));
  settings.limits.max_acceleration = Position::filled(dice.scale(50.0, 10'000.0));
  const double p = dice.scale(0.001, 1.0);
  const double size = dice.scale(0.01, 30.0);
  const double turn = dice.scale(0.01, 3.0);
  const bool arcs = dice.chance(0.5);
  CAPTURE(p, size, turn, arcs);
  Drive drive(settings, p);
  double heading = 0.0;
  for (int i = 0; i < 150; ++i) {
    const MoveOptions options =
        !arcs && dice.chance(0.02) ? rapid() : smooth(dice.scale(1.0, 300.0), p);
    Position end = drive.planner().queue_end();
    if (arcs && dice.chance(0.3)) {
      drive.arc(random_arc(dice, end, size), options);
      continue;
    }
    heading += dice.between(-turn, turn);
    const double length = dice.scale(0.001, size);
    end[Axis::X] += length * std::cos(heading);
    end[Axis::Y] += length * std::sin(heading);
    if (dice.chance(0.3)) end[Axis::Z] += length * dice.between(-0.3, 0.3);
    drive.line(end, options);
    if (dice.chance(0.01)) drive.draw();
  }
  drive.finish();
  require_inside(drive, p);
}

}  // namespace cnc::motion::test
