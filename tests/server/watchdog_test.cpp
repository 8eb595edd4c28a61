// The cable out in a job, a jog, in homing and in a probe move: what the board holds suffices for
// its watchdog (LNK-2, LNK-4). Whenever it goes, the machine stops along its path, and no motor
// loses a step.
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/core.h>

#include "server/machine/motion_feed.h"
#include "tests/hal/machine_support.h"
#include "tests/server/macro_rig.h"
#include "tests/server/recording_controller.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

namespace {

Position xyz(double x, double y, double z = 0.0) { return Position{{x, y, z}}; }

/// The board gives the host up after 0.2 s (hostTimeout), the host the board after 0.25 s.
constexpr double kShortOutage = 0.22;
constexpr double kLongOutage = 1.0;

/// Something that a machine does, whatever happens to its cable.
struct Motion {
  const char* name;
  double seconds;
  std::function<void(Rig&)> begin;
  std::vector<std::string> settings{};
};

const std::vector<Motion> kJogs{
    {"one axis at full velocity", 0.9,
     [](Rig& rig) { REQUIRE(rig.machine.jog(xyz(1.0, 0.0), 10.0)); }},
    {"two axes", 0.9, [](Rig& rig) { REQUIRE(rig.machine.jog(xyz(1.0, -0.4), 10.0)); }},
    {"three axes, two into their limits",
     1.2,
     [](Rig& rig) { REQUIRE(rig.machine.jog(xyz(1.0, 1.0, -0.5), 10.0)); },
     {"AXIS_X.positiveLimit=40", "AXIS_Y.positiveLimit=60"}},
    {"there and back", 1.0,
     [](Rig& rig) {
       REQUIRE(rig.machine.jog(xyz(1.0, 0.2), 10.0));
       rig.run_for(0.5);
       REQUIRE(rig.machine.jog(xyz(-1.0, 0.2), 10.0));
     }},
    {"from fast to slow", 0.6,
     [](Rig& rig) {
       REQUIRE(rig.machine.jog(xyz(1.0, 1.0), 10.0));
       rig.run_for(0.5);
       REQUIRE(rig.machine.jog(xyz(0.1, 1.0), 10.0));
     }},
    {"slowly", 0.3, [](Rig& rig) { REQUIRE(rig.machine.jog(xyz(0.05, 0.0), 10.0)); }},
    {"a step", 0.8, [](Rig& rig) { REQUIRE(rig.machine.jog_step(Axis::X, 40.0, 1.0)); }},
    {"with limits of jerk",
     1.2,
     [](Rig& rig) {
       REQUIRE(rig.machine.jog_step(Axis::X, 50.0, 1.0));
       REQUIRE(rig.machine.jog_step(Axis::Y, 70.0, 1.0));
     },
     {"AXIS_X.jerk=5000", "AXIS_Y.jerk=5000"}},
};

std::string messages_of(const Rig& rig) {
  std::string all;
  for (const LogMessage& message : rig.simulation.log().after(0)) all += message.text + "\n";
  return all;
}

/// The board switches the drives off in the moment in which it stands. A motor in step lags by less
/// than two full steps then; with its drive left on it would not lose one of them.
const double kOutOfStep = 2.0 * hal::sim::MachineOptions{}.axes[Axis::X].motor.microsteps;

/// Takes the cable out, puts it back, and looks at what the board has made of it.
void require_stop_along_path(Rig& rig, double outage) {
  rig.simulation.virtual_controller().trouble().cable_out = true;
  rig.run_for(outage);
  rig.simulation.virtual_controller().trouble().cable_out = false;
  rig.run_for(2.0);
  INFO(messages_of(rig));
  CHECK(rig.last_error().code == ErrorCode::link_lost);
  CHECK_THAT(rig.last_error().message, Contains("stopped by itself"));
  CHECK_THAT(messages_of(rig), !Contains("underrun"));
  for (const Axis axis : kLinearAxes)
    CHECK(static_cast<double>(rig.simulation.virtual_machine().lost_steps(axis)) < kOutOfStep);
}

}  // namespace

