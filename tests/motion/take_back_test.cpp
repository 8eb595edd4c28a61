// Setpoints that the controller has not begun are taken back and planned anew, along the same path.
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <limits>

#include "motion/setpoint_check.h"
#include "tests/allocations.h"
#include "tests/motion/dice.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

PlannerSettings settings_with_history(double jerk = 0.0) {
  PlannerSettings settings = reference_settings();
  settings.limits.max_jerk = Position::filled(jerk);
  settings.most_taken_back = 4096;
  return settings;
}

/// Without and with limits of jerk.
double any_jerk() { return GENERATE(0.0, 20'000.0); }

/// A planner with a controller behind it: setpoints wait in a FIFO, and what has left it is done.
struct Host {
  explicit Host(const PlannerSettings& wanted) : settings(wanted), planner(wanted, {}), path({}) {}

  void draw(std::size_t wanted) {
    while (fifo.size() < wanted && (forgets || planner.can_keep_more())) {
      const auto setpoint = planner.next();
      if (!setpoint) return;
      fifo.push_back(*setpoint);
    }
  }
  void execute(std::size_t count) {
    for (; count > 0 && !fifo.empty(); --count) {
      done.setpoints.push_back(fifo.front());
      fifo.pop_front();
    }
    planner.forget_all_but(fifo.size());
  }
  /// Takes back all that wait but `keep`.
  void cut(std::size_t keep) {
    const std::size_t count = fifo.size() - std::min(keep, fifo.size());
    REQUIRE(planner.take_back(count));
    fifo.resize(fifo.size() - count);
  }
  void run_out() {
    do {
      draw(100);
      execute(50);
    } while (!fifo.empty());
  }

  PlannerSettings settings;
  Planner planner;
  Path path;
  std::deque<Setpoint> fifo;
  bool forgets = false;  ///< draws also when the oldest cannot be taken back any more then
  Trajectory done{{}, {}};
};

void require_sound(const Host& host) {
  const AxisLimits& limits = host.settings.limits;
  const auto infinite = Position::filled(std::numeric_limits<double>::infinity());
  SetpointCheck check(limits, {infinite * -1.0, infinite}, host.done.start);
  for (const Setpoint& setpoint : host.done.setpoints) {
    const auto good = check.check(setpoint);
    if (!good) FAIL_CHECK(good.error().to_string());
    if (!good) break;
  }
  CHECK(usage_of(host.done, limits).acceleration <= 1.0 + 1e-3);
  CHECK(usage_of(host.done, limits).jerk <= 1.0 + 1e-3);
  if (limits.limit_jerk()) {
    // An exact path is passed within a micrometre; half of one for the chords between samples.
    CHECK(host.path.distance_both_ways(host.done) < 1.5e-3);
  } else {
    CHECK(host.path.deviation_of(host.done, 0.0005) < 2e-4);
  }
  CHECK(host.done.end() == host.path.end());
}

void add_moves(Host& host, Dice& dice, int count) {
  const double size = dice.scale(0.01, 30.0);
  double heading = 0.0;
  for (int i = 0; i < count; ++i) {
    MoveOptions options = dice.chance(0.2) ? rapid() : feed_of(dice.scale(0.5, 300.0));
    options.stop_at_end = dice.chance(0.1);
    if (dice.chance(0.2)) {
      add_arc(host.planner, host.path, random_arc(dice, host.path.end(), size), options);
      continue;
    }
    heading += dice.between(-1.5, 1.5);
    const double length = dice.scale(size * 0.01, size);
    Position end = host.path.end();
    end[Axis::X] += length * std::cos(heading);
    end[Axis::Y] += length * std::sin(heading);
    add_line(host.planner, host.path, end, options);
  }
}

bool same(const Setpoint& a, const Setpoint& b) {
  return a.duration == b.duration && a.position == b.position && a.velocity == b.velocity;
}

}  // namespace

TEST_CASE("Setpoints taken back are drawn again as they were when nothing has changed",
          "[MOT-1][LNK-8][JOB-8]") {
  const double jerk = any_jerk();
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    Host host(settings_with_history(jerk));
    add_moves(host, dice, 30);
    host.draw(1 + static_cast<std::size_t>(dice.pick(400)));
    const std::deque<Setpoint> before = host.fifo;
    host.cut(static_cast<std::size_t>(dice.pick(static_cast<int>(before.size()))));
    host.planner.confirm_take_back();
    host.draw(before.size());
    REQUIRE(host.fifo.size() == before.size());
    CHECK(std::equal(before.begin(), before.end(), host.fifo.begin(), same));
    host.run_out();
    require_sound(host);
  }
}

