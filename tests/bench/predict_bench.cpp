// How fast the time of a job is predicted, from the text of the program on: predict() as the daemon
// calls it, interpreter and both stages.
//
//   predict_bench [OPTION=VALUE ...] FILE ...
//
//   v=100 a=500     limits of every axis, mm/s and mm/s²
//   j=0             limit of jerk, mm/s³; 0: none
//   times=5         repetitions; the median is shown
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fmt/core.h>
#include <string>
#include <string_view>
#include <vector>

#include "config/ini_file.h"
#include "server/daemon/shipped_files.h"
#include "server/job/prediction.h"
#include "tests/bench/bench_options.h"

namespace {

using namespace cnc;

using bench::Options;

config::MachineConfig machine_of(const Options& options) {
  config::MachineConfig config =
      config::parse_machine_config(server::shipped_cnc_ini(), "cnc.ini", {}).value();
  for (const Axis axis : kLinearAxes) {
    config::AxisConfig& limits = config.axes[axis];
    limits.velocity = options["v"];
    limits.acceleration = options["a"];
    limits.jerk = options["j"];
    limits.positive_limit = 1e6;
    limits.negative_limit = -1e6;
  }
  return config;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void measure(const std::string& path, const Options& options) {
  const auto program = interp::Program::open(path);
  if (!program) {
    fmt::print("{}\n", program.error().to_string());
    return;
  }
  const server::PredictionInput input{machine_of(options), *program, {}, {}, Position{}};
  std::vector<double> wall;
  std::vector<double> processor;
  double time = 0.0;
  for (double i = 0.0; i < options["times"]; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t processor_begin = std::clock();
    const auto prediction = server::predict(input, {});
    processor.push_back(static_cast<double>(std::clock() - processor_begin) / CLOCKS_PER_SEC);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (prediction->error) fmt::print("{}\n", prediction->error->to_string());
    time = prediction->time();
  }
  const auto lines = static_cast<double>((*program)->line_count());
  fmt::print(
      "{}: {} lines, job {:.3f} s, predicted in {:.4f} s ({:.4f} s of the processor), "
      "{:.0f} lines/s\n",
      path, lines, time, median(wall), median(processor), lines / median(wall));
}

}  // namespace

int main(int count, char** values) {
  const Options options({{"v", 100.0}, {"a", 500.0}, {"j", 0.0}, {"times", 5.0}}, count, values);
  for (const std::string& file : options.files()) measure(file, options);
}
