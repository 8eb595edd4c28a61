// Whatever the path: within every axis' limits, within 0.2 µm of the program, at its end exactly.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "motion/setpoint_check.h"
#include "tests/motion/dice.h"
#include "tests/motion/program_judge.h"
#include "tests/motion/program_text.h"
#include "tests/motion/random_program.h"
#include "tests/motion/trajectory.h"

namespace cnc::motion::test {

namespace {

struct World {
  explicit World(const PlannerSettings& planner_settings)
      : settings(planner_settings), planner(settings, {}), path({}) {}

  PlannerSettings settings;
  Planner planner;
  Path path;
  Trajectory trajectory{{}, {}};

  void draw(int count) {
    for (int i = 0; i < count; ++i) {
      const auto setpoint = planner.next();
      if (!setpoint) return;
      trajectory.setpoints.push_back(*setpoint);
    }
  }
};

void add_random_moves(World& world, Dice& dice, int count) {
  const double size = dice.scale(0.001, 50.0);
  const double turn = dice.scale(0.001, 3.0);
  double heading = 0.0;
  for (int i = 0; i < count; ++i) {
    MoveOptions options = dice.chance(0.2) ? rapid() : feed_of(dice.scale(0.5, 300.0));
    options.stop_at_end = dice.chance(0.05);
    options.tag.id = static_cast<std::uint64_t>(i);
    if (dice.chance(0.2)) {
      add_arc(world.planner, world.path, random_arc(dice, world.path.end(), size), options);
    } else {
      heading += dice.between(-turn, turn);
      const double length = dice.scale(size * 0.01, size);
      Position end = world.path.end();
      end[Axis::X] += length * std::cos(heading);
      end[Axis::Y] += length * std::sin(heading);
      if (dice.chance(0.3)) end[Axis::Z] += length * dice.between(-0.3, 0.3);
      if (dice.chance(0.1)) end[Axis::C] += dice.between(-5.0, 5.0);
      add_line(world.planner, world.path, end, options);
    }
    while (world.planner.full()) world.draw(1);
    // A slow source: the machine runs into the end of the queue now and then.
    if (dice.chance(0.1)) world.draw(dice.pick(40));
  }
}

/// Everything that must hold for a finished trajectory.
void require_sound(const World& world) {
  const AxisLimits& limits = world.settings.limits;
  const Usage usage = usage_of(world.trajectory, limits);
  CHECK(usage.velocity <= 1.0 + 1e-6);
  CHECK(usage.acceleration <= 1.0 + 1e-3);
  const auto infinite = Position::filled(std::numeric_limits<double>::infinity());
  SetpointCheck check(limits, {infinite * -1.0, infinite}, world.trajectory.start);
  for (const Setpoint& setpoint : world.trajectory.setpoints) {
    const auto good = check.check(setpoint);
    if (!good) FAIL_CHECK(good.error().to_string());
    if (!good) break;
  }
  CHECK(world.path.deviation_of(world.trajectory, 0.0005) < 2e-4);
  CHECK(world.trajectory.end() == world.path.end());
}

}  // namespace

TEST_CASE("Random paths are driven within all limits and 0.2 µm of the program",
          "[MOT-1][MOT-2][MOT-4]") {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    PlannerSettings settings = reference_settings();
    settings.max_setpoint_duration = dice.scale(0.001, 0.05);
    if (dice.chance(0.3)) settings.laf_angle = dice.between(0.0, 60.0);
    if (dice.chance(0.5)) settings.limits.max_acceleration[Axis::Y] = dice.scale(50.0, 5000.0);
    if (dice.chance(0.5)) settings.limits.max_velocity[Axis::Z] = dice.scale(5.0, 500.0);
    World world(settings);
    add_random_moves(world, dice, 60);
    world.draw(10'000'000);
    CHECK(world.planner.idle());
    require_sound(world);
  }
}

