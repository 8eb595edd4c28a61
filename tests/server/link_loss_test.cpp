// Faults in the middle of a job, and the link that goes and comes back: what stops, what is known
// of the position afterwards, and how the operator goes on (LNK-4, STA-4). In virtual time.
#include <catch2/catch.hpp>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

namespace {

// The driver calls the board lost after 0.25 s; the board brakes when it has heard nothing for 0.2
// s (hostTimeout), and calls the host lost when it stands.
constexpr double kLongerThanEveryTimeOut = 1.0;

std::vector<std::string> mandatory_homing() {
  return {"AXIS_X.homeVelocity=0", "AXIS_Y.homeVelocity=0", "AXIS_Z.homeVelocity=0"};
}

/// Homing is mandatory and done, by hand; G54 is shifted. Z stands at its home position 10.
struct LossRig : Rig {
  LossRig() : Rig(shipped_machine(mandatory_homing())) {
    REQUIRE(reset());
    REQUIRE(state() == State::needs_homing);
    REQUIRE(home());
    REQUIRE(mdi("G10 L2 P1 X3 Y-4 Z5"));
    REQUIRE(state() == State::ready);
  }

  hal::sim::VirtualController& board() { return simulation.virtual_controller(); }
  hal::sim::VirtualMachine& bench() { return simulation.virtual_machine(); }

  /// Y stands, X moves at 20 mm/s, and the spindle turns.
  void start_cut() {
    start("M3 S12000\nG1 X500 F1200\n");
    REQUIRE(becomes([&] { return position()[Axis::X] > 20.0; }));
  }
  void pull_cable() {
    board().trouble().cable_out = true;
    REQUIRE(becomes(State::off, kLongerThanEveryTimeOut));
  }
  /// It takes the driver a greeting or two.
  void plug_cable() {
    board().trouble().cable_out = false;
    REQUIRE(becomes([&] { return state() != State::off; }, 2.0));
  }

  [[nodiscard]] Trust trust(Axis axis) const { return shown()->trust[axis]; }
  [[nodiscard]] std::string newest_warning() const {
    const auto messages = simulation.log().after(0);
    for (auto message = messages.rbegin(); message != messages.rend(); ++message)
      if (message->severity == Severity::warning) return message->text;
    return {};
  }
  [[nodiscard]] Position offset() const {
    return shown()->machine_position - shown()->work_position;
  }
  /// At a standstill: where an axis is trusted, the machine stands where the server says, less than
  /// a step apart, and its motor has followed every pulse.
  void check_that_no_trust_is_wrong() {
    for (const Axis axis : kLinearAxes) {
      INFO("axis " << axis_name(axis));
      const double step = 1.0 / std::abs(machine.config().axes[axis].steps_per_unit);
      const double apart = bench().physical_position()[axis] - position()[axis] - frame_[axis];
      if (trust(axis) != Trust::trusted) continue;
      CHECK(std::abs(apart) < step);
      CHECK(bench().lost_steps(axis) == lost_[axis]);
    }
  }
  /// What was homed by hand counts from there.
  void note_frame() {
    frame_ = bench().physical_position() - position();
    for (const Axis axis : kAllAxes) lost_[axis] = bench().lost_steps(axis);
  }

 private:
  Position frame_;
  AxisArray<std::uint64_t> lost_{};
};

}  // namespace

TEST_CASE("A cable out in the middle of a job ends it; the axes that moved are in doubt",
          "[LNK-4][safety]") {
  LossRig rig;
  rig.note_frame();
  const Position offset = rig.offset();
  rig.start_cut();
  rig.pull_cable();
  CHECK(rig.last_error().code == ErrorCode::link_lost);
  CHECK_FALSE(rig.shown()->job.ended_well);
  CHECK(rig.trust(Axis::X) == Trust::doubtful);
  CHECK(rig.trust(Axis::Y) == Trust::trusted);
  CHECK(rig.trust(Axis::Z) == Trust::trusted);
  CHECK_THAT(rig.newest_warning(), Contains("Home X, or check and accept the position."));
  rig.run_for(kLongerThanEveryTimeOut);
  CHECK_FALSE(rig.bench().outputs().spindle_on);  // by the board itself

  const Position stands = rig.bench().physical_position();
  rig.plug_cable();
  CHECK(rig.state() == State::error);  // the operator has to say so before anything goes on
  rig.run_for(1.0);
  CHECK(rig.bench().physical_position() == stands);
  CHECK(rig.offset() == offset);
  rig.check_that_no_trust_is_wrong();
}

