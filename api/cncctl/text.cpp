#include "api/cncctl/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "api/cncctl/question.h"

namespace cnc::ctl {
namespace {

constexpr double kSecondsPerMinute = 60.0;

template <typename Cell>
std::string row(std::string_view title, const std::vector<api::Axis>& axes, Cell cell) {
  std::string line = fmt::format("{:<9}", title);
  for (const api::Axis axis : axes) line += fmt::format("{:>12}", cell(axis));
  return line + '\n';
}

std::string decimals(double value) { return fmt::format("{:.4f}", value); }

std::string format_spindle(const api::MachineStatus& status) {
  if (status.spindle == api::SpindleDirection::off) return "off";
  return fmt::format("{} {:.0f} rpm", name_of(status.spindle), status.spindle_speed);
}

std::string format_job(const api::JobStatus& job) {
  if (job.path.empty()) return "none";
  std::string text = fmt::format("{}, line {} of {}, {:.0f} %, {}", job.path, job.line, job.lines,
                                 100.0 * job.progress, format_duration(job.elapsed));
  if (job.prediction_ready) {
    text += fmt::format(", {} left of {}", format_duration(job.time_left),
                        format_duration(job.predicted_time));
  }
  if (job.problems > 0) text += fmt::format(", {} problems", job.problems);
  return text;
}

}  // namespace

std::string format_duration(double seconds) {
  const auto whole = static_cast<long>(std::lround(std::max(seconds, 0.0)));
  const long hours = whole / 3600;
  const long minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

std::vector<api::Axis> axes_of(const api::Machine& machine) {
  std::vector<api::Axis> axes;
  for (const api::AxisDescription& each : machine.axes) axes.push_back(each.axis);
  return axes;
}

std::string format_position(const api::AxisValues& position, const std::vector<api::Axis>& axes) {
  std::string text;
  for (const api::Axis axis : axes) {
    text += fmt::format("{}{}{:.3f}", text.empty() ? "" : " ", name_of(axis), position[axis]);
  }
  return text;
}

std::string format_status(const api::MachineStatus& status, const std::vector<api::Axis>& axes) {
  std::string text =
      fmt::format("{:<9}{} - {}\n", "state", name_of(status.state), status.state_text);
  text += row("", axes, [](api::Axis axis) { return name_of(axis); });
  text += row("work", axes, [&](api::Axis axis) { return decimals(status.work_position[axis]); });
  text +=
      row("machine", axes, [&](api::Axis axis) { return decimals(status.machine_position[axis]); });
  text += row("position", axes, [&](api::Axis axis) { return name_of(status.trust[axis]); });
  text += fmt::format("{:<9}{:.1f} mm/min\n", "feed", status.feed * kSecondsPerMinute);
  text += fmt::format(
      "{:<9}{}\n", "override",
      format_overrides({status.feed_override, status.rapid_override, status.speed_override}));
  text += fmt::format("{:<9}{}\n", "spindle", format_spindle(status));
  text += fmt::format("{:<9}{}\n", "tool", status.tool);
  text += fmt::format("{:<9}{}\n", "probe", status.probe_input ? "touches" : "free");
  text += fmt::format("{:<9}{}\n", "codes", status.active_codes);
  text += fmt::format("{:<9}{}\n", "job", format_job(status.job));
  if (status.question) {
    text += fmt::format("{:<9}{}", "question", format_question(*status.question, 9));
    text += fmt::format("{:<9}{}\n", "answer", how_to_answer(*status.question));
  }
  return text;
}

std::string format_status_line(const api::MachineStatus& status,
                               const std::vector<api::Axis>& axes) {
  return fmt::format("{} {} F{:.0f}", name_of(status.state),
                     format_position(status.work_position, axes), status.feed * kSecondsPerMinute);
}

std::string format_overrides(const api::Overrides& overrides) {
  return fmt::format("feed {:.0f} %, rapid {:.0f} %, speed {:.0f} %", 100.0 * overrides.feed,
                     100.0 * overrides.rapid, 100.0 * overrides.speed);
}

std::string format_problem(const api::Problem& problem) {
  std::string text =
      fmt::format("{}{}\n", problem.warning ? "warning: " : "", problem.error.to_string());
  if (!problem.line_text.empty()) text += fmt::format("    {}\n", problem.line_text);
  for (const api::CallSite& call : problem.calls)
    text +=
        fmt::format("    in sub {}, called at {}:{}\n", call.sub, call.place.file, call.place.line);
  return text;
}

std::string format_message(const api::Message& message) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(message.time);
  const std::tm local = fmt::localtime(std::chrono::system_clock::to_time_t(seconds));
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03} {:<7} {}\n", local,
                     (message.time - seconds).count(), name_of(message.severity), message.text);
}

}  // namespace cnc::ctl
