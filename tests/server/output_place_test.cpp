// Coolant and spindle speed of a program take effect at their place in its path, to the step.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr std::uint32_t kFullPwm = hal::cpu5::firmware::Outputs::kFullPwm;

/// What the board has switched, and where the axes were at that very tick.
struct Switching {
  hal::cpu5::firmware::Outputs outputs;
  Position position;
};

struct WatchedRig : ReadyRig {
  explicit WatchedRig(double period = 0.005, std::vector<std::string> settings = {})
      : ReadyRig(free_machine(std::move(settings)), options(period)) {
    hal::sim::VirtualMachine& virtual_machine = simulation.virtual_machine();
    virtual_machine.set_output_listener([this, &virtual_machine] {
      switchings.push_back({virtual_machine.outputs(), virtual_machine.physical_position()});
    });
    machine.set_setpoint_listener(
        [this](const motion::Setpoint& setpoint) { setpoints.push_back(setpoint); });
  }
  ~WatchedRig() { simulation.virtual_machine().set_output_listener({}); }
  WatchedRig(const WatchedRig&) = delete;
  WatchedRig& operator=(const WatchedRig&) = delete;
  static SimulationOptions options(double period) {
    SimulationOptions options = at_zero();
    options.period = period;
    return options;
  }

  /// Where the moves of the first `line` lines end and the next begins.
  [[nodiscard]] Position end_of_lines(std::uint32_t line) const {
    Position end;
    for (const motion::Setpoint& setpoint : setpoints)
      if (setpoint.tag.line <= line) end = setpoint.position;
    return end;
  }
  [[nodiscard]] double step(Axis axis) const {
    return 1.0 / std::abs(machine.config().axes[axis].steps_per_unit);
  }
  /// Each axis is where a motor that follows its setpoints is then: on the nearest step.
  void check_place(const Switching& switching, const Position& place) const {
    for (const Axis axis : kLinearAxes) {
      CAPTURE(axis_name(axis));
      CHECK(std::abs(switching.position[axis] - place[axis]) < 0.51 * step(axis));
    }
  }
  [[nodiscard]] const hal::cpu5::firmware::Outputs& outputs() {
    return simulation.virtual_machine().outputs();
  }

  std::vector<Switching> switchings;
  std::vector<motion::Setpoint> setpoints;
};

}  // namespace

TEST_CASE("M8 in the middle of a G64 path switches at the step where its place begins",
          "[SPN-1][JOB-1][LNK-9]") {
  // However seldom the server looks at the board.
  WatchedRig rig(GENERATE(0.001, 0.005, 0.023));
  rig.start("G64 P0.05\nG1 X10 F3000\nX20 Y5\nM8\nX30 Y2\nX40\nM9\nX50 Y3\n");
  REQUIRE(rig.becomes(State::ready));
  REQUIRE(rig.switchings.size() == 2);
  const Switching& on = rig.switchings[0];
  const Switching& off = rig.switchings[1];
  CHECK(on.outputs.flood);
  CHECK_FALSE(off.outputs.flood);
  rig.check_place(on, rig.end_of_lines(3));
  rig.check_place(off, rig.end_of_lines(6));
  // Smoothed within 0.05 mm, and a segment at most later: 50 mm/s in 5 ms.
  CHECK(std::hypot(on.position[Axis::X] - 20.0, on.position[Axis::Y] - 5.0) < 0.05 + 0.25);
  CHECK(std::hypot(off.position[Axis::X] - 40.0, off.position[Axis::Y] - 2.0) < 0.05 + 0.25);
  CHECK(rig.simulation.virtual_machine().flood_time() > 0.3);  // 20 mm at 50 mm/s
}

TEST_CASE("An S word changes the speed of a turning spindle at its step", "[SPN-1][LNK-9]") {
  WatchedRig rig;
  const double most = rig.machine.config().spindle.max_speed;
  rig.start("M3 S6000\nG1 X10 F3000\nS9000 M7\nX20\nS12000\nX30\n");
  REQUIRE(rig.becomes(State::ready));
  const auto pwm_of = [&](double speed) {
    return static_cast<std::uint32_t>(std::lround(speed / most * kFullPwm));
  };
  REQUIRE(rig.switchings.size() == 4);  // M3, S9000 with M7, S12000, all off at the end
  CHECK(rig.switchings[0].outputs.spindle_pwm == pwm_of(6000));
  CHECK(rig.switchings[1].outputs.spindle_pwm == pwm_of(9000));
  CHECK(rig.switchings[1].outputs.mist);
  CHECK(rig.switchings[2].outputs.spindle_pwm == pwm_of(12000));
  rig.check_place(rig.switchings[1], rig.end_of_lines(2));
  rig.check_place(rig.switchings[2], rig.end_of_lines(4));
  CHECK(rig.switchings[1].position[Axis::X] == Approx(10.0).margin(0.25));
  CHECK(rig.switchings[3].outputs.spindle_pwm == 0);
  CHECK_FALSE(rig.switchings[3].outputs.mist);
}

