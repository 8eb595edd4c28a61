#include "api/cncctl/json.h"

#include <array>
#include <cmath>
#include <string>

#include "api/cncctl/text.h"

namespace cnc::ctl {
namespace {

using nlohmann::json;

double rounded(double value) { return std::round(value * 1e4) / 1e4; }

std::string key_of(api::Axis axis) {
  return std::string(1, "xyzabc"[static_cast<std::size_t>(axis)]);
}

json values(const api::AxisValues& array) {
  json object;
  for (const api::Axis axis : api::kAllAxes) object[key_of(axis)] = rounded(array[axis]);
  return object;
}

/// ["x", "z"]: the axes whose flag is set.
json set_axes(const api::AxisFlags& flags) {
  json array = json::array();
  for (const api::Axis axis : api::kAllAxes) {
    if (flags[axis]) array.push_back(key_of(axis));
  }
  return array;
}

json latches_json(const std::vector<api::LatchCatch>& latches) {
  constexpr std::array kSources{"home", "probe", "spindle_index", "estop", "unknown"};
  json rows = json::array();
  for (const api::LatchCatch& latch : latches) {
    json position;
    for (const api::Axis axis : api::kAllAxes)
      if (!latch.axis || latch.axis == axis) position[key_of(axis)] = rounded(latch.position[axis]);
    rows.push_back({{"source", kSources.at(static_cast<std::size_t>(latch.source))},
                    {"position", position},
                    {"age", latch.age},
                    {"count", latch.count}});
  }
  return rows;
}

json job_json(const api::JobStatus& job) {
  return {{"path", job.path},
          {"lines", job.lines},
          {"line", job.line},
          {"progress", rounded(job.progress)},
          {"elapsed", rounded(job.elapsed)},
          {"prediction_ready", job.prediction_ready},
          {"predicted_time", rounded(job.predicted_time)},
          {"time_left", rounded(job.time_left)},
          {"runs", job.runs},
          {"ended_well", job.ended_well},
          {"problems", job.problems},
          {"extents_min", values(job.extents_min)},
          {"extents_max", values(job.extents_max)}};
}

json commands_json(const api::MachineStatus& status) {
  json object;
  for (std::size_t i = 0; i < api::kCommandCount; ++i) {
    const auto command = static_cast<api::Command>(i);
    const api::CommandAvailability& availability = status.availability(command);
    object[std::string(name_of(command))] = {{"allowed", availability.allowed},
                                             {"reason", availability.reason}};
  }
  return object;
}

json place_json(const api::TextPlace& place) {
  return {{"file", place.file}, {"line", place.line}, {"column", place.column}};
}

json calls_json(const std::vector<api::CallSite>& calls) {
  json array = json::array();
  for (const api::CallSite& call : calls)
    array.push_back({{"sub", call.sub}, {"place", place_json(call.place)}});
  return array;
}

json trust_json(const api::AxisArray<api::PositionTrust>& trust) {
  json object;
  for (const api::Axis axis : api::kAllAxes) object[key_of(axis)] = name_of(trust[axis]);
  return object;
}

json histogram(const std::vector<api::HistogramBin>& bins) {
  json array = json::array();
  for (const api::HistogramBin& bin : bins) {
    array.push_back({{"upper", bin.upper}, {"count", bin.count}});
  }
  return array;
}

}  // namespace

json to_json(const api::Error& error) {
  json object{{"kind", name_of(error.kind)},
              {"code", error.code},
              {"name", error.name},
              {"message", error.message},
              {"check", error.check}};
  if (error.place) object["place"] = place_json(*error.place);
  return object;
}

json to_json(const api::MachineStatus& status) {
  return {{"sequence", status.sequence},
          {"time", rounded(status.time)},
          {"state", name_of(status.state)},
          {"state_text", status.state_text},
          {"machine_position", values(status.machine_position)},
          {"work_position", values(status.work_position)},
          {"homed", set_axes(status.homed)},
          {"trust", trust_json(status.trust)},
          {"velocity", values(status.velocity)},
          {"feed", rounded(status.feed)},
          {"programmed_feed", rounded(status.programmed_feed)},
          {"feed_override", rounded(status.feed_override)},
          {"rapid_override", rounded(status.rapid_override)},
          {"speed_override", rounded(status.speed_override)},
          {"overrides_enabled", status.overrides_enabled},
          {"spindle", name_of(status.spindle)},
          {"spindle_speed", rounded(status.spindle_speed)},
          {"mist", status.mist},
          {"flood", status.flood},
          {"tool", status.tool},
          {"selected_tool", status.selected_tool},
          {"work_system", status.work_system},
          {"active_codes", status.active_codes},
          {"job", job_json(status.job)},
          {"commands", commands_json(status)},
          {"estop_input", status.estop_input},
          {"home_switches", set_axes(status.home_switches)},
          {"fifo_time", rounded(status.fifo_time)},
          {"newest_message", status.newest_message},
          {"question", status.question ? to_json(*status.question) : json()},
          {"probe_input", status.probe_input}};
}

json to_json(const api::Question& question) {
  json fields = json::array();
  for (const api::Question::Field& field : question.fields) {
    fields.push_back(
        {{"label", field.label}, {"parameter", field.parameter}, {"value", field.value}});
  }
  return {{"number", question.number}, {"title", question.title}, {"fields", fields}};
}

json to_json(const api::ServerVersion& version) {
  return {{"server", version.server},
          {"api_major", version.api_major},
          {"api_minor", version.api_minor},
          {"controller", version.controller}};
}

json to_json(const api::LinkStatistics& statistics) {
  return {{"real_time", statistics.real_time},
          {"cycle_time", statistics.cycle_time},
          {"cycles", statistics.cycles},
          {"max_lateness", statistics.max_lateness},
          {"max_work", statistics.max_work},
          {"lateness", histogram(statistics.lateness)},
          {"work", histogram(statistics.work)},
          {"lowest_fifo_time", statistics.lowest_fifo_time},
          {"fifo_time", histogram(statistics.fifo_time)},
          {"last_round_trip", statistics.last_round_trip},
          {"mean_round_trip", statistics.mean_round_trip},
          {"max_round_trip", statistics.max_round_trip},
          {"round_trip", histogram(statistics.round_trip)},
          {"packets",
           {{"sent", statistics.packets.sent},
            {"resent", statistics.packets.resent},
            {"answered", statistics.packets.answered},
            {"passed_over", statistics.packets.passed_over},
            {"corrupted", statistics.packets.corrupted}}},
          {"connected", statistics.connected},
          {"sessions", statistics.sessions},
          {"board_name", statistics.board_name},
          {"board_serial", statistics.board_serial},
          {"latches", latches_json(statistics.latches)}};
}

json to_json(const api::LoadedJob& job) {
  return {{"path", job.path}, {"lines", job.lines}, {"bytes", job.bytes}};
}

json to_json(const api::ProblemList& list) {
  json problems = json::array();
  for (const api::Problem& problem : list.problems) {
    problems.push_back({{"error", to_json(problem.error)},
                        {"line_text", problem.line_text},
                        {"length", problem.length},
                        {"warning", problem.warning},
                        {"calls", calls_json(problem.calls)}});
  }
  return {{"problems", problems}, {"complete", list.complete}};
}

json to_json(const api::Message& message) {
  json object{{"sequence", message.sequence},
              {"time_unix_ms", message.time.time_since_epoch().count()},
              {"severity", name_of(message.severity)},
              {"text", message.text}};
  if (message.error) object["error"] = to_json(*message.error);
  return object;
}

json to_json(const api::Overrides& overrides) {
  return {{"feed", rounded(overrides.feed)},
          {"rapid", rounded(overrides.rapid)},
          {"speed", rounded(overrides.speed)}};
}

}  // namespace cnc::ctl
