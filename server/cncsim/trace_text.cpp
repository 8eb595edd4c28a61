#include "server/cncsim/trace_text.h"

#include <algorithm>
#include <fmt/format.h>

#include "config/atomic_file.h"
#include "hal/fault_names.h"
#include "hal/trace/field_walkers.h"
#include "server/job/overloaded.h"
#include "server/machine/state_table.h"

namespace cnc::server {
namespace {

using namespace hal::trace;

std::string_view state_text(std::uint32_t state) {
  return state < kStateCount ? state_info(static_cast<State>(state)).name : "unknown";
}

std::size_t segment_count(const Step& step) {
  return static_cast<std::size_t>(std::ranges::count_if(step.requests, [](const Request& request) {
    return std::holds_alternative<hal::Segment>(request);
  }));
}

std::string request_text(const Request& request) {
  return std::visit(
      Overloaded{
          [](const hal::Segment&) { return std::string(); },
          [](const CutBehind& cut) { return fmt::format("cut behind {}", cut.id); },
          [](const SetOutputs&) { return std::string("outputs"); },
          [](const ChangeOutputs&) { return std::string("output change"); },
          [](const QuickStop&) { return std::string("quick stop"); },
          [](const StopAlongPath&) { return std::string("stop along path"); },
          [](const ReleaseStop&) { return std::string("release stop"); },
          [](const ClearFaults&) { return std::string("clear faults"); },
          [](const SetPosition& set) {
            return fmt::format("{} is at {:.4f}", axis_name(set.axis), set.position);
          },
          [](const ArmHomeLatch& arm) { return fmt::format("arm home {}", axis_name(arm.axis)); },
          [](const DisarmHomeLatch& latch) {
            return fmt::format("disarm home {}", axis_name(latch.axis));
          },
          [](const ArmProbeLatch&) { return std::string("arm probe"); },
          [](const DisarmProbeLatch&) { return std::string("disarm probe"); },
      },
      request);
}

/// "cut behind 12, 3 segments to 45, outputs"
std::string requests_text(const Step& step) {
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  };
  for (const Request& request : step.requests) {
    if (!std::holds_alternative<hal::Segment>(request)) add(request_text(request));
  }
  if (const std::size_t count = segment_count(step); count > 0) {
    const auto last = std::find_if(step.requests.rbegin(), step.requests.rend(), [](const auto& r) {
      return std::holds_alternative<hal::Segment>(r);
    });
    add(fmt::format("{} segments to {}", count, std::get<hal::Segment>(*last).id));
  }
  return text;
}

std::string position_text(const Position& position) {
  std::string text;
  for (const Axis axis : kAllAxes)
    text += fmt::format("{}{} {:.4f}", text.empty() ? "" : "  ", axis_name(axis), position[axis]);
  return text;
}

std::string line(std::string_view title, std::string_view text) {
  return fmt::format("{:<11}{}\n", title, text);
}

/// When the faults, or the connection, changed.
std::string history_text(const Trace& trace) {
  std::string text;
  const hal::ControllerStatus* before = nullptr;
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    const hal::ControllerStatus& status = trace.steps[i].exchange.status;
    std::string what;
    if (before == nullptr ? status.faults != 0 : status.faults != before->faults)
      what = "faults: " + hal::fault_names(status.faults);
    if (before != nullptr && status.sessions != before->sessions)
      what = status.counts_lost ? "connected again; the board was reset" : "connected again";
    if (before != nullptr && before->connected && !status.connected) what = "connection lost";
    if (!what.empty()) text += fmt::format("{:>9.4f} s  {}\n", seconds_to_end(trace, i), what);
    before = &status;
  }
  return text.empty() ? "           no fault\n" : text;
}

std::string end_text(const Trace& trace) {
  const Exchange& last = trace.steps.back().exchange;
  const hal::ControllerStatus& status = last.status;
  std::string text =
      line("machine", fmt::format("{}, line {}", state_text(last.machine_state), last.line));
  text += line("segment", fmt::format("{} at {:.0f} %, {}", status.executing_id,
                                      100.0 * status.executing_phase,
                                      status.moving ? "moving" : "standing still"));
  text += line("FIFO", fmt::format("{} segments, {:.4f} s", status.fifo_count, status.fifo_time));
  text += line("position", position_text(status.position));
  return text;
}

}  // namespace