TEST_CASE("After the cable is back the machine is reset and homed, and works again", "[LNK-4]") {
  LossRig rig;
  rig.start_cut();
  rig.pull_cable();
  rig.run_for(kLongerThanEveryTimeOut);
  rig.plug_cable();
  CHECK_FALSE(rig.machine.run());
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::needs_homing);
  CHECK(rig.shown()->state_text ==
        "The position of X is doubtful. Home X, or check and accept the position.");
  const auto refused = rig.machine.run();
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("accept the position"));
  REQUIRE(rig.home({Axis::X}));
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G53 G0 X7"));
  CHECK(rig.position()[Axis::X] == Approx(7.0).margin(1e-9));
}

TEST_CASE("The operator may check the position and accept it instead", "[LNK-4]") {
  LossRig rig;
  rig.start_cut();
  rig.pull_cable();
  rig.run_for(kLongerThanEveryTimeOut);
  rig.plug_cable();
  const auto too_early = rig.machine.accept_position({});
  REQUIRE_FALSE(too_early);
  CHECK(too_early.error().code == ErrorCode::command_not_allowed);
  REQUIRE(rig.reset());
  REQUIRE(rig.machine.accept_position({}));
  CHECK(rig.state() == State::ready);
  CHECK_THAT(rig.newest_warning(), Contains("The operator accepts") && Contains("axis X"));
  rig.simulation.cycle();
  CHECK(rig.homed(Axis::X));
  REQUIRE(rig.machine.run());
}

TEST_CASE("A cable out at rest costs no axis its trust, but the operator resets", "[LNK-4]") {
  LossRig rig;
  rig.note_frame();
  REQUIRE(rig.mdi("G0 X50 Y20"));
  rig.run_for(1.0);
  rig.pull_cable();
  rig.run_for(kLongerThanEveryTimeOut);
  rig.plug_cable();
  CHECK(rig.state() == State::error);
  for (const Axis axis : kLinearAxes) CHECK(rig.trust(axis) == Trust::trusted);
  rig.check_that_no_trust_is_wrong();
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G0 X0"));
}

TEST_CASE("An axis that begins to move behind the last that was heard is in doubt as well",
          "[LNK-4][safety]") {
  // X moves when the cable goes, and the board goes on for 0.2 s: the corner to Y lies in them.
  LossRig rig;
  rig.note_frame();
  rig.start("G53 G1 X100 F3000\nG53 Y100\n");
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 99.5; }));
  REQUIRE(rig.position()[Axis::Y] == Approx(0.0).margin(1e-9));
  rig.pull_cable();
  rig.run_for(kLongerThanEveryTimeOut);
  rig.plug_cable();
  CHECK(rig.position()[Axis::Y] > 0.05);  // the board went round the corner
  CHECK(rig.trust(Axis::X) == Trust::doubtful);
  CHECK(rig.trust(Axis::Y) == Trust::doubtful);
  CHECK(rig.trust(Axis::Z) == Trust::trusted);
  rig.check_that_no_trust_is_wrong();
}

TEST_CASE("A board that is reset in the middle of a job has lost the position of every axis",
          "[LNK-4][safety]") {
  LossRig rig;
  rig.note_frame();
  const Position offset = rig.offset();
  rig.start_cut();
  rig.board().board().reset();
  REQUIRE(rig.becomes(State::error, 2.0));
  for (const Axis axis : kLinearAxes) CHECK(rig.trust(axis) == Trust::unknown);
  CHECK_FALSE(rig.shown()->job.ended_well);
  CHECK(rig.last_error().code == ErrorCode::link_lost);
  CHECK_THAT(rig.newest_warning(), Contains("lost its step counts") && Contains("Home X, Y and Z"));
  // Shown where they were last seen: two cycles of 5 ms at 20 mm/s and the driver's own delay.
  CHECK(rig.position()[Axis::X] > 20.0);
  CHECK(rig.offset() == offset);
  rig.run_for(0.5);  // a motor without current needs a moment to run out
  const Position stands = rig.bench().physical_position();
  rig.run_for(2.0);
  // Nothing of the old path goes to the new board.
  CHECK(rig.bench().physical_position() == stands);
  rig.check_that_no_trust_is_wrong();

  REQUIRE(rig.reset());
  CHECK(rig.state() == State::needs_homing);
  REQUIRE(rig.home());
  CHECK(rig.state() == State::ready);
  rig.note_frame();
  REQUIRE(rig.mdi("G53 G0 X5"));
  rig.check_that_no_trust_is_wrong();
}

TEST_CASE("A board that was reset while the cable was out asks for homing", "[LNK-4][safety]") {
  LossRig rig;
  rig.pull_cable();
  rig.board().board().reset();
  rig.run_for(kLongerThanEveryTimeOut);
  rig.plug_cable();
  for (const Axis axis : kLinearAxes) CHECK(rig.trust(axis) == Trust::unknown);
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::needs_homing);
}

