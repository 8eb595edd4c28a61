// Guard rules on the inputs of I/O cards: what the operator is told, and what becomes of the job.
#include <catch2/catch.hpp>
#include <utility>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

/// Rule 3 of card 2, on its input 5 going on.
struct GuardedRig : Rig {
  explicit GuardedRig(config::GuardAction action, bool on_from_the_start = false,
                      std::vector<std::string> settings = {}, double period = 0.005)
      : Rig(guarded(action, std::move(settings)), with_card(on_from_the_start, period)) {}

  static MachineData guarded(config::GuardAction action, std::vector<std::string> settings) {
    MachineData data = free_machine(std::move(settings));
    data.config.guards[8 + 2] = {"Vacuum too low", 16, 16, action};
    return data;
  }
  static SimulationOptions with_card(bool on, double period) {
    SimulationOptions options = at_zero();
    options.period = period;
    options.machine.io_cards[1] = true;
    options.machine.ports_on = on ? 1ULL << kInput : 0;
    return options;
  }
  void set_input(bool on) { simulation.virtual_machine().set_port_input(kInput, on); }
  void run_job() {
    REQUIRE(reset());
    start("M3 S12000\nM8\nG1 X100 F3000\nX0\n");
    REQUIRE(becomes([&] { return position()[Axis::X] > 20.0; }, 10.0));
  }
  [[nodiscard]] int times_told() const {
    int times = 0;
    for (const auto& message : simulation.log().after(0))
      if (message.severity == Severity::warning &&
          message.text == "I/O card 2, rule 3: Vacuum too low")
        ++times;
    return times;
  }
  [[nodiscard]] const hal::cpu5::firmware::Outputs& outputs() {
    return simulation.virtual_machine().outputs();
  }

  static constexpr std::size_t kInput = 16 + 8 + 4;
};

}  // namespace

TEST_CASE("A rule that warns tells its text each time, and the job goes on", "[CFG-16][LNK-5]") {
  GuardedRig rig(config::GuardAction::warning);
  rig.run_job();
  CHECK(rig.times_told() == 0);
  rig.set_input(true);
  rig.run_for(0.1);
  CHECK(rig.times_told() == 1);
  CHECK(rig.state() == State::running);
  rig.set_input(false);
  rig.run_for(1.0);
  rig.set_input(true);
  rig.run_for(0.1);
  CHECK(rig.times_told() == 2);
  REQUIRE(rig.becomes(State::ready));
  CHECK(rig.position()[Axis::X] == Approx(0.0).margin(0.01));
}

TEST_CASE("A rule with a smooth stop ends the job along its path; positions stay trusted",
          "[CFG-16][LNK-5][safety]") {
  GuardedRig rig(config::GuardAction::smooth_stop);
  rig.run_job();
  const double x = rig.position()[Axis::X];
  const auto trust = rig.shown()->trust;
  rig.set_input(true);
  REQUIRE(rig.becomes(State::error, 1.0));
  CHECK(rig.last_error().code == ErrorCode::guard_stop);
  CHECK(rig.times_told() == 1);
  rig.run_for(0.2);
  // Braking from 50 mm/s takes v^2 / 2a, and the board acts within a slice; the status is younger
  // than two cycles.
  const double a = rig.machine.config().axes[Axis::X].acceleration;
  const double way = 50.0 * 50.0 / (2 * a);
  CHECK(rig.position()[Axis::X] > x + 0.9 * way);
  CHECK(rig.position()[Axis::X] < x + 1.1 * way + 50.0 * 0.015);
  CHECK(rig.simulation.virtual_machine().physical_position(Axis::X) ==
        Approx(rig.position()[Axis::X]).margin(0.01));
  CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
  CHECK(rig.shown()->trust == trust);
  CHECK_FALSE(rig.outputs().flood);
  CHECK_FALSE(rig.outputs().spindle_on);
  // The input stays; the operator may go on.
  REQUIRE(rig.reset());
  REQUIRE(rig.mdi("G1 X5 F3000"));
  CHECK(rig.position()[Axis::X] == Approx(5.0).margin(0.01));
}