TEST_CASE("A hold after taking back brakes from the end of the last setpoint that is kept",
          "[MOT-1][LNK-8][MAN-9]") {
  Host host(settings_with_history());
  add_line(host.planner, host.path, xyz(100, 0), feed_of(100));
  host.draw(150);
  host.execute(80);  // 0.4 s: at full speed since 0.2 s
  const double x = host.fifo.front().position[Axis::X];
  host.cut(1);
  host.planner.hold();
  host.planner.confirm_take_back();
  host.draw(1000);
  // 100²/(2 · 500) = 10 mm from the end of the setpoint that is kept.
  CHECK(host.fifo.back().position[Axis::X] - x == Approx(10.0).epsilon(1e-9));
  host.execute(1000);
  host.planner.resume();
  host.run_out();
  require_sound(host);
}

TEST_CASE("What was taken back too late counts again when that is revoked", "[MOT-1][LNK-8]") {
  const double jerk = any_jerk();
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    Host host(settings_with_history(jerk));
    add_moves(host, dice, 30);
    host.draw(1 + static_cast<std::size_t>(dice.pick(400)));
    const std::deque<Setpoint> before = host.fifo;
    host.cut(before.size() / 3);
    host.planner.hold();
    host.draw(before.size());
    add_moves(host, dice, 5);
    host.planner.revoke_take_back();
    host.planner.resume();
    CHECK(host.planner.position() == before.back().position);
    host.fifo = before;
    host.run_out();
    require_sound(host);
  }
}

TEST_CASE(
    "Hold, resume and overrides at any instant, from any setpoint that waits, stay on the path",
    "[MOT-1][LNK-8][JOB-8][MAN-8]") {
  const double jerk = any_jerk();
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    PlannerSettings settings = settings_with_history(jerk);
    if (dice.chance(0.5)) settings.limits.max_acceleration[Axis::Y] = dice.scale(50.0, 5000.0);
    Host host(settings);
    for (int round = 0; round < 20; ++round) {
      if (!host.planner.full()) add_moves(host, dice, 1 + dice.pick(10));
      host.draw(1 + static_cast<std::size_t>(dice.pick(100)));
      host.execute(static_cast<std::size_t>(dice.pick(100)));
      const std::deque<Setpoint> before = host.fifo;
      host.cut(static_cast<std::size_t>(dice.pick(5)));
      if (dice.chance(0.3)) host.planner.hold();
      if (dice.chance(0.5)) host.planner.set_overrides(dice.scale(0.1, 3.0), dice.between(0, 1));
      host.draw(1 + static_cast<std::size_t>(dice.pick(100)));
      if (dice.chance(0.8)) {
        host.planner.confirm_take_back();
      } else {
        host.planner.revoke_take_back();
        host.fifo = before;
      }
      if (dice.chance(0.5)) host.draw(200);
      host.planner.resume();
    }
    host.planner.set_overrides(1.0, 1.0);
    host.run_out();
    CHECK(host.planner.idle());
    require_sound(host);
  }
}

TEST_CASE("What replaces setpoints taken back never ends in motion after less than 0.1 s",
          "[MOT-1][MOT-3][LNK-8][safety]") {
  const double jerk = any_jerk();
  // Detail of 0.2 mm at 100 mm/s: a second of it lies within the distance of a stop at that feed.
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    Host host(settings_with_history(jerk));
    MoveOptions options = feed_of(100);
    options.tolerance = 0.005;
    int added = 0;
    const auto add = [&] {
      for (; added < 2000 && !host.planner.full(); ++added) {
        const Position end = xyz(0.2 * added, dice.between(-0.15, 0.15));
        add_line(host.planner, host.path, end, options);
      }
    };
    const auto time_in_fifo = [&] {
      double time = 0.0;
      for (const Setpoint& setpoint : host.fifo) time += setpoint.duration;
      return time;
    };
    const auto draw = [&] {
      while (time_in_fifo() < 0.25) {
        if (added < 2000) add();
        const auto setpoint = host.planner.next(Supply::coming);
        if (!setpoint) return;
        host.fifo.push_back(*setpoint);
      }
    };
    bool held = false;
    for (int round = 0; round < 40; ++round) {
      CAPTURE(round);
      for (int cycles = dice.pick(30); cycles >= 0; --cycles) {
        draw();
        host.execute(3);
      }
      draw();
      host.cut(2);
      held = !held && dice.chance(0.5);
      if (held) host.planner.hold();
      if (!held) host.planner.resume();
      host.planner.set_overrides(dice.scale(0.1, 3.0), 1.0);
      const double kept = time_in_fifo();
      while (time_in_fifo() < kept + 0.25) {
        const auto setpoint = host.planner.next(Supply::coming);
        if (!setpoint) break;
        host.fifo.push_back(*setpoint);
      }
      const bool stands = host.fifo.back().velocity == Position{};
      REQUIRE((stands || time_in_fifo() >= kept + 0.1));
      host.planner.confirm_take_back();
    }
  }
}

