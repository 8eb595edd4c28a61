#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/atomic_file.h"
#include "server/cncsim/options.h"
#include "server/cncsim/trajectory.h"
#include "server/link/link_trace.h"
#include "server/simulation/simulation.h"
#include "server/simulation/virtual_bench.h"

namespace cnc::server {
namespace {

/// Virtual time between two cycles: long, because nothing here asks for a quick answer.
constexpr double kCycle = 0.02;

/// Prompts are answered "go on", questions "OK" with the values that they propose.
void run_job(Simulation& simulation) {
  Machine& machine = simulation.machine();
  for (;;) {
    simulation.cycle();
    switch (machine.state()) {
      case State::tool_change:
      case State::program_stop:
        static_cast<void>(machine.resume());
        break;
      case State::question:
        simulation.cycle();  // publishes the question
        static_cast<void>(machine.answer(machine.snapshots().newest()->question->number, true, {}));
        break;
      case State::running:
      case State::homing:  // by the job
        break;
      default:
        return;
    }
  }
}

struct Report {
  TrajectorySummary trajectory;
  AxisArray<std::uint64_t> lost_steps{};
  bool good = false;
  std::uint64_t lines = 0;
  double simulated_time = 0.0;
  std::vector<LogMessage> messages;
};

nlohmann::json per_axis(const Position& values) {
  nlohmann::json out;
  for (const Axis axis : kAllAxes) out[std::string(axis_name(axis))] = values[axis];
  return out;
}

void print_json(const RunOptions& options, const Report& report) {
  nlohmann::json lost;
  for (const Axis axis : kAllAxes) lost[std::string(axis_name(axis))] = report.lost_steps[axis];
  nlohmann::json errors = nlohmann::json::array();
  nlohmann::json messages = nlohmann::json::array();
  for (const LogMessage& message : report.messages) {
    if (!message.error) {
      messages.push_back(message.text);
      continue;
    }
    nlohmann::json row{{"code", static_cast<unsigned>(message.error->code)},
                       {"name", error_info(message.error->code).name},
                       {"message", message.error->message}};
    if (message.error->place) {
      row["file"] = message.error->place->file;
      row["line"] = message.error->place->line;
      row["column"] = message.error->place->column;
    }
    errors.push_back(row);
  }
  const nlohmann::json out{{"file", options.file.string()},
                           {"good", report.good},
                           {"lines", report.lines},
                           {"job_time", report.trajectory.time},
                           {"simulated_time", report.simulated_time},
                           {"distance", report.trajectory.distance},
                           {"min", per_axis(report.trajectory.min)},
                           {"max", per_axis(report.trajectory.max)},
                           {"max_velocity", per_axis(report.trajectory.max_velocity)},
                           {"max_acceleration", per_axis(report.trajectory.max_acceleration)},
                           {"lost_steps", lost},
                           {"errors", errors},
                           {"messages", messages}};
  // A file in another encoding must not end the report.
  fmt::print("{}\n", out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void print_text(const config::MachineConfig& config, const Report& report) {
  for (const LogMessage& message : report.messages)
    fmt::print("{}{}\n", message.error ? "error: " : "", message.text);
  const TrajectorySummary& path = report.trajectory;
  fmt::print("{} after {} lines\njob time  {:.3f} s\ndistance  {:.3f} mm\n\n",
             report.good ? "done" : "STOPPED", report.lines, path.time, path.distance);
  fmt::print(
      "axis         from           to   max velocity  of limit   max accel.  of limit  lost "
      "steps\n");
  for (const Axis axis : kAllAxes) {
    const config::AxisConfig& limits = config.axes[axis];
    if (!limits.connected()) continue;
    fmt::print("{:4} {:12.4f} {:12.4f} {:14.3f} {:9.4f} {:12.2f} {:9.4f} {:11}\n", axis_name(axis),
               path.min[axis], path.max[axis], path.max_velocity[axis],
               path.max_velocity[axis] / limits.velocity, path.max_acceleration[axis],
               path.max_acceleration[axis] / limits.acceleration, report.lost_steps[axis]);
  }
}

Result<void> write_trace(const std::filesystem::path& path, const hal::trace::Ring& ring,
                         const config::MachineConfig& config) {
  hal::trace::About about = about_machine(config, "virtual board of cncsim");
  about.reason = "asked_for";
  about.written = utc_text(std::chrono::system_clock::now());
  return config::write_file_atomically(path, hal::trace::trace_bytes(about, ring.copy()));
}

/// What the machine was told, without what a cut has taken back (homing, at its switch): that is
/// dropped before statistics and recording see it.
class Commanded {
 public:
  explicit Commanded(TrajectoryRecorder* recorder) : recorder_(recorder) {}

  void add(const motion::Setpoint& setpoint) {
    last_.push_back(setpoint);
    if (last_.size() > kMostTakenBack) give_first();
  }
  void cut(std::size_t count) { last_.resize(last_.size() - std::min(count, last_.size())); }
  void restart(const Position& position) {
    while (!last_.empty()) give_first();
    statistics_.restart(position);
    if (recorder_ != nullptr) recorder_->restart(position);
  }
  /// At the end.
  [[nodiscard]] const TrajectorySummary& summary() {
    while (!last_.empty()) give_first();
    return statistics_.summary();
  }

 private:
  static constexpr std::size_t kMostTakenBack = 8192;  // more than link and board hold together

  void give_first() {
    statistics_.add(last_.front());
    if (recorder_ != nullptr) recorder_->add(last_.front());
    last_.pop_front();
  }

  TrajectoryRecorder* recorder_;
  TrajectoryStatistics statistics_{Position{}};
  std::deque<motion::Setpoint> last_;
};

}  // namespace

ExitCode run_command(const RunOptions& options) {
  auto data = load_machine(options);
  if (!data) return refuse(data.error());
  auto program = interp::Program::open(options.file);
  if (!program) return refuse(program.error());
  // The simulated machine stands at machine zero and knows it.
  data->config.safety.homing_mandatory = false;
  data->analyse_jobs = false;  // the run itself is the prediction
  const config::MachineConfig config = data->config;

  std::optional<TrajectoryRecorder> recorder;
  if (!options.record.empty()) {
    auto created = TrajectoryRecorder::create(options.record, Position{});
    if (!created) return refuse(created.error());
    recorder.emplace(std::move(*created));
  }

  auto scenario = scenario_of(options.scenario, data->config);
  if (!scenario) return refuse(scenario.error());
  if (!scenario->machine.start) scenario->machine.start = Position{};
  std::optional<hal::trace::Ring> trace;
  if (!options.trace.empty()) trace.emplace();
  Simulation simulation(std::move(*data), {.machine = std::move(scenario->machine),
                                           .link = scenario->link,
                                           .events = std::move(scenario->events),
                                           .period = kCycle,
                                           .trace = trace ? &*trace : nullptr});
  Machine& machine = simulation.machine();
  Commanded commanded(recorder ? &*recorder : nullptr);
  machine.set_setpoint_listener([&](const motion::Setpoint& setpoint) { commanded.add(setpoint); });
  machine.set_cut_listener([&](std::size_t count) { commanded.cut(count); });
  machine.set_restart_listener([&](const Position& position) { commanded.restart(position); });

  simulation.cycle_until(State::needs_reset);
  machine.reset([](const Result<void>&) {});
  simulation.cycle_until(State::ready);
  const double begin = simulation.time();
  static_cast<void>(machine.load(*program, options.file));
  static_cast<void>(machine.run());
  run_job(simulation);

  Report report;
  report.trajectory = commanded.summary();
  report.simulated_time = simulation.time() - begin;
  report.lines = (*program)->line_count();
  report.messages = simulation.log().after(0);
  const auto snapshot = machine.snapshots().newest();
  report.good = snapshot->job.ended_well;
  for (const Axis axis : kAllAxes)
    report.lost_steps[axis] = simulation.virtual_machine().lost_steps(axis);

  if (recorder)
    if (auto finished = recorder->finish(); !finished) return refuse(finished.error());
  if (trace)
    if (auto written = write_trace(options.trace, *trace, config); !written)
      return refuse(written.error());
  if (options.json)
    print_json(options, report);
  else
    print_text(config, report);
  return report.good ? kGood : kProgramFailed;
}

}  // namespace cnc::server
