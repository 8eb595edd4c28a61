// Running a program on the machine (JOB-1, JOB-5, JOB-8, MAN-8).
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

namespace {

constexpr double kExact = 1e-9;
constexpr double kStep = 1.0 / 200.0;  // mm

/// 100 mm at 20 mm/s: five seconds and the ramps.
constexpr const char* kLongCut = "G1 X80 Y60 F1200\n";

void run_to_end(Rig& rig) { REQUIRE(rig.becomes(State::ready, 600.0)); }

std::string text_of_messages(const Rig& rig) {
  std::string all;
  for (const LogMessage& message : rig.simulation.log().after(0)) all += message.text + "\n";
  return all;
}

}  // namespace

TEST_CASE("A job runs to its end and says so", "[JOB-1]") {
  ReadyRig rig;
  rig.start("G0 X10\nG1 Y5 F600\nM30\n");
  CHECK(rig.state() == State::running);
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kExact));
  CHECK(rig.position()[Axis::Y] == Approx(5.0).margin(kExact));
  CHECK(rig.shown()->job.runs == 1);
  CHECK(rig.shown()->job.ended_well);
  CHECK(rig.shown()->job.progress == 1.0);
}

TEST_CASE("A job is refused before homing when homing is mandatory", "[STA-5][safety]") {
  Rig rig(shipped_machine());
  REQUIRE(rig.reset());
  REQUIRE(rig.load("G0 X1\n"));
  const auto answer = rig.machine.run();
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::command_not_allowed);
  CHECK_THAT(answer.error().message, Contains("home the axes"));
}

TEST_CASE("Without a program there is nothing to run", "[JOB-1]") {
  ReadyRig rig;
  const auto answer = rig.machine.run();
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::no_job);
  CHECK(rig.state() == State::ready);
}

TEST_CASE("A program cannot be exchanged while it runs", "[JOB-1]") {
  ReadyRig rig;
  rig.start(kLongCut);
  rig.run_for(1.0);
  const auto running = rig.machine.program();
  const auto answer = rig.load("M30\n");
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::command_not_allowed);
  CHECK(rig.machine.program() == running);
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(80.0).margin(kExact));
}

TEST_CASE("A pause stands still on the path, and resume ends where the program says",
          "[JOB-1][MOT-2]") {
  ReadyRig rig;
  rig.start(kLongCut);
  for (int pause = 0; pause < 3; ++pause) {
    rig.run_for(0.8);
    REQUIRE(rig.pause());
    REQUIRE(rig.state() == State::paused);
    const Position stands = rig.position();
    // On the line from (0, 0) to (80, 60): y = 3/4 x, to the step of either axis.
    CHECK(std::abs(stands[Axis::Y] - 0.75 * stands[Axis::X]) <= 2.0 * kStep);
    CHECK(stands[Axis::X] > 0.0);
    CHECK(stands[Axis::X] < 80.0);
    rig.run_for(1.0);
    CHECK(rig.position() == stands);
    REQUIRE(rig.machine.resume());
  }
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(80.0).margin(kExact));
  CHECK(rig.position()[Axis::Y] == Approx(60.0).margin(kExact));
  CHECK(rig.shown()->job.ended_well);
}

TEST_CASE("Pauses do not count as running time", "[JOB-5]") {
  const auto elapsed_with_pause = [](double pause) {
    ReadyRig rig;
    rig.start(kLongCut);
    rig.run_for(1.0);
    REQUIRE(rig.pause());
    rig.run_for(pause);
    REQUIRE(rig.machine.resume());
    run_to_end(rig);
    return rig.shown()->job.elapsed;
  };
  CHECK(elapsed_with_pause(30.0) == Approx(elapsed_with_pause(0.1)).margin(0.011));  // two cycles
}

TEST_CASE("Stop ends the job along a ramp, spindle and coolant off", "[JOB-1]") {
  ReadyRig rig;
  rig.start(std::string("M3 S12000\nM8\n") + kLongCut);
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 10.0; }));
  REQUIRE(rig.stop());
  CHECK(rig.state() == State::ready);
  CHECK_FALSE(rig.shown()->job.ended_well);
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().spindle_on);
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().flood);
  CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
  const Position stands = rig.position();
  CHECK(std::abs(stands[Axis::Y] - 0.75 * stands[Axis::X]) <= 2.0 * kStep);
  rig.run_for(1.0);
  CHECK(rig.position() == stands);
}

TEST_CASE("A stopped job begins at its first line when it is run again", "[JOB-1]") {
  ReadyRig rig;
  rig.start("G1 X10 F600\nG1 X20\nG1 X0\n");
  REQUIRE(rig.becomes([&] { return rig.shown()->job.line == 2; }));
  REQUIRE(rig.stop());
  REQUIRE(rig.machine.run());
  REQUIRE(rig.becomes([&] { return rig.shown()->job.line == 1; }, 0.5));
  run_to_end(rig);
  CHECK(rig.shown()->job.runs == 2);
  CHECK(rig.shown()->job.ended_well);
}