TEST_CASE("Jobs that are held and go on come through a cable that loses and delays",
          "[LNK-2][LNK-9][JOB-8]") {
  struct Row {
    const char* program;
    hal::sim::LinkTrouble trouble;
  };
  constexpr hal::sim::LinkTrouble kLoss{.loss = 0.2};
  constexpr hal::sim::LinkTrouble kJitter{.loss = 0.05, .jitter = 0.02};
  const char* const arcs =
      "G61.1 G91 F3000\nwhile [1 == 1]\nG3 X10 Y10 J10\nX-10 Y-10 J-10\nendwhile\n";
  const char* const chords =
      "G64 P0.01 F3000\n#1=0\nwhile [1 == 1]\nG1 X[40 + 10 * cos[#1]] Y[40 + 10 * sin[#1]]\n"
      "#1=[#1 + 0.7]\nendwhile\n";
  // Segments of a quarter of a millisecond.
  const char* const corners =
      "G64 P0.01 G91 F3000\nwhile [1 == 1]\nG1 X0.05 Y0.01\nX0.02 Y0.05\nX-0.06\nX0.01 Y-0.05\n"
      "X-0.02\nY-0.01\nendwhile\n";
  const auto [program, trouble] = GENERATE_COPY(values<Row>({{arcs, kLoss},
                                                             {arcs, kJitter},
                                                             {chords, kLoss},
                                                             {chords, kJitter},
                                                             {corners, kLoss},
                                                             {corners, kJitter}}));
  CAPTURE(program, trouble.loss, trouble.jitter);
  SimulationOptions options = at_zero();
  options.period = 0.002;
  ReadyRig rig(free_machine(), options);
  REQUIRE(rig.mdi("G0 X40 Y40"));
  rig.simulation.virtual_controller().trouble() = trouble;
  rig.start(program);
  for (int i = 0; i < 20; ++i) {
    rig.run_for(0.31 + 0.017 * i);
    REQUIRE(rig.pause());
    REQUIRE(rig.machine.resume());
  }
  rig.run_for(1.0);
  CHECK(rig.state() == State::running);
  for (const Axis axis : kLinearAxes) CHECK(rig.simulation.virtual_machine().lost_steps(axis) == 0);
}

TEST_CASE("A FIFO that runs dry while moving ends the job and puts its axes in doubt",
          "[LNK-2][LNK-4][safety]") {
  LossRig rig;
  rig.note_frame();
  const Position offset = rig.offset();
  rig.start_cut();
  rig.simulation.starve_machine(0.3);  // FifoTime is 0.25 s
  REQUIRE(rig.becomes(State::error, 2.0));
  CHECK_FALSE(rig.shown()->job.ended_well);
  CHECK_THAT(rig.last_error().message, Contains("underrun"));
  CHECK(rig.trust(Axis::X) == Trust::doubtful);
  CHECK(rig.trust(Axis::Y) == Trust::trusted);
  CHECK(rig.offset() == offset);
  rig.check_that_no_trust_is_wrong();
}

TEST_CASE("An emergency stop in a job puts the axes that moved in doubt", "[STA-4][LNK-4]") {
  LossRig rig;
  rig.note_frame();
  const Position offset = rig.offset();
  rig.start_cut();
  rig.bench().press_estop(true);
  REQUIRE(rig.becomes(State::estop, 0.1));
  CHECK(rig.trust(Axis::X) == Trust::doubtful);
  CHECK(rig.trust(Axis::Y) == Trust::trusted);
  CHECK(rig.offset() == offset);
  rig.check_that_no_trust_is_wrong();
  rig.bench().press_estop(false);
  rig.simulation.cycle();
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::needs_homing);
}

TEST_CASE("An emergency stop that is pressed while the cable is out shows when it is back",
          "[STA-4][LNK-4]") {
  LossRig rig;
  rig.pull_cable();
  rig.bench().press_estop(true);
  rig.plug_cable();
  CHECK(rig.becomes(State::estop, 0.5));
}

TEST_CASE("Whenever the cable goes, and for how long, trust never claims too much",
          "[LNK-4][safety]") {
  // A square at 50 mm/s with a corner every 0.4 s and a standstill in it. The board brakes after
  // 0.2 s, in which it has not stood still by 0.22 s; the server gives it up after 0.25 s.
  const double outage = GENERATE(0.1, 0.18, 0.21, 0.22, 0.24, 0.26, 0.4, 1.0);
  const int instant = GENERATE(range(0, 12));
  INFO("out for " << outage << " s, instant " << instant);
  LossRig rig;
  rig.note_frame();
  const Position offset = rig.offset();
  rig.start("G91 G1 X20 F3000\nY20\nG4 P0.3\nX-20 Z2\nY-20 Z-2\n");
  rig.run_for(0.05 + 0.17 * instant);
  rig.board().trouble().cable_out = true;
  rig.run_for(outage);
  rig.board().trouble().cable_out = false;
  rig.run_for(4.0);
  CHECK(rig.state() != State::off);
  CHECK(rig.state() != State::running);
  rig.check_that_no_trust_is_wrong();
  const bool in_doubt =
      rig.shown()->trust != AxisArray<Trust>{{Trust::trusted, Trust::trusted, Trust::trusted,
                                              Trust::unknown, Trust::unknown, Trust::unknown}};
  if (in_doubt) CHECK_FALSE(rig.shown()->job.ended_well);
  CHECK(rig.offset()[Axis::X] == Approx(offset[Axis::X]));
  if (rig.state() == State::ready) return;
  REQUIRE(rig.reset());
  CHECK(rig.state() == (in_doubt ? State::needs_homing : State::ready));
}

