// cncsim replay: what a trace holds, and whether a virtual board does it again.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/fault_names.h"
#include "server/cncsim/options.h"
#include "server/cncsim/trace_text.h"

namespace cnc::server {
namespace {

nlohmann::json json_of(const hal::trace::Trace& trace,
                       const Result<hal::trace::ReplayReport>& report) {
  nlohmann::json out{{"reason", trace.about.reason},    {"written", trace.about.written},
                     {"server", trace.about.server},    {"board", trace.about.board},
                     {"exchanges", trace.steps.size()}, {"seconds", -seconds_to_end(trace, 0)}};
  if (!report) {
    out["replay"] = {{"begun", false}, {"reason", report.error().message}};
    return out;
  }
  nlohmann::json faults = nlohmann::json::array();
  for (const hal::trace::FaultChange& change : report->faults)
    faults.push_back({{"exchange", change.step},
                      {"time", seconds_to_end(trace, change.step)},
                      {"faults", hal::fault_names(change.faults)}});
  out["replay"] = {{"begun", true},
                   {"reproduced", !report->difference},
                   {"begin", seconds_to_end(trace, report->begin)},
                   {"in_motion", report->in_motion},
                   {"compared", report->compared},
                   {"following_spindle", report->following_spindle},
                   {"largest_deviation", report->largest_deviation},
                   {"faults", faults}};
  if (report->difference)
    out["replay"]["difference"] = {{"exchange", report->difference->step},
                                   {"time", seconds_to_end(trace, report->difference->step)},
                                   {"what", report->difference->what}};
  return out;
}

}  // namespace

ExitCode replay_command(const ReplayOptions& options) {
  const auto trace = hal::trace::read_trace(options.file);
  if (!trace) return refuse(trace.error());
  if (!options.csv.empty())
    if (auto written = write_trace_csv(*trace, options.csv); !written)
      return refuse(written.error());
  const auto report = hal::trace::replay(*trace);
  if (options.json) {
    fmt::print(
        "{}\n",
        json_of(*trace, report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{}", summary_text(*trace));
    if (options.last > 0.0) fmt::print("{}", exchanges_text(*trace, options.last));
    fmt::print("{}", report ? verdict_text(*trace, *report)
                            : fmt::format("\nNOT REPLAYED: {}\n", report.error().message));
  }
  return report && !report->difference ? kGood : kProgramFailed;
}

}  // namespace cnc::server
