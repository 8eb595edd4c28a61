// The virtual spindle and what the board measures of it.
#include "hal/cpu5/firmware/spindle_meter.h"
#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;
using cpu5::firmware::kTicksPerSecond;
using cpu5::firmware::SpindleMeter;
using cpu5::firmware::Ticks;

namespace {

constexpr double kFullSpeed = 24'000.0;  // config::SpindleConfig's default

Outputs turning(double speed) {
  return {.tool_direction = true, .spindle_pwm = speed / kFullSpeed};
}

std::unique_ptr<VirtualController> spindle_machine() {
  return make_virtual_controller(small_machine(), {.driver = {.host_timeout = 0}});
}

}  // namespace

TEST_CASE("The spindle's speed is measured within 1 rpm, moving axes or not", "[hal][SPN-1]") {
  const double speed = GENERATE(60.0, 1'000.0, 7'777.0, 24'000.0);
  const double cycle = GENERATE(0.0017, 0.005, 0.1);
  const auto controller = spindle_machine();
  Hand hand(*controller);
  controller->set_outputs(turning(speed));
  for (double time = 0.0; time < 4.0; time += cycle) hand.wait(cycle);
  CHECK(controller->machine().spindle_speed() == Approx(speed).margin(0.5));
  CHECK(std::abs(hand.status().spindle_speed - speed) < 1.0);
}

TEST_CASE("The index counts revolutions in either direction", "[hal][LNK-6]") {
  const bool clockwise = GENERATE(true, false);
  const auto controller = spindle_machine();
  Hand hand(*controller);
  controller->set_outputs({.tool_direction = clockwise, .spindle_pwm = 6'000 / kFullSpeed});
  hand.status();
  hand.wait(2.0);  // twenty time constants
  const std::uint32_t before = hand.status().index_latch.count;
  hand.wait(10.0);
  CHECK(std::abs(static_cast<int>(hand.status().index_latch.count - before) - 1000) <= 1);
  CHECK(controller->machine().spindle_speed() == Approx(clockwise ? 6'000 : -6'000));
}

TEST_CASE("The spindle follows its PWM with inertia", "[hal][SPN-1]") {
  const auto controller = spindle_machine();
  Hand hand(*controller);
  controller->set_outputs(turning(10'000));
  hand.status();
  hand.wait(0.1);  // one time constant
  CHECK(controller->machine().spindle_speed() ==
        Approx(10'000 * (1 - std::exp(-1.0))).epsilon(0.002));
  hand.wait(1.0);
  CHECK(controller->machine().spindle_speed() == Approx(10'000).epsilon(1e-4));
  controller->set_outputs({});
  hand.status();
  hand.wait(3.0);
  CHECK(controller->machine().spindle_speed() == 0.0);
}

TEST_CASE("A spindle that stops is measured as ever slower, then as standing", "[hal][SPN-1]") {
  SpindleMeter meter;
  constexpr Ticks kPeriod = kTicksPerSecond / 100;  // 6000 rpm
  std::uint32_t count = 0;
  for (; count <= 100; ++count) meter.see(count, count * kPeriod);
  const Ticks last = 100 * kPeriod;
  CHECK(meter.period(last) == kPeriod);
  CHECK(meter.period(last + kPeriod) == kPeriod);
  CHECK(meter.period(last + 5 * kPeriod) == 5 * kPeriod);
  CHECK(meter.period(last + SpindleMeter::kStandstill + 1) == 0);
  // The first pulse after a standstill is no revolution.
  const Ticks again = last + 100 * kTicksPerSecond;
  meter.see(count, again);
  CHECK(meter.period(again) == 0);
  meter.see(count + 1, again + 2 * kPeriod);
  CHECK(meter.period(again + 2 * kPeriod) == 2 * kPeriod);
}

TEST_CASE("Measured speed does not depend on how often the pulses are looked at", "[hal][SPN-1]") {
  // 24000 rpm: a pulse each 2.5 ms, seen 1 or 7 at a time.
  constexpr Ticks kPeriod = kTicksPerSecond / 400;
  const std::uint32_t at_a_time = GENERATE(1U, 7U);
  SpindleMeter meter;
  for (std::uint32_t count = 1; count < 200; count += at_a_time) {
    meter.see(count, count * kPeriod);
    if (count > 20) CHECK(meter.period(count * kPeriod) == kPeriod);
  }
}

TEST_CASE("The sync input is active for a tenth of each revolution", "[hal][SPN-1]") {
  const auto controller = spindle_machine();
  Hand hand(*controller);
  controller->set_outputs(turning(600));  // 0.1 s per revolution
  hand.status();
  hand.wait(3.0);
  int active = 0;
  for (int i = 0; i < 1000; ++i) {
    hand.wait(0.001);
    active += hand.status().inputs.sync ? 1 : 0;
  }
  CHECK(std::abs(active - 100) <= 10);
}