double seconds_to_end(const Trace& trace, std::size_t step) {
  return trace.steps[step].exchange.now - trace.steps.back().exchange.now;
}

std::string summary_text(const Trace& trace) {
  const hal::ControllerStatus& status = trace.steps.back().exchange.status;
  const std::string name(status.board.name.begin(), std::ranges::find(status.board.name, '\0'));
  std::size_t segments = 0;
  for (const Step& step : trace.steps) segments += segment_count(step);
  std::string text =
      line("written", fmt::format("{} by version {}, reason: {}", trace.about.written,
                                  trace.about.server, trace.about.reason));
  text += line("board", fmt::format("{}: {}, serial number {}", trace.about.board, name,
                                    status.board.serial));
  text += line("recorded", fmt::format("{} exchanges over {:.3f} s, {} segments",
                                       trace.steps.size(), -seconds_to_end(trace, 0), segments));
  text += "\nwhat happened, seconds before the end of the trace\n" + history_text(trace);
  text += "\nat the end\n" + end_text(trace);
  return text;
}

std::string exchanges_text(const Trace& trace, double seconds) {
  std::string text =
      fmt::format("\n{:>9} {:<14}{:>7}{:>9}{:>6}{:>9}{:>11}{:>11}{:>11}  {}\n", "time s", "machine",
                  "line", "segment", "%", "FIFO s", "X", "Y", "Z", "faults; requests");
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    if (seconds_to_end(trace, i) < -seconds) continue;
    const Exchange& exchange = trace.steps[i].exchange;
    const hal::ControllerStatus& status = exchange.status;
    std::string note = status.connected ? "" : "no link";
    if (status.faults != 0) note = hal::fault_names(status.faults);
    if (const std::string requests = requests_text(trace.steps[i]); !requests.empty())
      note += "; " + requests;
    text += fmt::format("{:>9.4f} {:<14}{:>7}{:>9}{:>6.1f}{:>9.4f}{:>11.4f}{:>11.4f}{:>11.4f}  {}",
                        seconds_to_end(trace, i), state_text(exchange.machine_state), exchange.line,
                        status.executing_id, 100.0 * status.executing_phase, status.fifo_time,
                        status.position[Axis::X], status.position[Axis::Y],
                        status.position[Axis::Z], note);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

std::string verdict_text(const Trace& trace, const ReplayReport& report) {
  std::string text = fmt::format(
      "\nreplay     from {:.4f} s on, {}; {} statuses compared, {} that follow the spindle were "
      "not; largest deviation {:.4f}\n",
      seconds_to_end(trace, report.begin), report.in_motion ? "in motion" : "at rest",
      report.compared, report.following_spindle, report.largest_deviation);
  if (!report.difference) return text + "REPRODUCED: the virtual board does what was recorded.\n";
  return text + fmt::format("DIFFERS from exchange {} on ({:.4f} s): {}.\n",
                            report.difference->step, seconds_to_end(trace, report.difference->step),
                            report.difference->what);
}

Result<void> write_trace_csv(const Trace& trace, const std::filesystem::path& path) {
  std::string text = "segments_sent";
  FieldText head([&](const std::string& name, const auto&) { text += "," + name; });
  visit_fields(head, trace.steps.front().exchange);
  text += '\n';
  for (const Step& step : trace.steps) {
    text += fmt::format("{}", segment_count(step));
    FieldText row([&](const std::string&, const auto& value) {
      using T = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool> || std::is_same_v<T, char>) {
        text += fmt::format(",{}", static_cast<int>(value));
      } else if constexpr (kIsBits<T>) {
        text += fmt::format(",{}", value.to_ullong());
      } else {
        text += fmt::format(",{}", value);
      }
    });
    visit_fields(row, step.exchange);
    text += '\n';
  }
  return config::write_file_atomically(path, text);
}

}  // namespace cnc::server
