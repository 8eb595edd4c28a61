// How soon a feed hold acts: the time from the request to the first segment of the braking ramp,
// over random instants of a job in virtual time, and what planning anew costs the executor.
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <random>
#include <string>
#include <vector>

#include "config/ini_file.h"
#include "server/daemon/shipped_files.h"
#include "server/simulation/simulation.h"

namespace {

using namespace cnc;
using namespace cnc::server;

constexpr double kLinkPeriod = 0.002;  // s

/// A wave of chords of 0.1 mm.
std::string program() {
  std::string text = "G64 P0.01\nG1 F3000\n";
  for (int i = 1; i <= 2000; ++i)
    text += fmt::format("X{:.4f} Y{:.4f}\n", 0.1 * i, 20.0 + 15.0 * std::sin(0.02 * i));
  return text;
}

struct Sample {
  double latency;  // s
  double work;     // s of this computer
};

Sample hold_at(const std::vector<std::string>& settings, double instant, double phase) {
  MachineData data;
  data.config = config::parse_machine_config(shipped_cnc_ini(), "cnc.ini", settings).value();
  data.tools = config::ToolTable::parse(shipped_tools(), "tools.txt").value();
  data.analyse_jobs = false;
  Simulation simulation(std::move(data), {.machine = {.start = Position{}}, .period = kLinkPeriod});
  Machine& machine = simulation.machine();
  std::vector<double> durations;
  double begin = 0.0;
  machine.set_setpoint_listener([&](const motion::Setpoint& setpoint) {
    if (durations.empty()) begin = simulation.time();
    durations.push_back(setpoint.duration);
  });
  double replaced_from = 0.0;
  machine.set_cut_listener([&](std::size_t count) {
    durations.resize(durations.size() - count);
    replaced_from = begin;
    for (const double duration : durations) replaced_from += duration;
  });
  simulation.cycle_until(State::needs_reset);
  machine.reset([](const Result<void>&) {});
  simulation.cycle_until(State::ready);
  static_cast<void>(machine.load(interp::Program::from_text(program(), "wave").value(), "wave"));
  static_cast<void>(machine.run());
  while (durations.empty() || simulation.time() < begin + instant) simulation.cycle();

  const auto start = std::chrono::steady_clock::now();
  machine.pause([](const Result<void>&) {});
  const std::chrono::duration<double> work = std::chrono::steady_clock::now() - start;
  // The request came between the last exchange of the link and the next.
  return {replaced_from - (simulation.time() - kLinkPeriod * phase), work.count()};
}

double percentile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void print_row(const char* name, const std::vector<double>& values) {
  fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} |\n", name, 1e3 * percentile(values, 0.5),
             1e3 * percentile(values, 0.99), 1e3 * percentile(values, 1.0));
}

}  // namespace

int main() {
  constexpr int kCount = 300;
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> instant(0.3, 3.0);
  std::uniform_real_distribution<double> phase(0.0, 1.0);
  fmt::print("| ms | median | 99 % | longest |\n|---|---:|---:|---:|\n");
  for (const char* fifo : {"0.25", "2"}) {
    std::vector<double> latencies;
    std::vector<double> work;
    for (int i = 0; i < kCount; ++i) {
      const std::vector<std::string> settings{"SAFETY.homingMandatory=0",
                                              fmt::format("TRAJECTORY.fifoTime={}", fifo)};
      const Sample sample = hold_at(settings, instant(engine), phase(engine));
      latencies.push_back(sample.latency);
      work.push_back(sample.work);
    }
    print_row(fmt::format("FifoTime {} s: request to ramp", fifo).c_str(), latencies);
    print_row(fmt::format("FifoTime {} s: work of the executor", fifo).c_str(), work);
  }
}