TEST_CASE("Rewind goes back to the first line", "[JOB-1]") {
  ReadyRig rig;
  rig.start("G1 X10 F600\nG1 X20\n");
  run_to_end(rig);
  REQUIRE(rig.shown()->job.line == 2);
  REQUIRE(rig.machine.rewind());
  rig.simulation.cycle();
  CHECK(rig.shown()->job.line == 0);
  CHECK(rig.shown()->job.elapsed == 0.0);
  CHECK(rig.shown()->job.progress == 0.0);
}

TEST_CASE("A second run that is paused shows its own progress", "[JOB-5]") {
  ReadyRig rig;
  rig.start("G1 X10 F600\nG1 X0\nG1 X10\nG1 X0\n");
  run_to_end(rig);
  REQUIRE(rig.machine.run());
  REQUIRE(rig.becomes([&] { return rig.shown()->job.line == 2; }));
  REQUIRE(rig.pause());
  CHECK(rig.shown()->job.progress == Approx(0.5));  // line 2 of 4
}

TEST_CASE("A tool change waits for the operator with the spindle off", "[GCO-9][JOB-8]") {
  ReadyRig rig;
  rig.start("M3 S12000\nG1 X5 F600\nT2 M6\nG1 X10\n");
  REQUIRE(rig.becomes(State::tool_change));
  CHECK(rig.position()[Axis::X] == Approx(5.0).margin(kExact));
  CHECK(rig.shown()->tool == 2);
  CHECK(rig.shown()->selected_tool == 2);
  CHECK_THAT(text_of_messages(rig), Contains("T2"));
  rig.run_for(5.0);
  CHECK(rig.state() == State::tool_change);
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().spindle_on);
  REQUIRE(rig.machine.resume());
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kExact));
}

TEST_CASE("With automatic tool change M6 does not wait", "[GCO-9][CFG-13]") {
  ReadyRig rig(free_machine({"JOB.autoToolChange=1"}));
  rig.start("G1 X5 F600\nT2 M6\nG1 X10\n");
  run_to_end(rig);
  CHECK(rig.shown()->tool == 2);
  CHECK(rig.shown()->job.ended_well);
}

TEST_CASE("M0 waits for the operator", "[GCO-9][JOB-8]") {
  ReadyRig rig;
  rig.start("G1 X5 F600\nM0\nG1 X10\n");
  REQUIRE(rig.becomes(State::program_stop));
  rig.run_for(5.0);
  CHECK(rig.position()[Axis::X] == Approx(5.0).margin(kExact));
  REQUIRE(rig.machine.resume());
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kExact));
}

TEST_CASE("The feed override stretches and shortens a cut", "[MAN-8]") {
  const auto time_at = [](double feed) {
    ReadyRig rig;
    REQUIRE(rig.machine.set_overrides({.feed = feed}));
    rig.start(kLongCut);
    run_to_end(rig);
    return rig.shown()->job.elapsed;
  };
  // 100 mm at 20 mm/s with a ramp of v/a on one side and v/a on the other: T = s/v + v/a. The slope
  // of the line lets Y's 500 mm/s² be 833 along the path, X's 500 be 625: a = 625 mm/s².
  const auto expected = [](double v) { return 100.0 / v + v / 625.0; };
  const double slack = 0.02;  // cycles of 5 ms around the job
  CHECK(time_at(1.0) == Approx(expected(20.0)).margin(slack));
  CHECK(time_at(0.5) == Approx(expected(10.0)).margin(slack));
  CHECK(time_at(2.0) == Approx(expected(40.0)).margin(slack));
}

TEST_CASE("An override in the middle of a move acts within the look-ahead", "[MAN-8]") {
  ReadyRig rig;
  rig.start("G1 X500 F1200\n");
  rig.run_for(2.0);
  REQUIRE(rig.machine.set_overrides({.feed = 0.5}));
  rig.run_for(0.25 + 0.1);  // FifoTime; the ramp of 10 mm/s takes 0.02 s
  CHECK(rig.shown()->feed == Approx(10.0).epsilon(1e-3));
}

TEST_CASE("Feed override 0 holds the job, and it goes on when the override does", "[MAN-8]") {
  ReadyRig rig;
  rig.start(kLongCut);
  rig.run_for(1.0);
  REQUIRE(rig.machine.set_overrides({.feed = 0.0}));
  rig.run_for(1.0);
  const Position stands = rig.position();
  rig.run_for(10.0);
  CHECK(rig.position() == stands);
  CHECK(rig.state() == State::running);
  CHECK(std::abs(stands[Axis::Y] - 0.75 * stands[Axis::X]) <= 2.0 * kStep);
  REQUIRE(rig.machine.set_overrides({.feed = 1.0}));
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(80.0).margin(kExact));
}