TEST_CASE("A contact that bounces while nothing moves leaves a machine that drives",
          "[CFG-16][LNK-5][safety]") {
  GuardedRig rig(config::GuardAction::smooth_stop);
  REQUIRE(rig.reset());
  // Three times within a cycle: the board stops again for a touch that comes before its release.
  auto& board = rig.simulation.virtual_controller().board();
  for (int i = 0; i < 3; ++i) {
    for (const bool on : {true, false}) {
      rig.set_input(on);
      board.advance_to(board.now() + 0.0005);
    }
  }
  rig.run_for(0.1);
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G1 X10 F3000"));
  CHECK(rig.position()[Axis::X] == Approx(10.0).margin(0.01));
}

TEST_CASE("A rule with a quick stop is a fault: positions of what moved are doubtful",
          "[CFG-16][LNK-5][safety]") {
  GuardedRig rig(config::GuardAction::quick_stop);
  rig.run_job();
  rig.set_input(true);
  REQUIRE(rig.becomes(State::error, 1.0));
  CHECK(rig.last_error().code == ErrorCode::guard_stop);
  CHECK(rig.times_told() == 1);
  rig.run_for(0.1);
  CHECK(rig.outputs() == hal::cpu5::firmware::Outputs{});
  CHECK(rig.shown()->trust[Axis::X] != Trust::trusted);
  REQUIRE(rig.reset());
  CHECK(rig.state() == State::ready);
}

TEST_CASE("The text of an input that flickers is told once a second, with how often it came",
          "[CFG-16]") {
  GuardedRig rig(config::GuardAction::warning);
  REQUIRE(rig.reset());
  // On for a cycle of 5 ms and off for one, 300 times: for 3 s.
  for (int i = 0; i < 300; ++i) {
    rig.set_input(true);
    rig.simulation.cycle();
    rig.set_input(false);
    rig.simulation.cycle();
  }
  rig.run_for(1.1);
  std::vector<int> told;
  int all = 0;
  for (const auto& message : rig.simulation.log().after(0)) {
    if (!message.text.starts_with("I/O card 2, rule 3: Vacuum too low")) continue;
    const auto bracket = message.text.find('(');
    told.push_back(bracket == std::string::npos ? 1 : std::stoi(message.text.substr(bracket + 1)));
    all += told.back();
  }
  REQUIRE(told.size() == 4);
  CHECK(told.front() == 1);  // at once
  CHECK(told[1] == Approx(100).margin(1));
  CHECK(all == 300);
}

TEST_CASE("A rule that acts while nothing goes on is told and ends nothing", "[CFG-16]") {
  GuardedRig rig(config::GuardAction::smooth_stop);
  REQUIRE(rig.reset());
  rig.set_input(true);
  rig.run_for(0.1);
  CHECK(rig.times_told() == 1);
  CHECK(rig.state() == State::ready);
  REQUIRE(rig.mdi("G1 X5 F3000"));
  CHECK(rig.position()[Axis::X] == Approx(5.0).margin(0.01));
}

TEST_CASE("A jog ends by a smooth stop", "[CFG-16][safety]") {
  GuardedRig rig(config::GuardAction::smooth_stop);
  REQUIRE(rig.reset());
  Position rates;
  rates[Axis::X] = 0.5;
  REQUIRE(rig.machine.jog(rates, 10.0));
  rig.run_for(0.5);
  rig.set_input(true);
  REQUIRE(rig.becomes(State::error, 2.0));
  const Position place = rig.position();
  rig.run_for(0.5);
  CHECK(rig.position() == place);
}

TEST_CASE("A rule that is true already when the board is connected is told", "[CFG-16]") {
  GuardedRig rig(config::GuardAction::warning, true);
  rig.run_for(0.05);
  CHECK(rig.times_told() == 1);
}

