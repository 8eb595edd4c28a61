#include "hal/sim/scenario.h"

#include <fmt/format.h>

#include "config/text_lines.h"
#include "hal/sim/scenario_sections.h"

namespace cnc::hal::sim {

Result<Scenario> load_scenario(const std::filesystem::path& path) {
  const Result<std::string> text = config::read_text_file(path);
  if (!text) return std::unexpected(text.error());
  return parse_scenario(*text, path.string());
}

Result<Scenario> parse_scenario(std::string_view text, std::string_view name) {
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    const toml::source_position place = parsed.error().source().begin;
    return fail(ErrorCode::scenario_not_toml,
                fmt::format("The file is not TOML here: {}.", parsed.error().description()),
                {std::string(name), place.line, place.column});
  }
  ScenarioErrors errors{std::string(name)};
  ScenarioTable file(parsed.table(), "", errors);
  Scenario scenario;
  read_machine(file, scenario.machine);
  read_link(file, scenario.link);
  read_events(file, scenario.events);
  file.finish();
  if (errors.first) return std::unexpected(std::move(*errors.first));
  return scenario;
}

void read_link(ScenarioTable& file, LinkTrouble& link) {
  std::optional<ScenarioTable> table = file.table("link");
  if (!table) return;
  table->read("cable_out", link.cable_out);
  table->read("loss", link.loss, kProbabilityRange);
  table->read("duplication", link.duplication, kProbabilityRange);
  table->read("corruption", link.corruption, kProbabilityRange);
  table->read("delay", link.delay, kLinkTimeRange);
  table->read("jitter", link.jitter, kLinkTimeRange);
  table->finish();
}

}  // namespace cnc::hal::sim