TEST_CASE("A job that stands at override 0 can be paused and stopped", "[MAN-8][JOB-1]") {
  ReadyRig rig;
  rig.start(kLongCut);
  rig.run_for(1.0);
  REQUIRE(rig.machine.set_overrides({.feed = 0.0}));
  rig.run_for(1.0);
  REQUIRE(rig.pause());
  CHECK(rig.state() == State::paused);
  REQUIRE(rig.machine.resume());
  rig.run_for(0.5);
  REQUIRE(rig.stop());
  CHECK(rig.state() == State::ready);
}

TEST_CASE("Overrides outside of their range are refused and change nothing", "[MAN-8]") {
  ReadyRig rig;
  REQUIRE(rig.machine.set_overrides({.feed = 1.5, .rapid = 0.5, .speed = 0.8}));
  const auto [feed, rapid, speed] = GENERATE(table<double, double, double>(
      {{3.01, 1.0, 1.0}, {-0.01, 1.0, 1.0}, {1.0, 1.01, 1.0}, {1.0, 1.0, 3.01}, {NAN, 1.0, 1.0}}));
  const auto answer = rig.machine.set_overrides({.feed = feed, .rapid = rapid, .speed = speed});
  REQUIRE_FALSE(answer);
  CHECK(answer.error().code == ErrorCode::value_out_of_range);
  CHECK(rig.machine.overrides().feed == 1.5);
  CHECK(rig.machine.overrides().rapid == 0.5);
  CHECK(rig.machine.overrides().speed == 0.8);
}

TEST_CASE("M49 takes the feed override out of force", "[MAN-8][GCO-9]") {
  ReadyRig rig;
  REQUIRE(rig.machine.set_overrides({.feed = 0.5}));
  rig.start(std::string("M49\n") + kLongCut);
  rig.run_for(2.0);
  CHECK(rig.shown()->feed == Approx(20.0).epsilon(1e-3));
  CHECK_FALSE(rig.shown()->overrides_enabled);
}

TEST_CASE("The speed override acts on the running spindle", "[MAN-8][SPN-1]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("M3 S12000"));
  REQUIRE(rig.machine.set_overrides({.speed = 0.5}));
  rig.simulation.cycle();
  rig.simulation.cycle();
  // 6000 of 24000 rpm.
  CHECK(rig.simulation.virtual_machine().outputs().spindle_pwm ==
        hal::cpu5::firmware::Outputs::kFullPwm / 4);
}

TEST_CASE("The spindle has its run-up time before the cut in every run", "[SPN-1][safety]") {
  ReadyRig rig(free_machine({"SPINDLE_0.spindleRampUpTime=3"}));
  const auto run_up_of_a_run = [&] {
    REQUIRE(rig.machine.run());
    REQUIRE(rig.becomes([&] { return rig.simulation.virtual_machine().outputs().spindle_on; }));
    const double began = rig.simulation.time();
    REQUIRE(rig.becomes([&] { return rig.shown()->velocity[Axis::X] != 0.0; }));
    return rig.simulation.time() - began;
  };
  constexpr double kRunUp = 3.0 - 0.02;  // seen in cycles of 5 ms
  REQUIRE(rig.load("M3 S6000\nG1 X50 F600\nG1 X0\nM30\n"));
  CHECK(run_up_of_a_run() >= kRunUp);
  REQUIRE(rig.stop());
  CHECK(run_up_of_a_run() >= kRunUp);
  run_to_end(rig);  // M30 has switched it off
  CHECK(run_up_of_a_run() >= kRunUp);
}

TEST_CASE("Everything before a wrong line is executed, and the line is named", "[LNG-10]") {
  ReadyRig rig;
  rig.start("G1 X10 F600\nG1 X20\nG1 X30 G77\nG1 X40\n");
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(20.0).margin(kExact));
  CHECK_FALSE(rig.shown()->job.ended_well);
  const Error error = rig.last_error();
  CHECK(error.code == ErrorCode::unknown_g_code);
  REQUIRE(error.place.has_value());
  CHECK(error.place->line == 3);
  CHECK(error.place->file == "test.nc");
}

TEST_CASE("A target outside of the travel is refused with its line, before the move",
          "[STA-6][safety]") {
  ReadyRig rig;
  rig.start("G0 X10\nG0 Y20\nG1 X601 F600\n");
  run_to_end(rig);
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(kExact));
  CHECK(rig.position()[Axis::Y] == Approx(20.0).margin(kExact));
  const Error error = rig.last_error();
  CHECK(error.code == ErrorCode::travel_limit);
  REQUIRE(error.place.has_value());
  CHECK(error.place->line == 3);
  CHECK_THAT(error.message, Contains("X") && Contains("601") && Contains("600"));
}

