// What a scenario's events do to a machine, and when.
#include "hal/sim/scenario_player.h"

#include "tests/allocations.h"
#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;
using cpu5::firmware::PortBits;
using cpu5::firmware::Ticks;

namespace {

/// A machine, a cable and the events of a scenario; time in milliseconds.
class Play {
 public:
  explicit Play(std::string_view events)
      : scenario(parse_scenario(events, "test.toml").value()),
        machine(small_machine(), scenario.machine),
        player(scenario.events) {
    machine.set_outputs({.drives_enabled = true});
  }
  /// Steps of X, one per millisecond.
  void step(int count) {
    for (int i = 0; i < std::abs(count); ++i) {
      machine.step(0, count < 0 ? -1 : 1, now);
      pass(1);
    }
  }
  cpu5::firmware::Inputs pass(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      now += ScenarioPlayer::kLookInterval;
      machine.inputs(now);
      player.advance(now, stage);
    }
    return machine.inputs(now);
  }

  Scenario scenario;
  VirtualMachine machine;
  ScenarioPlayer player;
  LinkTrouble trouble;
  Stage stage{machine, trouble};
  Ticks now = 0;
};

std::string event_at(double seconds, const std::string& rest) {
  return "[[event]]\nat = " + std::to_string(seconds) + "\n" + rest + "\n";
}

/// One event in a second, in a virtual controller whose drives are on.
std::unique_ptr<VirtualController> controller_with(const std::string& events) {
  const Scenario scenario = parse_scenario(events, "test.toml").value();
  return make_virtual_controller(small_machine(), {.machine = scenario.machine,
                                                   .driver = {.host_timeout = 0},
                                                   .link = scenario.link,
                                                   .events = scenario.events});
}

}  // namespace

TEST_CASE("Each action does to the machine what it says, at its time", "[hal][scenario]") {
  using Check = bool (*)(Play&);
  struct Row {
    const char* action;
    Check done;
  };
  const auto row = GENERATE(values<Row>({
      {"\"cable_out\"", [](Play& p) { return p.trouble.cable_out; }},
      {"\"board_reset\"", [](Play& p) { return p.stage.reset_board; }},
      {"\"link_trouble\"\nloss = 0.5", [](Play& p) { return p.trouble.loss == 0.5; }},
      {"\"link_trouble\"\nduplication = 0.5", [](Play& p) { return p.trouble.duplication == 0.5; }},
      {"\"link_trouble\"\ncorruption = 0.5", [](Play& p) { return p.trouble.corruption == 0.5; }},
      {"\"link_trouble\"\ndelay = 0.5", [](Play& p) { return p.trouble.delay == 0.5; }},
      {"\"link_trouble\"\njitter = 0.5", [](Play& p) { return p.trouble.jitter == 0.5; }},
      {"\"switch_stuck\"\nswitch = \"home\"\naxis = \"Z\"\nstate = \"on\"",
       [](Play& p) { return p.machine.inputs(p.now).home == 0b000100; }},
      {"\"switch_stuck\"\nswitch = \"limit_low\"\naxis = \"Y\"\nstate = \"on\"",
       [](Play& p) { return p.machine.inputs(p.now).ports == 0b01; }},
      {"\"switch_stuck\"\nswitch = \"limit_high\"\naxis = \"Y\"\nstate = \"on\"",
       [](Play& p) { return p.machine.inputs(p.now).ports == 0b10; }},
      {"\"probe_stuck\"\nstate = \"on\"", [](Play& p) { return p.machine.inputs(p.now).probe; }},
      {"\"door_stuck\"\nstate = \"on\"",
       [](Play& p) { return p.machine.inputs(p.now).ports == 0b100; }},
      {"\"door_open\"", [](Play& p) { return p.machine.door_open(); }},
      {"\"estop_press\"",
       [](Play& p) { return p.machine.inputs(p.now).estop1 && p.machine.inputs(p.now).estop2; }},
      {"\"estop_press\"\nchannel = \"1\"",
       [](Play& p) { return p.machine.inputs(p.now).estop1 && !p.machine.inputs(p.now).estop2; }},
      {"\"external_error\"\non = true",
       [](Play& p) { return p.machine.inputs(p.now).external_error; }},
      {"\"step_loss\"\naxis = \"X\"\nsteps = -40",
       [](Play& p) {
         // 40 steps of 200 steps/mm from the middle of the travel, 100.5 mm
         return p.machine.lost_steps(Axis::X) == 40 &&
                std::abs(p.machine.physical_position(Axis::X) - 100.3) < 1e-9;
       }},
      {"\"drive_alarm\"\naxis = \"A\"\non = true",
       [](Play& p) { return p.machine.inputs(p.now).alarm == 0b001000; }},
      {"\"analog\"\ninput = 3\nvalue = 0.5",
       [](Play& p) {
         return p.machine.inputs(p.now).analog[2] == cpu5::firmware::Inputs::kFullAnalog / 2;
       }},
      {"\"port\"\nport = 101\non = true",
       [](Play& p) { return p.machine.inputs(p.now).ports == PortBits{1} << 16; }},
      {"\"hand_wheel\"\ncounts = -3",
       [](Play& p) { return p.machine.inputs(p.now).hand_wheel_count == -3; }},
      {"\"load_tool\"\nnumber = 9", [](Play& p) { return p.machine.tool_length() == 33.0; }},
  }));
  INFO(row.action);
  Play play(std::string("[[tool]]\nnumber = 9\nlength = 33\n[door]\nport = 3\n[axis.Y]\n"
                        "limit_low_port = 1\nlimit_high_port = 2\n") +
            event_at(0.05, std::string("action = ") + row.action));
  play.pass(49);
  CHECK_FALSE(row.done(play));
  play.pass(1);
  CHECK(row.done(play));
  CHECK(play.player.next() == ScenarioPlayer::kNever);
}

