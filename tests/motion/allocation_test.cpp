// next() and the overrides are called from the real-time thread: they must not allocate.
#include <catch2/catch.hpp>
#include <cmath>

#include "motion/jog.h"
#include "motion/setpoint_check.h"
#include "tests/allocations.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

TEST_CASE("Drawing setpoints, checking them, hold and overrides allocate nothing", "[MOT-1]") {
  Planner planner(reference_settings(), {});
  for (int i = 1; i <= 400; ++i) {
    REQUIRE(planner.add_line(xyz(0.1 * i, 0.05 * std::sin(0.01 * i)), feed_of(80)).has_value());
  }
  const Position end = planner.queue_end();
  ArcShape arc{end, Plane::xy, end[Axis::X], end[Axis::Y] + 10.0, 50};
  REQUIRE(planner.add_arc(arc, feed_of(80)).has_value());
  const auto far = Position::filled(1e6);
  SetpointCheck check(reference_limits(), {far * -1.0, far}, {});
  JogPlanner jog(reference_limits(), 0.001, {});
  REQUIRE(jog.set_velocity(Axis::X, 50).has_value());
  REQUIRE(cnc::test::allocations() > 0);  // the counter counts

  const std::size_t before = cnc::test::allocations();
  int count = 0;
  bool good = true;
  while (const auto setpoint = planner.next()) {
    good = good && check.check(*setpoint).has_value();
    if (++count % 97 == 0) planner.set_overrides(0.2 + 0.01 * (count % 150), 1.0);
    if (count % 501 == 0) planner.hold();
    if (planner.held() && count % 7 == 0) planner.resume();
    good = good && jog.next().has_value();
  }
  CHECK(cnc::test::allocations() == before);
  CHECK(good);
  CHECK(count > 1000);
}

}  // namespace cnc::motion::test