TEST_CASE("A hold while a guard brakes along more segments than the board holds starves no path",
          "[CFG-16][LNK-5][LNK-8][safety]") {
  // At 8 mm/s^2 braking from 50 mm/s takes 6.25 s and 3.13 s of path time, the board's 1024
  // segments of 2.5 ms last for 2.56 s, and the 6.5 s of MotionFeed::lead() are sent.
  for (const int ms : {-6, -4, -2, 0, 2, 5, 20, 200}) {
    CAPTURE(ms);
    GuardedRig rig(
        config::GuardAction::smooth_stop, false,
        {"AXIS_X.acceleration=8", "AXIS_X.velocity=50", "TRAJECTORY.interpolationTime=0.0025"},
        0.001);
    rig.simulation.virtual_controller().trouble().delay = 0.004;
    REQUIRE(rig.reset());
    rig.start("G1 X400 F3000\nX0\n");
    REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 160.0; }, 10.0));
    const double guard_at = rig.simulation.time() + 0.02;
    bool acted = false;
    while (rig.simulation.time() < guard_at + 7.0) {
      if (rig.simulation.time() >= guard_at) rig.set_input(true);
      if (!std::exchange(acted, acted || rig.simulation.time() >= guard_at + 0.001 * ms) && acted)
        rig.machine.pause([](const Result<void>&) {});
      rig.simulation.cycle();
    }
    CHECK(rig.state() == State::error);
    CHECK(rig.last_error().code == ErrorCode::guard_stop);
    CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
    CHECK(rig.simulation.virtual_machine().physical_position(Axis::X) ==
          Approx(rig.position()[Axis::X]).margin(0.01));
  }
}

TEST_CASE(
    "Whatever the operator does while a guard brakes, at any millisecond of it: the machine "
    "comes to its stop along the path",
    "[CFG-16][LNK-5][LNK-8][safety]") {
  // At 100 mm/s^2 braking from 50 mm/s takes 0.5 s and 0.25 s of path time, which is more than the
  // board holds: the path is fed on meanwhile.
  struct Row {
    std::string_view what;
    bool jog;
    void (*act)(GuardedRig&);
  };
  const std::vector<Row> rows{
      {"pause", false, [](GuardedRig& rig) { rig.machine.pause([](const Result<void>&) {}); }},
      {"stop", false, [](GuardedRig& rig) { rig.machine.stop([](const Result<void>&) {}); }},
      {"feed override", false,
       [](GuardedRig& rig) {
         Overrides overrides = rig.machine.overrides();
         overrides.feed = 1.5;
         REQUIRE(rig.machine.set_overrides(overrides));
       }},
      {"jog key let go", true, [](GuardedRig& rig) { rig.machine.jog_stop(); }},
      {"another jog rate", true,
       [](GuardedRig& rig) {
         Position rates;
         rates[Axis::X] = 0.1;
         static_cast<void>(rig.machine.jog(rates, 10.0));
       }},
  };
  for (const Row& row : rows) {
    for (int ms = -12; ms <= 480; ms += ms < 24 ? 1 : 152) {
      CAPTURE(row.what, ms);
      GuardedRig rig(config::GuardAction::smooth_stop, false,
                     {"AXIS_X.acceleration=100", "AXIS_X.velocity=50"}, 0.001);
      rig.simulation.virtual_controller().trouble().delay = 0.004;
      REQUIRE(rig.reset());
      if (row.jog) {
        Position rates;
        rates[Axis::X] = 1.0;
        REQUIRE(rig.machine.jog(rates, 10.0));
      } else {
        rig.start("M8\nG1 X200 F3000\nX0\n");
      }
      REQUIRE(rig.becomes([&] { return rig.position()[Axis::X] > 20.0; }, 10.0));
      const double guard_at = rig.simulation.time() + 0.02;
      const double act_at = guard_at + 0.001 * ms;
      const auto trust = rig.shown()->trust;
      bool is_set = false;
      bool acted = false;
      while (rig.simulation.time() < guard_at + 0.8) {
        if (!std::exchange(is_set, is_set || rig.simulation.time() >= guard_at) && is_set)
          rig.set_input(true);
        if (!std::exchange(acted, acted || rig.simulation.time() >= act_at) && acted) row.act(rig);
        rig.simulation.cycle();
      }
      CHECK(rig.state() == State::error);
      CHECK(rig.last_error().code == ErrorCode::guard_stop);
      CHECK(rig.shown()->trust == trust);
      CHECK(rig.simulation.virtual_machine().physical_position(Axis::X) ==
            Approx(rig.position()[Axis::X]).margin(0.01));
      CHECK(rig.simulation.virtual_machine().lost_steps(Axis::X) == 0);
      CHECK(rig.outputs() == hal::cpu5::firmware::Outputs{.drives_enabled = true});
      // And it goes on, from where it stands.
      REQUIRE(rig.reset());
      const double x = rig.position()[Axis::X];
      REQUIRE(rig.mdi("G91 G1 X1 F3000"));
      CHECK(rig.position()[Axis::X] == Approx(x + 1.0).margin(0.01));
    }
  }
}