TEST_CASE("What an event has done another one takes back", "[hal][scenario]") {
  Play play(event_at(0.01, "action = \"cable_out\"") + event_at(0.02, "action = \"cable_in\"") +
            event_at(0.01, "action = \"estop_press\"") +
            event_at(0.02, "action = \"estop_release\"\nchannel = \"1\"") +
            event_at(0.01, "action = \"door_open\"") + event_at(0.02, "action = \"door_close\"") +
            event_at(0.01, "action = \"probe_stuck\"\nstate = \"on\"") +
            event_at(0.02, "action = \"probe_stuck\"\nstate = \"free\""));
  play.pass(10);
  CHECK(play.trouble.cable_out);
  CHECK(play.machine.door_open());
  CHECK(play.machine.inputs(play.now).probe);
  const auto inputs = play.pass(10);
  CHECK_FALSE(play.trouble.cable_out);
  CHECK_FALSE(play.machine.door_open());
  CHECK_FALSE(inputs.probe);
  CHECK_FALSE(inputs.estop1);
  CHECK(inputs.estop2);
}

TEST_CASE("Index pulses are missing between two events", "[hal][scenario][LNK-6]") {
  Play play(event_at(2, "action = \"index_missing\"") + event_at(3, "action = \"index_back\""));
  play.machine.set_outputs(
      {.tool_direction = true, .spindle_pwm = cpu5::firmware::Outputs::kFullPwm});
  const auto before = play.pass(2000).index_count;
  CHECK(play.pass(1000).index_count == before);
  CHECK(play.pass(1000).index_count == Approx(before + 400).margin(1));  // 24000 rpm
}

TEST_CASE("An event with a place happens once, when the axis comes from the other side",
          "[hal][scenario]") {
  // X stands at 100.5 mm; 200 steps/mm.
  Play play(
      "[[event]]\nwhen = { axis = \"X\", beyond = 100.6 }\naction = \"cable_out\"\n"
      "[[event]]\nwhen = { axis = \"X\", below = 100.55 }\naction = \"board_reset\"\n");
  play.pass(5);
  CHECK_FALSE(play.stage.reset_board);  // it stands there already
  play.step(20);
  CHECK_FALSE(play.trouble.cable_out);  // at 100.6, not beyond
  play.step(1);
  CHECK(play.trouble.cable_out);
  CHECK_FALSE(play.stage.reset_board);
  play.step(-12);
  CHECK(play.stage.reset_board);  // at 100.545
  play.trouble.cable_out = false;
  play.step(12);
  CHECK_FALSE(play.trouble.cable_out);
  CHECK(play.player.next() == ScenarioPlayer::kNever);
}