TEST_CASE("Feed hold at any instant stays on the path and within the limits", "[MOT-1][MAN-9]") {
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    World world(reference_settings());
    for (int round = 0; round < 6; ++round) {
      add_random_moves(world, dice, 8);
      world.draw(dice.pick(60));
      world.planner.hold();
      world.draw(10'000'000);
      CHECK_FALSE(world.planner.next().has_value());
      world.planner.resume();
    }
    world.draw(10'000'000);
    CHECK(world.planner.idle());
    require_sound(world);
  }
}

TEST_CASE("A feed hold where the curve needs all of the acceleration keeps the limits",
          "[MOT-1][MAN-9]") {
  // Chords of a wave, rounded to 0.1 µm as programs are: the blends differ in curvature, and at the
  // tightest an axis has nothing left to brake with.
  for (int instant = 200; instant < 1200; instant += 50) {
    CAPTURE(instant);
    World world(reference_settings());
    int chord = 0;
    const auto draw = [&](int count) {
      for (int n = 0; n < count; ++n) {
        for (; !world.planner.full() && chord < 2000; ++chord) {
          const double y = std::round(1e4 * 5.0 * std::sin(0.01 * (chord + 1))) / 1e4;
          add_line(world.planner, world.path, xyz(0.05 * (chord + 1), y), feed_of(75));
        }
        world.draw(1);
      }
    };
    draw(instant);
    world.planner.hold();
    world.draw(10'000'000);
    const Usage usage = usage_of(world.trajectory, world.settings.limits);
    CHECK(usage.velocity <= 1.0 + 1e-6);
    CHECK(usage.acceleration <= 1.0 + 1e-3);
  }
}

TEST_CASE("Overrides that change at any instant stay on the path and within the limits",
          "[MOT-1][MAN-8]") {
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    World world(reference_settings());
    for (int round = 0; round < 10; ++round) {
      add_random_moves(world, dice, 6);
      const double feed = dice.chance(0.2) ? 0.0 : dice.scale(0.01, 3.0);
      world.planner.set_overrides(feed, dice.chance(0.2) ? 0.0 : dice.scale(0.01, 1.0));
      world.draw(dice.pick(60));
      world.planner.set_overrides(dice.scale(0.5, 3.0), 1.0);
    }
    world.draw(10'000'000);
    CHECK(world.planner.idle());
    require_sound(world);
  }
}

