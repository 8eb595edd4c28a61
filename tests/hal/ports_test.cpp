// Outputs reach the machine and inputs come back, through driver, frame and firmware.
#include "hal/ports.h"

#include <limits>

#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

namespace {

Outputs one_of_everything() {
  Outputs outputs{.drives_enabled = true,
                  .spindle_on = true,
                  .tool_direction = true,
                  .spindle_pwm = 0.25,
                  .mist = true,
                  .flood = true};
  outputs.ports.set(*port_bit(1)).set(*port_bit(16)).set(*port_bit(103)).set(*port_bit(308));
  outputs.pwm[0] = 0.5;
  outputs.pwm[7] = 1.0;
  return outputs;
}

}  // namespace

TEST_CASE("A port's number names its bit as in M54: AUX, then the cards", "[hal][GCO-10][LNK-5]") {
  CHECK(port_bit(1) == 0U);
  CHECK(port_bit(16) == 15U);
  CHECK(port_bit(101) == 16U);
  CHECK(port_bit(103) == 18U);  // card 1 port 3
  CHECK(port_bit(208) == 31U);  // card 2 port 8
  CHECK(port_bit(308) == 39U);
  for (const int none : {-101, -1, 0, 17, 51, 100, 109, 200, 309, 401, 2'000'000'001}) {
    CHECK_FALSE(port_bit(none));
  }
  CHECK(port_number(15) == 16);
  CHECK(port_number(31) == 208);  // card 2 port 8
  for (std::size_t bit = 0; bit < Ports{}.size(); ++bit) CHECK(port_bit(port_number(bit)) == bit);
}

TEST_CASE("Every output reaches the machine and comes back in the status", "[hal][GCO-10][SPN-1]") {
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  const Outputs wanted = one_of_everything();
  controller->set_outputs(wanted);
  CHECK(hand.status().outputs == wanted);
  const cpu5::firmware::Outputs& pins = controller->machine().outputs();
  CHECK(pins.ports == 0x80'0004'8001);  // bits 39, 18, 15 and 0
  CHECK(pins.pwm[0] == cpu5::firmware::Outputs::kFullPwm / 2);
  CHECK(pins.pwm[7] == cpu5::firmware::Outputs::kFullPwm);
  CHECK(pins.pwm[1] == 0);
  CHECK(pins.tool_direction);
  CHECK(pins.spindle_pwm == cpu5::firmware::Outputs::kFullPwm / 4);
}

TEST_CASE("Direction and PWM of the spindle are outputs of their own", "[hal][GCO-10]") {
  // M84 turns TOOLDIR on and leaves the PWM; M87 turns the PWM off and leaves TOOLDIR.
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  controller->set_outputs({.tool_direction = true});
  hand.wait(1.0 / 4);
  CHECK(controller->machine().outputs().tool_direction);
  CHECK(controller->machine().spindle_speed() == 0.0);
}

TEST_CASE("A PWM value beyond its range is the end of the range, and no number is off", "[hal]") {
  struct Row {
    double asked;
    double set;
  };
  const Row row = GENERATE(values<Row>({{-0.5, 0.0},
                                        {1.5, 1.0},
                                        {std::numeric_limits<double>::infinity(), 1.0},
                                        {std::numeric_limits<double>::quiet_NaN(), 0.0}}));
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  Outputs outputs{.spindle_pwm = row.asked};
  outputs.pwm[3] = row.asked;
  controller->set_outputs(outputs);
  CHECK(hand.status().outputs.spindle_pwm == row.set);
  CHECK(hand.status().outputs.pwm[3] == row.set);
}

TEST_CASE("A fault switches every output off", "[hal][STA-4][GCO-10]") {
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  controller->set_outputs(one_of_everything());
  hand.status();
  const bool second = GENERATE(false, true);
  if (second) {
    controller->machine().press_estop2(true);
  } else {
    controller->machine().press_estop(true);
  }
  hand.wait(0.001);
  CHECK(hand.status().faults == static_cast<Faults>(Fault::estop));
  CHECK(hand.status().inputs.estop1 == !second);
  CHECK(hand.status().inputs.estop2 == second);
  CHECK(hand.status().outputs == Outputs{});
  CHECK(controller->machine().outputs() == cpu5::firmware::Outputs{});
}

TEST_CASE("Inputs come from the machine to the status", "[hal][GCO-10]") {
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  VirtualMachine& machine = controller->machine();
  machine.set_port_input(*port_bit(3), true);
  machine.set_port_input(*port_bit(208), true);
  machine.raise_external_error(true);
  machine.set_analog_input(0, 0.25);
  machine.set_analog_input(7, 2.0);
  hand.wait(0.001);
  Ports expected;
  expected.set(2).set(31);
  CHECK(hand.status().inputs.ports == expected);
  CHECK(hand.status().inputs.external_error);
  CHECK(hand.status().inputs.analog[0] == 0.25);
  CHECK(hand.status().inputs.analog[7] == 1.0);
  CHECK(hand.status().inputs.analog[3] == 0.0);
  CHECK(hand.status().faults == 0);

  machine.set_port_input(*port_bit(3), false);
  machine.raise_external_error(false);
  hand.wait(0.001);
  CHECK(hand.status().inputs.ports == expected.reset(2));
  CHECK_FALSE(hand.status().inputs.external_error);
}

TEST_CASE("The hand wheel counts quarter steps, and its tracks follow A before B", "[hal]") {
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  struct Row {
    bool a;
    bool b;
  };
  for (const Row row : {Row{true, false}, Row{true, true}, Row{false, true}, Row{false, false}}) {
    controller->machine().turn_hand_wheel(1);
    hand.wait(0.001);
    CHECK(hand.status().inputs.hand_wheel_a == row.a);
    CHECK(hand.status().inputs.hand_wheel_b == row.b);
  }
  controller->machine().turn_hand_wheel(-100);
  hand.wait(0.001);
  CHECK(hand.status().inputs.hand_wheel_count == -96);
}

TEST_CASE("A looped-back output drives its input after the relay's delay", "[hal][GCO-10]") {
  const auto controller =
      make_virtual_controller(small_machine(), {.machine = {.loop_back_delay = 0.05}});
  Hand hand(*controller);
  Outputs outputs{};
  outputs.ports.set(*port_bit(5)).set(*port_bit(207));
  controller->set_outputs(outputs);
  hand.status();
  hand.wait(0.0499);
  CHECK(hand.status().inputs.ports.none());
  hand.wait(0.0001);
  CHECK(hand.status().inputs.ports == outputs.ports);

  controller->set_outputs({});
  hand.status();
  hand.wait(0.049);
  CHECK(hand.status().inputs.ports == outputs.ports);
  controller->set_outputs(outputs);  // back on before the relay has dropped out
  hand.status();
  hand.wait(0.2);
  CHECK(hand.status().inputs.ports == outputs.ports);
  CHECK(port_bit(5) == 4U);
}

TEST_CASE("Without loop-back wires an output drives no input", "[hal]") {
  const auto controller = make_virtual_controller(small_machine());
  Hand hand(*controller);
  controller->set_outputs(one_of_everything());
  hand.status();
  hand.wait(0.3);
  CHECK(hand.status().inputs.ports.none());
}

TEST_CASE("A heater warms up on its PWM output and reads back on its analog input",
          "[hal][SPN-4]") {
  // 40 W * 50 % against 0.2 W/K: 100 K above 20 deg C, with the time constant 20 / 0.2 = 100 s.
  const HeaterOptions bed{.pwm = 2,
                          .analog = 4,
                          .power = 40,
                          .capacity = 20,
                          .loss = 0.2,
                          .ambient = 20,
                          .sensor_range = 400};
  const auto controller = make_virtual_controller(
      small_machine(), {.machine = {.heaters = {bed}}, .driver = {.host_timeout = 0}});
  Hand hand(*controller);
  CHECK(hand.status().inputs.analog[4] == Approx(20.0 / 400).epsilon(1e-3));
  Outputs outputs{};
  outputs.pwm[2] = 0.5;
  controller->set_outputs(outputs);
  hand.status();
  hand.wait(100.0);
  CHECK(controller->machine().temperature(0) == Approx(20 + 100 * (1 - std::exp(-1.0))));
  CHECK(hand.status().inputs.analog[4] ==
        Approx(controller->machine().temperature(0) / 400).epsilon(1e-3));
  hand.wait(1000.0);
  CHECK(controller->machine().temperature(0) == Approx(120.0).epsilon(1e-3));
  controller->set_outputs({});
  hand.status();
  hand.wait(1000.0);
  CHECK(controller->machine().temperature(0) == Approx(20.0).epsilon(1e-3));
}
