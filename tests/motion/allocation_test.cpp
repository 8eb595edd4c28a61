// next() and the overrides are called from the real-time thread: they must not allocate.
#include <catch2/catch.hpp>
#include <cmath>

#include "motion/jerk_plan.h"
#include "motion/jog.h"
#include "motion/setpoint_check.h"
#include "tests/allocations.h"
#include "tests/motion/trajectory.h"
#include "tests/motion/tube_path.h"

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

TEST_CASE("Third-order planning, driving, hold and overrides allocate nothing", "[MOT-3]") {
  JerkPlan plan({Position::filled(100), Position::filled(500), Position::filled(20'000)});
  const PathInterval interval = straight_interval(0.5, 80.0);
  const std::size_t before = cnc::test::allocations();
  int appended = 0;
  int cells = 0;
  while (cells < 20'000 && !(plan.idle() && appended == 1000)) {
    while (appended < 1000 && plan.wants_path()) {
      plan.append(interval);
      ++appended;
    }
    if (appended == 1000) plan.stop_at_end();
    if (plan.due()) (void)plan.plan();
    plan.advance(plan.time_in_cell());
    plan.forget_before(plan.place());
    if (++cells % 97 == 0) plan.set_overrides({0.2 + 0.01 * (cells % 90), 1.0});
    if (cells % 301 == 0) plan.hold();
    if (cells % 307 == 0 || plan.standing()) plan.resume();
  }
  CHECK(cnc::test::allocations() == before);
  CHECK(plan.idle());
  CHECK(cells > 900);
}

}  // namespace cnc::motion::test
