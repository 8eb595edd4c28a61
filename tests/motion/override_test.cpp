// Hold, resume, overrides, clear and what stands still means.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

void draw(Planner& planner, int count) {
  for (int i = 0; i < count; ++i) REQUIRE(planner.next().has_value());
}

}  // namespace

TEST_CASE("Feed hold stops within v²/2a and takes v/a", "[MOT-1][MAN-9]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(100, 0), feed_of(100)).has_value());
  draw(planner, 80);  // 0.4 s: at full speed since 0.2 s
  const double x = planner.position()[Axis::X];
  planner.hold();
  const Trajectory braking = draw_all(planner);
  // 100²/(2 · 500) = 10 mm in 100/500 = 0.2 s.
  CHECK(braking.end()[Axis::X] - x == Approx(10.0).epsilon(1e-9));
  CHECK(braking.duration() == Approx(0.2).epsilon(1e-9));
  CHECK_FALSE(planner.idle());
  CHECK_FALSE(planner.next().has_value());
  planner.resume();
  CHECK(draw_all(planner).end() == xyz(100, 0));
  CHECK(planner.idle());
}

TEST_CASE("After a hold the queue can be cleared, while moving it cannot", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(100, 0), feed_of(100)).has_value());
  REQUIRE(planner.add_line(xyz(100, 50), feed_of(100)).has_value());
  draw(planner, 10);
  CHECK_FALSE(planner.clear());
  CHECK_FALSE(planner.set_position(xyz(0, 0)));
  planner.hold();
  const Position stopped = draw_all(planner).end();
  CHECK(planner.clear());
  CHECK(planner.idle());
  CHECK(planner.queue_end() == stopped);
  CHECK(planner.set_position(xyz(1, 2, 3)));
  CHECK(planner.queue_end() == xyz(1, 2, 3));
  planner.resume();
  REQUIRE(planner.add_line(xyz(1, 2, 4), feed_of(10)).has_value());
  CHECK(draw_all(planner).end() == xyz(1, 2, 4));
}

TEST_CASE("A feed override acts at once and on feed moves only", "[MOT-1][MAN-8]") {
  Planner planner(reference_settings(), {});
  planner.set_overrides(0.5, 1.0);
  REQUIRE(planner.add_line(xyz(100, 0), feed_of(100)).has_value());
  // 100/50 + 50/500 = 2.1 s.
  CHECK(draw_all(planner).duration() == Approx(2.1).epsilon(1e-9));
  REQUIRE(planner.add_line(xyz(0, 0), rapid()).has_value());
  CHECK(draw_all(planner).duration() == Approx(1.2).epsilon(1e-9));
  planner.set_overrides(0.5, 0.25);
  REQUIRE(planner.add_line(xyz(100, 0), rapid()).has_value());
  // 100/25 + 25/500 = 4.05 s.
  CHECK(draw_all(planner).duration() == Approx(4.05).epsilon(1e-9));
}

TEST_CASE("A lower override in motion brakes as hard as possible and then keeps the lower feed",
          "[MOT-1][MAN-8]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(1000, 0), feed_of(100)).has_value());
  draw(planner, 100);
  planner.set_overrides(0.2, 1.0);
  // (100 − 20)/500 = 0.16 s later it moves at 20 mm/s.
  double time = 0.0;
  double speed = 100.0;
  while (speed > 20.0 + 1e-9) {
    const auto setpoint = planner.next();
    REQUIRE(setpoint.has_value());
    time += setpoint->duration;
    speed = setpoint->velocity[Axis::X];
  }
  CHECK(time == Approx(0.16).epsilon(1e-6));
  CHECK(planner.next()->velocity[Axis::X] == Approx(20.0));
}

TEST_CASE("A feed override of 0 stops feed moves like a hold, and rapids go on", "[MOT-1][MAN-8]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(50, 0), rapid()).has_value());
  REQUIRE(planner.add_line(xyz(50, 50), feed_of(50)).has_value());
  planner.set_overrides(0.0, 1.0);
  CHECK(draw_all(planner).end() == xyz(50, 0));
  CHECK_FALSE(planner.idle());
  CHECK(std::isinf(planner.queued_time()));
  planner.set_overrides(1.0, 1.0);
  CHECK(draw_all(planner).end() == xyz(50, 50));
}

TEST_CASE("Overrides that are no numbers stop the machine", "[MOT-1][MAN-8]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(50, 0), feed_of(50)).has_value());
  planner.set_overrides(std::numeric_limits<double>::quiet_NaN(), 1.0);
  CHECK_FALSE(planner.next().has_value());
}

TEST_CASE("Each setpoint names the move that it belongs to and its feed", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  MoveOptions first = rapid();
  first.tag = {7, 70};
  MoveOptions second = feed_of(30);
  second.tag = {8, 80};
  REQUIRE(planner.add_line(xyz(10, 0), first).has_value());
  REQUIRE(planner.add_line(xyz(10, 10), second).has_value());
  for (const Setpoint& setpoint : draw_all(planner).setpoints) {
    const bool in_first = setpoint.position[Axis::Y] == 0.0;
    CHECK(setpoint.tag.id == (in_first ? 7 : 8));
    CHECK(setpoint.tag.line == (in_first ? 70 : 80));
    CHECK(setpoint.feed_limit == (in_first ? 0.0 : 30.0));
  }
}

TEST_CASE("Moves of zero length vanish but pass on their wish to stop", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  REQUIRE(planner.add_line(xyz(0, 0), feed_of(10)).has_value());
  CHECK(planner.idle());
  MoveOptions stop = feed_of(100);
  stop.stop_at_end = true;
  REQUIRE(planner.add_line(xyz(100, 0), feed_of(100)).has_value());
  REQUIRE(planner.add_line(xyz(100, 0), stop).has_value());
  REQUIRE(planner.add_line(xyz(200, 0), feed_of(100)).has_value());
  // Two lines of 1.2 s each instead of one of 2.2 s.
  CHECK(draw_all(planner).duration() == Approx(2.4).epsilon(1e-9));
}

}  // namespace cnc::motion::test
