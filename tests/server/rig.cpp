#include "tests/server/rig.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "config/ini_file.h"
#include "server/daemon/shipped_files.h"

namespace cnc::server::test {

MachineData shipped_machine(const std::vector<std::string>& settings) {
  std::vector<std::string> all{"SAFETY.drivesHoldPosition=1"};
  all.insert(all.end(), settings.begin(), settings.end());
  auto config = config::parse_machine_config(shipped_cnc_ini(), "cnc.ini", all);
  if (!config) throw std::runtime_error(config.error().front().to_string());
  MachineData data;
  data.config = std::move(*config);
  data.tools = config::ToolTable::parse(shipped_tools(), "tools.txt").value();
  data.analyse_jobs = false;
  return data;
}

MachineData free_machine(std::vector<std::string> settings) {
  settings.emplace_back("SAFETY.homingMandatory=0");
  return shipped_machine(settings);
}

SimulationOptions at_zero() { return {.machine = {.start = Position{}}}; }

Rig::Rig(MachineData data, const SimulationOptions& options)
    : simulation(std::move(data), options), machine(simulation.machine()) {
  REQUIRE(becomes(State::needs_reset, 1.0));
}

void Rig::run_for(double seconds) {
  for (const double end = simulation.time() + seconds; simulation.time() < end;) simulation.cycle();
}

bool Rig::becomes(const std::function<bool()>& condition, double seconds) {
  for (const double end = simulation.time() + seconds; simulation.time() < end;) {
    if (condition()) return true;
    simulation.cycle();
  }
  return condition();
}

bool Rig::becomes_with_disk(const std::function<bool()>& condition, double seconds) {
  if (becomes(condition, seconds)) return true;
  constexpr int kLongest = 20'000;  // ms
  for (int waited = 0; waited < kLongest && !condition(); ++waited) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    simulation.cycle();
  }
  return condition();
}

bool Rig::becomes(State state, double seconds) {
  return becomes([this, state] { return machine.state() == state; }, seconds);
}

Result<void> Rig::complete(const std::function<void(Completion)>& command, double seconds) {
  auto answer = std::make_shared<std::optional<Result<void>>>();
  command([answer](Result<void> result) { *answer = std::move(result); });
  if (!becomes_with_disk([&] { return answer->has_value(); }, seconds))
    throw std::runtime_error("the command did not answer in time");
  // What the command has brought about is published by the cycle that is under way.
  simulation.cycle();
  return **answer;
}

Result<void> Rig::reset() {
  return complete([this](Completion done) { machine.reset(std::move(done)); });
}
Result<void> Rig::home(std::vector<Axis> axes) {
  return complete([&](Completion done) { machine.home(std::move(axes), std::move(done)); });
}
Result<void> Rig::mdi(const std::string& line) {
  return complete([&](Completion done) { machine.mdi(line, std::move(done)); });
}
Result<void> Rig::pause() {
  return complete([this](Completion done) { machine.pause(std::move(done)); });
}
Result<void> Rig::stop() {
  return complete([this](Completion done) { machine.stop(std::move(done)); });
}

Result<void> Rig::load(const std::string& text) {
  auto program = interp::Program::from_text(text, "test.nc");
  if (!program) return std::unexpected(program.error());
  return machine.load(std::move(*program), "test.nc");
}

void Rig::start(const std::string& text) {
  REQUIRE(load(text));
  REQUIRE(machine.run());
}

Error Rig::last_error() const {
  const auto messages = simulation.log().after(0);
  for (auto message = messages.rbegin(); message != messages.rend(); ++message)
    if (message->error) return *message->error;
  throw std::runtime_error("no error was reported");
}

ReadyRig::ReadyRig(MachineData data, const SimulationOptions& options)
    : Rig(std::move(data), options) {
  REQUIRE(reset());
  REQUIRE(state() == State::ready);
}

namespace {

std::vector<std::string> by_hand(std::vector<std::string> settings) {
  for (const char* axis : {"X", "Y", "Z"})
    settings.push_back("AXIS_" + std::string(axis) + ".homeVelocity=0");
  return settings;
}

}  // namespace

HomedRig::HomedRig(std::vector<std::string> settings)
    : ReadyRig(free_machine(by_hand(std::move(settings)))) {
  REQUIRE(home());
}

}  // namespace cnc::server::test