TEST_CASE("Whatever ends a job, and when, trust never claims too much", "[LNK-4][STA-4][safety]") {
  struct Row {
    std::string_view name;
    std::function<void(LossRig&)> strike;
  };
  const std::vector<Row> kFaults{
      {"emergency stop", [](LossRig& rig) { rig.bench().press_estop(true); }},
      {"board reset", [](LossRig& rig) { rig.board().board().reset(); }},
      {"FIFO underrun", [](LossRig& rig) { rig.simulation.starve_machine(0.4); }},
      {"home switch as emergency stop",
       [](LossRig& rig) {
         rig.bench().stick_switch(Axis::X, hal::sim::VirtualMotor::Switch::home, true);
       }},
      {"reset by the operator",
       [](LossRig& rig) { rig.machine.reset([](const Result<void>&) {}); }},
  };
  const std::size_t fault = GENERATE(range<std::size_t>(0, 5));
  const int instant = GENERATE(range(0, 25));
  INFO(kFaults[fault].name << ", instant " << instant);
  LossRig rig;
  rig.note_frame();
  const Position offset = rig.offset();
  rig.start("HomeIsEstop on\nG91 G1 X20 F3000\nY20\nG4 P0.3\nX-20 Z2\nY-20 Z-2\n");
  rig.run_for(0.03 + 0.083 * instant);
  kFaults[fault].strike(rig);
  rig.run_for(1.0);
  rig.check_that_no_trust_is_wrong();
  CHECK(rig.offset()[Axis::X] == Approx(offset[Axis::X]));
}

TEST_CASE("A motor that still comes to rest behind its last pulse counts as moving",
          "[LNK-4][STA-4][safety]") {
  const int cycles = GENERATE(range(0, 12));
  INFO("emergency stop " << cycles << " cycles of 5 ms behind the last pulse");
  LossRig rig;
  rig.note_frame();
  rig.start("G53 G1 X20 F3000\nG4 P1\n");
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] == Approx(20.0).margin(1e-9); }));
  rig.run_for(0.005 * cycles);
  rig.bench().press_estop(true);
  rig.run_for(0.5);
  CHECK(rig.trust(Axis::X) == Trust::doubtful);
  CHECK(rig.trust(Axis::Y) == Trust::trusted);
  rig.check_that_no_trust_is_wrong();
}

TEST_CASE("A motor that has come to rest is trusted, whatever stops the job then",
          "[LNK-4][STA-4]") {
  LossRig rig;
  rig.note_frame();
  rig.start("G53 G1 X20 F3000\nG4 P1\n");
  REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] == Approx(20.0).margin(1e-9); }));
  rig.run_for(0.2);
  rig.bench().press_estop(true);
  rig.run_for(0.5);
  CHECK(rig.trust(Axis::X) == Trust::trusted);
  rig.check_that_no_trust_is_wrong();
}

TEST_CASE("A fault just as an axis gets its home position does not make it trusted",
          "[LNK-4][HOM-2][safety]") {
  // At every cycle of a homing by hand: either it has come to its end, or the axis is not trusted.
  for (int cycles = 0; cycles < 6; ++cycles) {
    INFO("pressed after " << cycles << " cycles");
    LossRig rig;
    REQUIRE(rig.mdi("G53 G0 X20"));
    rig.note_frame();
    const double before = rig.position()[Axis::X];
    rig.machine.home({Axis::X}, [](const Result<void>&) {});
    for (int i = 0; i < cycles; ++i) rig.simulation.cycle();
    rig.bench().press_estop(true);
    REQUIRE(rig.becomes(State::estop, 0.1));
    rig.run_for(0.1);
    const bool counts_anew = std::abs(rig.position()[Axis::X] - before) > 1.0;
    CHECK(counts_anew >= rig.homed(Axis::X));
  }
}

TEST_CASE("Whoever wants to know is told once when the board is lost", "[LNK-4]") {
  LossRig rig;
  int told = 0;
  rig.machine.set_loss_listener([&] { ++told; });
  rig.start_cut();
  rig.pull_cable();
  rig.run_for(kLongerThanEveryTimeOut);
  CHECK(told == 1);
}