TEST_CASE("An S word of a spindle that stands switches nothing on the way", "[SPN-1]") {
  WatchedRig rig;
  rig.start("G1 X10 F3000\nS9000\nX20\nM3\nX30\n");
  REQUIRE(rig.becomes(State::ready));
  REQUIRE(rig.switchings.size() == 2);
  CHECK(rig.switchings[0].position[Axis::X] == Approx(20.0));
  CHECK(rig.switchings[0].outputs.spindle_pwm > 0);
}

TEST_CASE("Who holds before the place of M8 and aborts has no coolant; who goes on has it there",
          "[JOB-8][LNK-8][SPN-1][safety]") {
  // Long before, within the FIFO, and at the last moment; the place is 0.4 s behind the start.
  const double instant = GENERATE(0.1, 0.25, 0.33, 0.36, 0.375, 0.38, 0.385, 0.39);
  const bool aborts = GENERATE(true, false);
  WatchedRig rig(0.002);
  rig.start("G1 X20 F3000\nM8\nX40\n");
  REQUIRE(rig.becomes([&] { return !rig.setpoints.empty(); }, 1.0));
  rig.run_for(instant);
  REQUIRE(rig.pause());
  const double x = rig.position()[Axis::X];
  CAPTURE(instant, x);
  const bool passed = x > 20.0;
  CHECK(rig.switchings.size() == (passed ? 1U : 0U));
  if (aborts) {
    REQUIRE(rig.stop());
    rig.run_for(0.5);
    CHECK_FALSE(rig.outputs().flood);
    CHECK(rig.switchings.size() == (passed ? 2U : 0U));
    return;
  }
  REQUIRE(rig.machine.resume());
  REQUIRE(rig.becomes(State::ready));
  REQUIRE(rig.switchings.size() == 2);
  CHECK(rig.switchings[0].position[Axis::X] == Approx(20.0).margin(0.25));
  CHECK(rig.shown()->flood == false);
}

TEST_CASE(
    "What ends a job without a ramp leaves neither coolant nor spindle on, whatever was under "
    "way",
    "[STA-4][LNK-9][safety]") {
  using hal::sim::VirtualMotor;
  struct Row {
    std::string_view what;
    void (*begin)(Rig&);
    void (*end)(Rig&);
  };
  const std::vector<Row> rows{
      {"emergency stop", [](Rig& rig) { rig.simulation.virtual_machine().press_estop(true); },
       [](Rig& rig) { rig.simulation.virtual_machine().press_estop(false); }},
      {"drive alarm",
       [](Rig& rig) { rig.simulation.virtual_machine().raise_drive_alarm(Axis::X, true); },
       [](Rig& rig) { rig.simulation.virtual_machine().raise_drive_alarm(Axis::X, false); }},
      {"home switch, a quick stop that the server orders",
       [](Rig& rig) {
         rig.simulation.virtual_machine().stick_switch(Axis::Y, VirtualMotor::Switch::home, true);
       },
       [](Rig&) {}},
      {"lost link",
       [](Rig& rig) { rig.simulation.virtual_controller().trouble().cable_out = true; },
       [](Rig& rig) { rig.simulation.virtual_controller().trouble().cable_out = false; }},
      {"board reset", [](Rig& rig) { rig.simulation.virtual_controller().board().reset(); },
       [](Rig&) {}},
  };
  // The place of M8 is 0.4 s behind the start; the status of that comes up to two cycles later.
  for (const Row& row : rows) {
    for (double instant = 0.380; instant < 0.420; instant += 0.001) {
      CAPTURE(row.what, instant);
      WatchedRig rig(0.005, {"AXIS_Y.homeVelocity=0"});
      REQUIRE(rig.home({Axis::Y}));
      rig.start("HomeIsEstop on\nM3 S12000\nG1 X20 F3000\nM8\nX40\n");
      REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 0.0; }, 10.0));
      rig.run_for(instant);
      row.begin(rig);
      REQUIRE(rig.becomes([&] { return rig.state() != State::running; }, 1.0));
      rig.run_for(0.5);
      CHECK_FALSE(rig.outputs().flood);
      CHECK_FALSE(rig.outputs().spindle_on);
      row.end(rig);
      rig.run_for(0.5);
      REQUIRE(rig.reset());
      rig.run_for(0.2);
      CHECK_FALSE(rig.outputs().flood);
      CHECK_FALSE(rig.outputs().spindle_on);
    }
  }
}

TEST_CASE("A stop along the path takes what M8 has just switched off again", "[JOB-1][safety]") {
  for (double instant = 0.380; instant < 0.420; instant += 0.002) {
    CAPTURE(instant);
    WatchedRig rig;
    rig.start("G1 X20 F3000\nM8\nX40\n");
    REQUIRE(rig.becomes([&] { return !rig.setpoints.empty(); }, 10.0));
    rig.run_for(instant);
    REQUIRE(rig.stop());
    rig.run_for(0.2);
    CHECK_FALSE(rig.outputs().flood);
  }
}