TEST_CASE("What is under way lasts until the host counts as lost, and for every ramp behind that",
          "[LNK-2][LNK-4][MAN-1]") {
  config::MachineConfig config = hal::sim::small_machine();
  config.connection.host_timeout = 0.3;
  config.trajectory.interpolation_time = 0.004;
  config.axes[Axis::X].acceleration = 500.0;
  config.axes[Axis::Y].acceleration = config.axes[Axis::Z].acceleration = 1000.0;
  config.axes[Axis::Y].jerk = config.axes[Axis::Z].jerk = 1e5;
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};
  const MotionFeed feed{link, config};
  // The time-out, 20 ms on the way, two setpoints.
  const double least = 0.3 + 0.02 + 2.0 * 0.004;
  CHECK(feed.lead({}) == Approx(least));
  CHECK(feed.lead(xyz(30.0, 0.0)) == Approx(least + 30.0 / 500.0));
  // Below a²/j = 10 mm/s the ramp never comes to its acceleration.
  CHECK(feed.lead(xyz(0.0, 8.0)) == Approx(least + 2.0 * std::sqrt(8.0 / 1e5)));
  CHECK(feed.lead(xyz(0.0, 0.0, 70.0)) == Approx(least + 70.0 / 1000.0 + 1000.0 / 1e5));
  CHECK(feed.lead(xyz(30.0, 8.0, 70.0)) ==
        Approx(least + 0.06 + 2.0 * std::sqrt(8.0 / 1e5) + 0.08));
}

TEST_CASE("Whenever the cable goes while an axis is jogged, the board stops along the path",
          "[LNK-4][MAN-1][MAN-2][safety]") {
  const Motion& motion = kJogs[GENERATE(range<std::size_t>(0, kJogs.size()))];
  const double outage = GENERATE(kShortOutage, kLongOutage);
  for (double instant = 0.02; instant < motion.seconds; instant += 0.055) {
    CAPTURE(motion.name, outage, instant);
    HomedRig rig(motion.settings);
    const auto& bench = rig.simulation.virtual_machine();
    const Position frame = bench.physical_position() - rig.position();
    motion.begin(rig);
    rig.run_for(instant);
    const bool cruises = rig.shown()->velocity == xyz(100.0, 0.0);
    require_stop_along_path(rig, outage);
    for (const Axis axis : kLinearAxes) {
      INFO("axis " << axis_name(axis));
      const double apart = bench.physical_position(axis) - rig.position()[axis] - frame[axis];
      if (rig.homed(axis)) CHECK(std::abs(apart) < 0.005);  // a step
    }
    if (cruises) CHECK_FALSE(rig.homed(Axis::X));
  }
}

TEST_CASE("Whenever the cable goes in a job, the board stops along the path",
          "[LNK-4][JOB-5][safety]") {
  struct Job {
    const char* name;
    const char* program;
    std::vector<std::string> settings{};
  };
  // 0.33 s to brake, more than the 0.25 s of fifoTime.
  const std::vector<std::string> slow{"AXIS_X.acceleration=300", "AXIS_Y.acceleration=300"};
  const std::vector<std::string> smooth{"AXIS_X.acceleration=300", "AXIS_Y.acceleration=300",
                                        "AXIS_X.jerk=3000", "AXIS_Y.jerk=3000"};
  static const std::vector<Job> kJobs{
      {"rapids", "G0 X80\nX10\nX80\nX10\n", slow},
      {"rapids with limits of jerk", "G0 X80\nX10\nX80\nX10\n", smooth},
      {"a circle at full acceleration", "F6000 G1 X60\nG2 I0 J33.4\nG2 I0 J33.4\n", slow},
      {"rounded corners", "G64 P15 F6000\nG1 X70\nY70\nX10\nY10\nX70\nY70\n", slow},
      {"exact corners", "G61 F6000\nG1 X60\nY50\nX20\nY10\nX60\nY50\n", slow},
      {"a cut between rapids", "G0 X60\nG1 Y20 F1000\nG0 Y80\nG1 X50 F600\nG0 X5\n", slow},
  };
  const Job& job = kJobs[GENERATE(range<std::size_t>(0, kJobs.size()))];
  const double outage = GENERATE(kShortOutage, kLongOutage);
  for (double instant = 0.05; instant < 2.5; instant += 0.083) {
    CAPTURE(job.name, outage, instant);
    HomedRig rig(job.settings);
    rig.start(job.program);
    rig.run_for(instant);
    REQUIRE(rig.state() == State::running);
    require_stop_along_path(rig, outage);
  }
}

/// Something that replaces what the board has not begun.
struct Change {
  const char* name;
  std::function<void(Rig&)> begin;
};

