// What F means: G93, G94, G95, rotary and mixed moves, and a mill with a fourth axis (MOT-8, manual
// 3.4.24 and "Motor setup").
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "server/job/prediction.h"
#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr double kPi = std::numbers::pi;

/// So quick that only the feed and the velocity of an axis count; A stands on output 4.
MachineData quick_machine(std::vector<std::string> settings = {}) {
  for (const char* axis : {"X", "Y", "Z", "A"})
    settings.push_back("AXIS_" + std::string(axis) + ".acceleration=200000");
  settings.emplace_back("AXIS_A.port=4");
  settings.emplace_back("AXIS_A.visible=1");
  settings.emplace_back("SPINDLE_0.spindleRampUpTime=0");
  return free_machine(settings);
}

/// Of a program that begins and ends on an arc: its first and last step cost up to 5 ms each.
constexpr double kArcEnds = 0.011;

/// Seconds of the program on a machine that stands at X0 and these.
double time_of(const MachineData& data, const std::string& text, double y, double z) {
  const auto program = interp::Program::from_text(text, "test.nc");
  REQUIRE(program);
  Position start;
  start[Axis::Y] = y;
  start[Axis::Z] = z;
  const auto prediction = predict({data.config, *program, data.parameters, data.tools, start}, {});
  REQUIRE(prediction);
  if (prediction->error) FAIL(prediction->error->to_string());
  return prediction->time();
}

struct Row {
  std::string_view rule;
  std::string program;
  double seconds;
};

}  // namespace

TEST_CASE("The time that F gives a move", "[MOT-8][GCO-8]") {
  const MachineData machine = quick_machine();
  const std::vector<Row> rows{
      {"G94: mm per minute", "G1 X60 F600", 6.0},
      {"G94: an arc's own length", "G2 X20 I10 F600", kPi * 10.0 / 10.0},
      {"G94: a helix' own length", "G2 X20 I10 Z5 F600", std::hypot(kPi * 10.0, 5.0) / 10.0},
      {"mixed: the linear part goes at F, rotary axes turn along", "G1 X60 A90 F600", 6.0},
      {"mixed arc: likewise", "G2 X20 I10 A90 F600", kPi},
      {"mixed, beyond the velocity of A: 90 deg/s", "G1 X1 A180 F600", 2.0},
      {"rotary only: degrees per minute", "G1 A90 F600", 9.0},
      {"rotary only under G20: degrees too", "G20 G1 A90 F600", 9.0},
      {"G20: inch per minute", "G20 G1 X2 F30", 4.0},
      {"G93: 1/F minutes (manual: F6 is 10 s)", "G93 G1 X60 F6", 10.0},
      {"G93 in inches is the same time", "G20 G93 G1 X2 F6", 10.0},
      {"G93, rotary only", "G93 G1 A90 F6", 10.0},
      {"G93, mixed", "G93 G1 X60 A90 F6", 10.0},
      {"G93, arc: not its chord", "G93 G2 X20 I10 F6", 10.0},
      {"G93, full circle: its chord is 0", "G93 G2 X0 I10 F6", 10.0},
      {"G93, helix", "G93 G3 X20 I10 Z-5 F6", 10.0},
      {"G93, a move of no length takes no time", "G93 G1 X0 F6\nG1 X60 F6", 10.0},
      {"G93: each line its own F", "G93 G1 X60 F6\nG1 X0 F12", 15.0},
      {"G95: F2 at S500 is 1000 mm/min (manual)", "S500 M3\nG95 G1 X100 F2", 6.0},
      {"G95, arc", "S500 M3\nG95 G2 X20 I10 F2", kPi * 10.0 / (1000.0 / 60.0)},
      {"G95, rotary only: degrees per revolution", "S500 M3\nG95 G1 A100 F2", 6.0},
      {"G95 follows S", "S500 M3\nG95 G1 X50 F2\nS1000\nG1 X100", 3.0 + 1.5},
      {"back in G94", "S500 M3\nG95 G1 X50 F2\nG94 G1 X110 F600", 3.0 + 6.0},
  };
  for (const Row& row : rows) {
    INFO(row.rule << ": " << row.program);
    CHECK(time_of(machine, row.program + "\n", 50.0, 0.0) == Approx(row.seconds).margin(kArcEnds));
  }
}

