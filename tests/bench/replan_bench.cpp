// How soon a feed hold acts: the time from the request to the first segment of the braking ramp,
// over random instants of a job in virtual time, and what planning anew costs the executor.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <random>
#include <spdlog/spdlog.h>
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
std::string wave() {
  std::string text = "G64 P0.01\nG1 F3000\n";
  for (int i = 1; i <= 2000; ++i)
    text += fmt::format("X{:.4f} Y{:.4f}\n", 0.1 * i, 20.0 + 15.0 * std::sin(0.02 * i));
  return text;
}

/// Detail of 0.2 mm at random heights, which limits of jerk let be driven at 5 to 10 mm/s.
std::string relief() {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> height(-0.15, 0.15);
  std::string text = "G64 P0.005\nG1 F6000\n";
  for (int i = 1; i <= 1000; ++i)
    text += fmt::format("X{:.4f} Y{:.4f}\n", 0.2 * i, 20.0 + height(engine));
  return text;
}

struct Sample {
  double latency;  // s
  double work;     // s of the processor
};

/// Setpoints of InterpolationTime: the coarsest grid that a hold can meet.
constexpr const char* kLine = "G1 X200 Y100 F3000\n";

Sample hold_at(const std::vector<std::string>& settings, const std::string& program, double instant,
               double phase) {
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
  static_cast<void>(machine.load(interp::Program::from_text(program, "job").value(), "job"));
  static_cast<void>(machine.run());
  while (durations.empty() || simulation.time() < begin + instant) simulation.cycle();

  const std::clock_t start = std::clock();
  machine.pause([](const Result<void>&) {});
  const double work = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  // The request came between the last exchange of the link and the next.
  return {replaced_from - (simulation.time() - kLinkPeriod * phase), work};
}

double percentile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void print_row(const std::string& name, const std::vector<double>& values) {
  fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} |\n", name, 1e3 * percentile(values, 0.5),
             1e3 * percentile(values, 0.99), 1e3 * percentile(values, 1.0));
}

/// 0: no limit of jerk.
void measure(const char* name, const char* fifo_time, const std::string& program,
             const char* jerk = "0") {
  constexpr int kCount = 300;
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> instant(0.3, 3.0);
  std::uniform_real_distribution<double> phase(0.0, 1.0);
  std::vector<std::string> settings{"SAFETY.homingMandatory=0",
                                    fmt::format("TRAJECTORY.fifoTime={}", fifo_time)};
  for (const char* axis : {"X", "Y", "Z"})
    settings.push_back(fmt::format("AXIS_{}.jerk={}", axis, jerk));
  std::vector<double> latencies;
  std::vector<double> work;
  for (int i = 0; i < kCount; ++i) {
    const Sample sample = hold_at(settings, program, instant(engine), phase(engine));
    latencies.push_back(sample.latency);
    work.push_back(sample.work);
  }
  print_row(fmt::format("{}, FifoTime {} s: request to ramp", name, fifo_time), latencies);
  print_row(fmt::format("{}, FifoTime {} s: work of the executor", name, fifo_time), work);
}

}  // namespace

int main() {
  spdlog::set_level(spdlog::level::off);
  fmt::print("| ms | median | 99 % | longest |\n|---|---:|---:|---:|\n");
  for (const char* fifo_time : {"0.25", "2"}) {
    measure("line", fifo_time, kLine);
    measure("smoothed chords", fifo_time, wave());
    measure("line, limits of jerk", fifo_time, kLine, "20000");
    measure("smoothed chords, limits of jerk", fifo_time, wave(), "20000");
    measure("relief, limits of jerk", fifo_time, relief(), "20000");
  }
}
