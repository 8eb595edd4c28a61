// Any bytes as a scenario file: no crash, an error that is bounded and has its place, and whatever
// is accepted builds a machine that lives through its events.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hal/sim/scenario.h"
#include "hal/sim/scenario_player.h"
#include "hal/sim/virtual_machine.h"

namespace {

using namespace cnc;
using namespace cnc::hal::sim;

void require(bool condition) {
  if (!condition) std::abort();
}

config::MachineConfig two_axes() {
  config::MachineConfig config;
  for (const Axis axis : {Axis::X, Axis::Z}) {
    config.axes[axis].port = 1;
    config.axes[axis].negative_limit = -100.0;
    config.axes[axis].positive_limit = 100.0;
    config.axes[axis].home_velocity = 10.0;
  }
  return config;
}

void live_through(const Scenario& scenario) {
  VirtualMachine machine(two_axes(), scenario.machine);
  LinkTrouble trouble = scenario.link;
  ScenarioPlayer player(scenario.events);
  Stage stage{machine, trouble};
  machine.set_outputs({.drives_enabled = true, .tool_direction = true, .spindle_pwm = 1000});
  for (cnc::hal::cpu5::firmware::Ticks now = 0; now < 200'000; now += 10'000) {
    machine.step(0, 1, now);
    machine.step(2, -1, now);
    const auto inputs = machine.inputs(now);
    for (const std::uint32_t analog : inputs.analog) {
      require(analog <= cnc::hal::cpu5::firmware::Inputs::kFullAnalog);
    }
    player.advance(now, stage);
    require(player.next() > now);
  }
  require(trouble.loss >= 0.0 && trouble.loss <= 1.0 && trouble.delay >= 0.0);
  for (const Axis axis : {Axis::X, Axis::Z}) {
    require(std::abs(machine.physical_position(axis)) <= 1200.0);  // stops at 100 + 1000 at most
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Result<Scenario> scenario = parse_scenario(text, "fuzz.toml");
  if (scenario) {
    live_through(*scenario);
  } else {
    require(scenario.error().place && scenario.error().place->line > 0);
    require(scenario.error().message.size() < 2000);
  }
  return 0;
}