TEST_CASE("A path of chords so short that the plan's room fills takes the time that was predicted",
          "[MOT-3][MOT-5][LNK-8]") {
  PlannerSettings settings = settings_with_history(20'000.0);
  MoveOptions options = feed_of(100);
  options.tolerance = 0.01;
  const auto drive = [&](bool predicts) {
    Host host(settings);
    double time = 0.0;
    double in_fifo = 0.0;
    const auto go_on = [&] {
      if (predicts) {
        const auto stretch = host.planner.skip();
        if (stretch) time += stretch->duration;
        return stretch.has_value();
      }
      const auto setpoint = host.planner.next();
      if (!setpoint) return false;
      time += setpoint->duration;
      in_fifo += setpoint->duration;
      host.fifo.push_back(*setpoint);
      for (; in_fifo > 0.25; host.fifo.pop_front()) in_fifo -= host.fifo.front().duration;
      host.planner.forget_all_but(host.fifo.size());
      return true;
    };
    for (int i = 1; i <= 9000; ++i) {
      const double x = 0.006 * i;
      add_line(host.planner, host.path, xyz(x, 4.0 * std::sin(0.3 * x)), options);
      while (host.planner.full()) REQUIRE(go_on());
    }
    while (go_on()) continue;
    CHECK(host.planner.idle());
    return time;
  };
  // A plan made a setpoint later differs in its last digits.
  CHECK(drive(true) == Approx(drive(false)).margin(1e-3));
}

TEST_CASE("Only what is known can be taken back, and only once at a time", "[MOT-1][LNK-8]") {
  const double jerk = any_jerk();
  Planner without(reference_settings(), {});
  REQUIRE(without.add_line(xyz(10, 0), feed_of(10)).has_value());
  REQUIRE(without.next().has_value());
  CHECK(without.known() == 0);
  CHECK_FALSE(without.take_back(1));

  Host host(settings_with_history(jerk));
  add_line(host.planner, host.path, xyz(10, 0), feed_of(10));
  host.draw(20);
  CHECK(host.planner.known() == 20);
  host.execute(5);
  CHECK(host.planner.known() == 15);
  CHECK_FALSE(host.planner.take_back(16));
  CHECK(host.planner.take_back(15));
  CHECK_FALSE(host.planner.take_back(0));
  host.planner.revoke_take_back();
  CHECK(host.planner.take_back(15));
  host.planner.confirm_take_back();
  CHECK(host.planner.known() == 0);
}

TEST_CASE("More setpoints than are kept forget the oldest, and the way ahead keeps its room",
          "[MOT-1][LNK-8]") {
  const double jerk = any_jerk();
  PlannerSettings settings = settings_with_history(jerk);
  settings.most_taken_back = 64;
  Host host(settings);
  host.forgets = true;
  for (int i = 1; i <= 10'000; ++i) {
    // A limit of jerk makes shorter steps of the path.
    const double x = (jerk > 0.0 ? 0.03 : 0.01) * i;
    add_line(host.planner, host.path, xyz(x, 0.005 * std::sin(0.02 * i)), feed_of(50));
    while (host.planner.full()) host.draw(host.fifo.size() + 1);
  }
  CHECK(host.planner.known() == 64);
  REQUIRE(host.planner.take_back(64));
  host.fifo.resize(host.fifo.size() - 64);
  host.planner.hold();
  host.planner.confirm_take_back();
  host.draw(100'000);
  host.planner.resume();
  host.draw(100'000);
  CHECK(host.planner.idle());
  CHECK(host.fifo.back().position == host.path.end());
}

TEST_CASE("Taking back, confirming and revoking allocate nothing", "[MOT-1][LNK-8]") {
  const double jerk = any_jerk();
  Host host(settings_with_history(jerk));
  for (int i = 1; i <= 400; ++i)
    add_line(host.planner, host.path, xyz(0.1 * i, 0.05 * std::sin(0.01 * i)), feed_of(80));
  const std::size_t before = cnc::test::allocations();
  int taken = 0;
  for (int i = 1; host.planner.next(); ++i) {
    if (i % 50 != 0) continue;
    taken += host.planner.take_back(30);
    for (int n = 0; n < 10; ++n) (void)host.planner.next();
    if (i % 100 == 0) host.planner.revoke_take_back();
    host.planner.confirm_take_back();
  }
  CHECK(cnc::test::allocations() == before);
  CHECK(taken >= 2);
}

}  // namespace cnc::motion::test