TEST_CASE("Programs that once left the limits keep them", "[MOT-1][property]") {
  const char* const program = GENERATE(
      // A hold that began in the last bit of a step whose q' grows small braked harder than the
      // reserve for the setpoints' cubics was made for.
      R"((X Y Z: 20 20 20 mm/s, 300 30 60 mm/s2; setpoints of 0.00142213997133 s)
G64 P0.021
G1 Y-0.0004 F6000
G64 P0.043
G1 X0.038 Y-0.04 F6000
G1 Y0.001 F6000
G1 X-0.11 Y0.081 F6000
(6 setpoints)
G1 X-0.000973736190037 Y-0.000389220987685 F6000
(17 setpoints)
G61 Q0.00189001513989
G1 X-0.00372452850711 Y0.00390064787248 F14969.8587646
(29 setpoints)
G1 X-0.00138086028858 Y0.00270729089368 F1306.80516297
(22 setpoints)
(hold until standstill, resume)
G1 X0.00226193479937 Y-0.00754355534875 Z0.00332812187843 F619.90859315
)",
      // A hold that ended within rounding of a corner: the rest of the way was left half-way,
      // moving.
      R"((X Y Z: 20 20 20 mm/s, 122.317050104 122.317050104 122.317050104 mm/s2; setpoints of 0.0126911201775 s)
G64 P0.48734401896
G1 X0.115016811332 Y0.0456122091932 F1566.47084724
G1 X0.00168909903711 Y-0.00280705201741 F12359.8581482
G1 X0.0135886057039 Y-0.0618319884747 F2362.13702299
G1 X-0.000825609820592 Y-0.00116919150867 F181.549462983
G1 X-0.0242850256378 Y-0.0279088802395 F22394.7133905
G1 X-0.100828781281 Y-0.0932060677078 F12834.9097651
G1 X-0.00743735531342 Y-0.00134575032289 F669.126038891
G1 X-0.0271462976764 Y-0.0048899360006 F16474.6716525
G1 X-0.00188017340521 Y0.000549869187878 F3700.69901327
G1 X-0.000683349903736 Y0.00123723984661 Z-5.7914977544e-05 A-3.17926305017 F132.468077891
G0 X-0.311001643475 Y0.0727207713802 Z-0.244759640656
G1 X-0.184660242223 Y0.0732392700886 F237.54002875
G0 X-0.041985331957 Y0.0147840726896 Z0.0121446930257
G1 X-0.0914206055712 Y0.236339612437 Z-0.191344986542 F194.179429347
G1 X0.0258950707249 Y0.0606493647552 F54.553184761
G1 X0.0331975238439 Y0.0381088771097 F104.701902963
G1 X0.00264442595188 Y0.00961365503017 F6401.3783463
G1 X0.00457688061775 Y0.0293717029924 F11289.2629618
G1 X0.0609344680204 Y0.0669770158602 F44.9411491184
G1 X-0.00783231688397 Y0.0389699620867 Z0.0394022439486 F65.6607703802
G0 X0.0992836488454 Y0.119941127967
G1 X0.16515434544 Y0.192781333916 F415.875999039
G1 X0.195663962433 Y0.155219141426 F470.949887314
G1 X0.000745874658471 Y0.00193061011814 F532.014916339
G1 X0.120666276384 Y0.175373490263 Z-0.21035789585 F5845.93871735
G1 X0.0121751467082 Y0.000379541691541 Z0.0049908732309 F3682.1832465
G1 X0.00129190650923 Y-0.000840084781003 Z-0.00135101123294 F3070.86831849
(27 setpoints)
G1 X0.000469985339775 Y-0.00202546835669 Z0.00106279966523 F64.955751961
(26 setpoints)
G1 X0.0153818229502 Y0.0227971821729 F4792.89394976
(3 setpoints)
G1 X0.251285339597 Y-0.29802664679 F376.051784803
(5 setpoints)
G1 X-0.0108513641021 Y0.0315331884618 F33.186463609
(25 setpoints)
G1 X0.0953598260133 Y0.431639486744 F3753.88501421
(16 setpoints)
(hold until standstill, resume)
G1 X0.0868887673232 Y0.393681263209 F726.896013393
)");
  const Verdict verdict = judge(program_of(program));
  INFO(verdict.to_string());
  CHECK(verdict.is_sound());
}

// What the soak found: hundreds of arcs of a hundredth of a millimetre in a tube of 0.7 mm, where
// the spline's matrix had lost its digits; a move of 3 mm beside tiny ones, where the path bulged
// between the places at which it was measured; runs that were said to be in the tube after the last
// round.
TEST_CASE("Programs that once left the tube stay in it", "[MOT-2][property]") {
  for (const std::uint32_t seed : {15423U, 7481U, 12517U}) {
    Dice dice(seed);
    const Verdict verdict = judge(random_program(dice, 400));
    INFO("seed " << seed << ": " << verdict.to_string());
    CHECK(verdict.is_sound());
  }
}

// What the soak found with limits of jerk: a setpoint that began 0.016 ms before the end of a cell
// at which the jerk went from its limit to the other one.
TEST_CASE("A program that once left a limit of acceleration keeps it", "[MOT-3][property]") {
  Dice dice(620023);
  const RandomProgram program = random_program(dice, 400, {.jerk = true});
  const Verdict verdict = judge(program.without(30, 370).without(0, 5));
  INFO(verdict.to_string());
  CHECK(verdict.is_sound());
}

TEST_CASE("Random programs with all modes, holds and overrides keep limits and tube",
          "[MOT-1][MOT-2][MAN-8][MAN-9][property]") {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Dice dice(seed);
    const RandomProgram program = random_program(dice, 150);
    const Verdict verdict = judge(program);
    CHECK(verdict.refused == 0);
    if (!verdict.is_sound()) FAIL_CHECK("seed " << seed << "\n" << smallest_failure(program));
  }
}

}  // namespace cnc::motion::test