const std::vector<Change> kChanges{
    {"a hold", [](Rig& rig) { rig.machine.pause([](const Result<void>&) {}); }},
    {"a resume",
     [](Rig& rig) {
       REQUIRE(rig.pause());
       REQUIRE(rig.machine.resume());
     }},
    {"a slower feed", [](Rig& rig) { REQUIRE(rig.machine.set_overrides({.feed = 0.3})); }},
    {"a quicker feed", [](Rig& rig) { REQUIRE(rig.machine.set_overrides({.feed = 3.0})); }},
};

const std::vector<std::string> kPaths{
    "G1 X100 F3000\nX0\n",
    "G1 X100 F600\nX0\n",
    "G64 P0.1\nG91\nF4000\nwhile [1 == 1]\nG1 X7 Y4\nX-3 Y-9\nX-4 Y5\nendwhile\n",
};

TEST_CASE("Whenever the cable goes while the path is replaced, the board stops along the path",
          "[LNK-4][LNK-8][JOB-8][safety]") {
  const Change& change = kChanges[GENERATE(range<std::size_t>(0, kChanges.size()))];
  const std::string& path = kPaths[GENERATE(range<std::size_t>(0, kPaths.size()))];
  const auto settings = GENERATE(std::vector<std::string>{},
                                 std::vector<std::string>{"AXIS_X.jerk=5000", "AXIS_Y.jerk=5000"});
  for (double instant = 0.0; instant < 0.12; instant += 0.01) {
    CAPTURE(change.name, path, settings, instant);
    HomedRig rig(settings);
    REQUIRE(rig.mdi("G0 X20 Y20"));
    rig.start(path);
    rig.run_for(0.8);
    change.begin(rig);
    rig.run_for(instant);
    require_stop_along_path(rig, kShortOutage);
  }
}

TEST_CASE("A computer that is too busy for the machine while the path is replaced ends no motion",
          "[LNK-8][JOB-8]") {
  const Change& change = kChanges[GENERATE(range<std::size_t>(0, kChanges.size()))];
  const std::string& path = kPaths[GENERATE(range<std::size_t>(0, kPaths.size()))];
  const auto settings = GENERATE(std::vector<std::string>{},
                                 std::vector<std::string>{"AXIS_X.jerk=5000", "AXIS_Y.jerk=5000"});
  for (double instant = 0.0; instant < 0.12; instant += 0.01) {
    CAPTURE(change.name, path, settings, instant);
    HomedRig rig(settings);
    REQUIRE(rig.mdi("G0 X20 Y20"));
    rig.start(path);
    rig.run_for(0.8);
    change.begin(rig);
    rig.run_for(instant);
    rig.simulation.starve_machine(0.2);
    rig.run_for(0.5);
    INFO(messages_of(rig));
    CHECK_THAT(messages_of(rig), !Contains("underrun"));
    CHECK((rig.state() == State::running || rig.state() == State::paused));
  }
}

TEST_CASE("Whenever the cable goes in homing, the board stops along the path",
          "[LNK-4][HOM-2][safety]") {
  const double velocity = GENERATE(10.0, 100.0);
  const double outage = GENERATE(kShortOutage, kLongOutage);
  for (double instant = 0.02; instant < 1.5; instant += 0.055) {
    CAPTURE(velocity, outage, instant);
    Rig rig(shipped_machine({fmt::format("AXIS_X.homeVelocity={}", -velocity)}),
            {.machine = {.start = xyz(velocity > 50.0 ? 60.0 : 5.0, 100.0), .stop_margin = 50.0}});
    REQUIRE(rig.reset());
    rig.machine.home({Axis::X}, [](const Result<void>&) {});
    rig.run_for(instant);
    require_stop_along_path(rig, outage);
  }
}

TEST_CASE("Whenever the cable goes in a probe move, the board stops along the path",
          "[LNK-4][GCO-8][safety]") {
  const int feed = GENERATE(600, 3000);
  const double outage = GENERATE(kShortOutage, kLongOutage);
  for (double instant = 0.05; instant < 1.5; instant += 0.055) {
    CAPTURE(feed, outage, instant);
    MacroRig macro("sub nothing\nendsub");
    REQUIRE(macro.run(fmt::format("G0 Z{}", feed == 600 ? -70 : -40)));
    macro.rig.machine.mdi(fmt::format("G38.2 Z-120 F{}", feed), [](const Result<void>&) {});
    macro.rig.run_for(instant);
    require_stop_along_path(macro.rig, outage);
  }
}