TEST_CASE("A speed override given while an S word is under way is in it when it takes effect",
          "[SPN-1][MAN-8]") {
  // The S word is 0.4 s behind the start, and with the FIFO full for 0.25 s is under way.
  const double instant = GENERATE(0.2, 0.3, 0.35, 0.39, 0.395, 0.398, 0.4, 0.405);
  WatchedRig rig;
  const double most = rig.machine.config().spindle.max_speed;
  rig.start("M3 S6000\nG1 X20 F3000\nS8000\nX40\n");
  REQUIRE(rig.becomes([&] { return !rig.setpoints.empty(); }, 10.0));
  // The first setpoints are the spindle's run-up.
  const auto moves = [&] { return rig.position()[Axis::X] > 0.0; };
  REQUIRE(rig.becomes(moves, 10.0));
  rig.run_for(instant);
  Overrides overrides = rig.machine.overrides();
  overrides.speed = 1.2;
  REQUIRE(rig.machine.set_overrides(overrides));
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 30.0; }, 10.0));
  const auto pwm_of = [&](double speed) {
    return static_cast<std::uint32_t>(std::lround(speed / most * kFullPwm));
  };
  CHECK(rig.outputs().spindle_pwm == pwm_of(8000 * 1.2));
  if (instant > 0.38) return;  // then the override comes late, and corrects
  std::vector<std::uint32_t> speeds;
  for (const Switching& switching : rig.switchings) speeds.push_back(switching.outputs.spindle_pwm);
  CHECK(speeds == std::vector<std::uint32_t>{pwm_of(6000), pwm_of(6000 * 1.2), pwm_of(8000 * 1.2)});
  CHECK(rig.switchings.back().position[Axis::X] == Approx(20.0).margin(0.25));
}

TEST_CASE("Overrides of the spindle's speed hold from their place, for the S words behind them too",
          "[SPN-1][MAN-8][LNK-9]") {
  // The operator's override is 120 %. M49 takes it out of force, M48 puts it back, M51 sets it.
  struct Switched {
    double speed;
    double x;
    bool operator==(const Switched&) const = default;
  };
  struct Row {
    std::string_view rule;
    std::string_view program;
    std::vector<Switched> expected;
  };
  const std::vector<Row> rows{
      {"M49 alone", "M3 S6000\nG1 X20 F3000\nM49\nX40\n", {{7200, 0}, {6000, 20}}},
      {"S behind M49", "M3 S6000\nG1 X20 F3000\nM49\nS8000\nX40\n", {{7200, 0}, {8000, 20}}},
      {"S some way behind M49",
       "M3 S6000\nG1 X20 F3000\nM49\nX22\nS8000\nX40\n",
       {{7200, 0}, {6000, 20}, {8000, 22}}},
      {"S before M49",
       "M3 S6000\nG1 X20 F3000\nS8000\nX22\nM49\nX40\n",
       {{7200, 0}, {9600, 20}, {8000, 22}}},
      {"M48 behind M49", "M49\nM3 S6000\nG1 X20 F3000\nM48\nS8000\nX40\n", {{6000, 0}, {9600, 20}}},
      {"M51 with a value",
       "M3 S6000\nG1 X20 F3000\nM51 P50\nS8000\nX40\n",
       {{7200, 0}, {4000, 20}}},
      {"M51 P0 and S", "M3 S6000\nG1 X20 F3000\nM51 P0\nS8000\nX40\n", {{7200, 0}, {0, 20}}},
  };
  for (const Row& row : rows) {
    INFO(row.rule);
    WatchedRig rig;
    const double most = rig.machine.config().spindle.max_speed;
    Overrides overrides = rig.machine.overrides();
    overrides.speed = 1.2;
    REQUIRE(rig.machine.set_overrides(overrides));
    rig.start(std::string(row.program));
    REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 39.0; }, 10.0));
    std::vector<Switched> switched;
    for (const Switching& switching : rig.switchings)
      switched.push_back({std::round(switching.outputs.spindle_pwm * most / kFullPwm),
                          std::round(switching.position[Axis::X])});
    CHECK(switched == row.expected);
  }
}

TEST_CASE("Of overrides of the spindle's speed in quick succession the newest is there at once",
          "[MAN-8][SPN-1]") {
  WatchedRig rig(0.002);
  rig.start("M3 S10000\nG1 X100 F600\n");
  REQUIRE(rig.becomes([&] { return rig.shown()->velocity[Axis::X] != 0.0; }));
  for (int percent = 51; percent <= 90; ++percent)
    REQUIRE(rig.machine.set_overrides({1.0, 1.0, 0.01 * percent}));
  rig.run_for(0.01);
  const double part = 0.9 * 10'000.0 / rig.machine.config().spindle.max_speed;
  CHECK(rig.outputs().spindle_pwm == Approx(part * kFullPwm).margin(1.0));
}