TEST_CASE("An arc that bulges out of the travel is refused though its end is inside",
          "[STA-6][safety]") {
  ReadyRig rig;
  // From (0, 10) to (0, 20) around (0, 15): the clockwise half passes X = 5, the other one X = -5.
  rig.start("G0 Y10\nG2 X0 Y20 J5 F600\n");
  run_to_end(rig);
  CHECK(rig.last_error().code == ErrorCode::travel_limit);
  CHECK(rig.last_error().place->line == 2);
  CHECK(rig.position()[Axis::Y] == Approx(10.0).margin(kExact));
}

TEST_CASE("A message of the program comes when the machine is there", "[LNG-4]") {
  ReadyRig rig;
  rig.start("G1 X10 F600\n(MSG, half way)\nG1 X20\n");
  REQUIRE(rig.becomes([&] { return text_of_messages(rig).find("half way") != std::string::npos; }));
  // FifoTime 0.25 s at 10 mm/s would be 2.5 mm too early; two cycles late are 0.1 mm.
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(0.15));
}

TEST_CASE("A smoothed path that waits for its next move lets any number of notes pass", "[LNG-4]") {
  ReadyRig rig;
  std::string notes;
  for (int i = 0; i < 1500; ++i) notes += "S" + std::to_string(100 + i % 2) + "\n";
  rig.start("G64 P0.1\nG1 X10 F3000\nG1 X20 Y5\n" + notes + "G1 X30\n");
  run_to_end(rig);
  CHECK(rig.shown()->job.ended_well);
  CHECK(rig.position()[Axis::X] == Approx(30.0).margin(kExact));
}

TEST_CASE("The job keeps every axis within its limits and loses no step", "[MOT-1]") {
  ReadyRig rig;
  Position position;
  Position velocity;
  double excess = 0.0;
  rig.machine.set_setpoint_listener([&](const motion::Setpoint& setpoint) {
    for (const Axis axis : kLinearAxes) {
      const auto cubic = motion::cubic_of(axis, position, velocity, setpoint);
      const config::AxisConfig& limits = rig.machine.config().axes[axis];
      excess = std::max({excess, cubic.fastest() / limits.velocity,
                         std::abs(cubic.start_acceleration()) / limits.acceleration,
                         std::abs(cubic.end_acceleration()) / limits.acceleration});
    }
    position = setpoint.position;
    velocity = setpoint.velocity;
  });
  rig.start(
      "G64\nG0 X50 Y50\nG2 X60 Y60 I10 F6000\nG1 X61\nG1 X61 Y61\nG3 X61 Y61 I-20 Z-5\nG0 X0 Y0 "
      "Z0\n");
  run_to_end(rig);
  CHECK(rig.shown()->job.ended_well);
  CHECK(excess <= 1.0 + 1e-6);  // rounding
  CHECK(excess > 0.9);          // the limits were used
  for (const Axis axis : kLinearAxes) CHECK(rig.simulation.virtual_machine().lost_steps(axis) == 0);
}

TEST_CASE("A shut-down in the middle of a job brings the machine to rest", "[STA-9]") {
  ReadyRig rig;
  rig.start(std::string("M3 S12000\n") + kLongCut);
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 10.0; }));
  rig.machine.shut_down();
  CHECK_FALSE(rig.machine.is_shut_down());
  REQUIRE(rig.becomes([&] { return rig.machine.is_shut_down(); }, 2.0));
  CHECK_FALSE(rig.simulation.virtual_machine().outputs().spindle_on);
  CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
  const auto refused = rig.machine.run();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::server_stopping);
}

TEST_CASE("A program finds the modes that the machine shows, not those of the job before",
          "[GCO-6][STA-1]") {
  const bool resets = GENERATE(false, true);
  ReadyRig rig;
  rig.start("G64 P0.5\nG1 X5 Y5 F3000\nG0 X2\n");
  REQUIRE(rig.becomes(State::ready));
  if (resets) REQUIRE(rig.reset());
  double nearest = 10.0;
  rig.machine.set_setpoint_listener([&](const motion::Setpoint& setpoint) {
    nearest = std::min(
        nearest, std::hypot(setpoint.position[Axis::X] - 10.0, setpoint.position[Axis::Y] - 5.0));
  });
  rig.start("G1 X10 F3000\nY10\n");
  REQUIRE(rig.becomes(State::ready));
  // A reset brings back G61; without one G64 stays.
  if (resets)
    CHECK(nearest < 0.001);
  else
    CHECK(nearest > 0.01);
}