TEST_CASE("Events do not depend on how often the host asks", "[hal][scenario]") {
  // Each millisecond of the motion counts: 40 mm/s would be 8 steps of 200 steps/mm.
  const auto lost_at = [](double cycle) {
    const auto controller = controller_with(
        "[machine]\nstart = { X = 0 }\n"
        "[[event]]\nwhen = { axis = \"X\", beyond = 1.0 }\naction = \"estop_press\"\n");
    REQUIRE(controller->connect());
    controller->set_outputs({.drives_enabled = true});
    controller->exchange(0.0);
    Segment segment{.id = 1, .duration = 0.1};
    segment.position[Axis::X] = 3.0;
    controller->push({&segment, 1});
    for (double now = 0.0; now < 0.3; now += cycle) controller->exchange(now);
    const double stopped = controller->exchange(0.5).position[Axis::X];
    CHECK(controller->exchange(0.5).faults != 0);
    return stopped;
  };
  const double stopped = lost_at(0.001);
  CHECK(stopped > 1.0);
  CHECK(stopped < 1.1);
  CHECK(lost_at(0.0007) == stopped);
  CHECK(lost_at(0.01) == stopped);
  CHECK(lost_at(0.3) == stopped);
}

TEST_CASE("Without its cable the board is not heard, and its FIFO runs on until it is back",
          "[hal][scenario][LNK-8]") {
  const auto controller =
      controller_with("[machine]\nstart = { X = 0 }\n" + event_at(0.05, "action = \"cable_out\"") +
                      event_at(3.0, "action = \"cable_in\""));
  Hand hand(*controller);
  Segment segment{.id = 1, .duration = 0.1};
  segment.position[Axis::X] = 2.5;
  controller->push({&segment, 1});
  CHECK(hand.status().connected);
  for (int i = 0; i < 200; ++i) hand.wait(0.01);
  CHECK_FALSE(hand.status().connected);
  CHECK(controller->machine().physical_position(Axis::X) == Approx(2.5));
  for (int i = 0; i < 300; ++i) hand.wait(0.01);
  CHECK(hand.status().connected);
  CHECK(hand.status().position[Axis::X] == Approx(2.5));
}

TEST_CASE("A board that was reset has forgotten everything, the machine has not",
          "[hal][scenario][LNK-8]") {
  const auto controller =
      controller_with("[machine]\nstart = { X = 0 }\n" + event_at(1.0, "action = \"board_reset\""));
  Hand hand(*controller);
  hand.move(Axis::X, 5.0);
  CHECK(hand.status().position[Axis::X] == Approx(5.0));
  CHECK(hand.status().outputs.drives_enabled);
  for (int i = 0; i < 300; ++i) hand.wait(0.01);
  CHECK(hand.status().connected);
  CHECK(hand.status().counts_lost);
  CHECK_FALSE(hand.status().outputs.drives_enabled);
  CHECK_FALSE(controller->machine().outputs().drives_enabled);
  CHECK(controller->machine().physical_position(Axis::X) == Approx(5.0));
  CHECK(controller->machine().lost_steps(Axis::X) == 0);
}

TEST_CASE("The same scenario gives the same machine, another seed another one", "[hal][scenario]") {
  const auto homes = [](int seed) {
    Play play("[machine]\nswitch_bounce = 0.02\nstart = { X = 301.0 }\nseed = " +
              std::to_string(seed) + "\n");
    play.step(40);
    std::vector<bool> seen;
    for (int i = 0; i < 30; ++i) seen.push_back(play.pass(1).home != 0);
    return seen;
  };
  CHECK(homes(3) == homes(3));
  CHECK(homes(3) != homes(4));
}

TEST_CASE("Playing events allocates nothing", "[hal][scenario]") {
  Play play(event_at(0.01, "action = \"load_tool\"\nnumber = 1") +
            event_at(0.02, "action = \"link_trouble\"\nloss = 0.1") +
            "[[event]]\nwhen = { axis = \"X\", beyond = 100.51 }\naction = \"step_loss\"\n"
            "axis = \"X\"\nsteps = 5\n");
  const std::size_t before = test::allocations();
  play.step(50);
  const std::size_t after = test::allocations();
  CHECK(after == before);
  CHECK(play.machine.lost_steps(Axis::X) == 5);
}