TEST_CASE("With a fourth axis F is the speed of the tip on the work piece", "[MOT-8]") {
  const MachineData machine = quick_machine({"AXIS_A.mode=mill4"});
  const double round = 2.0 * kPi * 10.0;  // a turn at work Z10
  // Rising from 5 to 10 mm during a turn: the integral of sqrt(5² + (2 pi r)²) over the turn, with
  // y = 2 pi r: (y/2 sqrt(25 + y²) + 25/2 asinh(y/5)) / (10 pi)
  const auto spiral = [](double y) {
    return (0.5 * y * std::sqrt(25.0 + y * y) + 12.5 * std::asinh(y / 5.0)) / (10.0 * kPi);
  };
  const std::vector<Row> rows{
      {"turning only", "G1 A360 F600", round / 10.0},
      {"turning backwards", "G1 A-360 F600", round / 10.0},
      {"along X while turning", "G1 X60 A360 F600", std::hypot(60.0, round) / 10.0},
      {"without a turn as ever", "G1 X60 F600", 6.0},
      {"inches", "G20 G1 A360 F20", round / (20.0 * 25.4 / 60.0)},
      {"falling during the turn", "G1 Z5 A360 F600",
       (spiral(2.0 * kPi * 10.0) - spiral(2.0 * kPi * 5.0)) / 10.0},
      {"work Z counts, not machine Z", "G92 Z5\nG1 A360 F300", 0.5 * round / 5.0},
      {"G93 is a time all the same", "G93 G1 X60 A360 F6", 10.0},
      {"per revolution", "S500 M3\nG95 G1 A360 F1.2", round / 10.0},
      {"a tip on the axis: as fast as A turns", "G92 Z0\nG1 A360 F600", 4.0},
  };
  for (const Row& row : rows) {
    INFO(row.rule << ": " << row.program);
    CHECK(time_of(machine, row.program + "\n", 0.0, 10.0) == Approx(row.seconds).epsilon(1e-3));
  }
}

TEST_CASE("A feed per revolution follows the override of the spindle", "[MOT-8][MAN-8]") {
  // F0.1 at S1000: 100 mm/min; and what the spindle cannot reach, the feed does not either.
  struct Case {
    double lowest;      // of the spindle, rpm
    double speed;       // rpm
    double factor;      // of the spindle
    double mm_per_min;  // F0.1
  };
  const auto jerk = GENERATE("0", "20000");
  const auto [lowest, speed, factor, mm_per_min] =
      GENERATE(Case{0.0, 1000.0, 0.5, 50.0}, Case{1000.0, 1000.0, 0.5, 100.0},
               Case{0.0, 1000.0, 1.2, 120.0}, Case{0.0, 20'000.0, 1.5, 2400.0});
  CAPTURE(jerk, lowest, speed, factor);
  ReadyRig rig(free_machine({"SPINDLE_0.spindleRampUpTime=0", "SPINDLE_0.spindleNmax=24000",
                             fmt::format("SPINDLE_0.spindleNmin={}", lowest),
                             fmt::format("AXIS_X.jerk={}", jerk)}));
  rig.start(fmt::format("S{} M3\nG95 G1 X200 F0.1\nX300\n", speed));
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 1.0; }, 5.0));
  REQUIRE(rig.machine.set_overrides({1.0, 1.0, factor}));
  rig.run_for(1.0);
  const double from = rig.position()[Axis::X];
  rig.run_for(1.0);
  CHECK((rig.position()[Axis::X] - from) * 60.0 == Approx(mm_per_min).epsilon(0.01));
}

TEST_CASE("Facing at constant surface speed: each place has the feed of the spindle's turns there",
          "[MOT-8][GCO-7]") {
  // 60 m/min and at most 2000 rpm: n(r) = 2000/60 turns per second up to r0 = 30/pi/2 mm, and
  // 1000 / (2 pi r) behind it. The time is the integral of dr / (F n(r)) from 0 to 50 mm.
  const double r0 = 1000.0 / (2.0 * kPi * 2000.0 / 60.0);
  const double seconds =
      r0 / (0.1 * 2000.0 / 60.0) + kPi * (50.0 * 50.0 - r0 * r0) / (0.1 * 1000.0);
  const bool diameters = GENERATE(false, true);
  const MachineData machine =
      quick_machine({fmt::format("INTERPRETER.diameterProgramming={}", diameters ? 1 : 0)});
  const double time = time_of(
      machine, fmt::format("M3 G96 S60 D2000\nG95 G1 X{} F0.1\n", diameters ? 100 : 50), 0.0, 0.0);
  // Never more than F per turn: the edge of each of the parts counts.
  CHECK(time >= seconds);
  CHECK(time <= 1.02 * seconds);
}
