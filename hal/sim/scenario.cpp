#include "hal/sim/scenario.h"

#include <fmt/format.h>

#include "config/text_lines.h"
#include "hal/sim/scenario_sections.h"

namespace cnc::hal::sim {
namespace {

constexpr bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

// Debian 12's toml++ (3.3.0) has undefined behaviour for letters like the a-umlaut outside of texts
// and comments (is_non_ascii_horizontal_whitespace), so the parser is given ASCII only: in comments
// other letters are replaced, byte by byte to keep the columns, and elsewhere nothing needs them.
Result<std::string> ascii_text(std::string_view text, std::string_view name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::string result(text);
  TextPlace place{std::string(name), 1, 0};
  char quote = 0;  // that is open
  bool in_comment = false;
  for (std::size_t i = 0; i < result.size(); ++i) {
    char& c = result[i];
    ++place.column;
    if (c == '\n') {
      ++place.line;
      place.column = 0;
      quote = 0;
      in_comment = false;
    } else if (in_comment) {
      if (!is_ascii(c)) c = '?';
    } else if (!is_ascii(c)) {
      return fail(ErrorCode::scenario_not_toml,
                  "A letter that is not ASCII; it can stand in a comment only.", place);
    } else if (quote == 0) {
      if (c == '"' || c == '\'') quote = c;
      in_comment = c == '#';
    } else if (c == quote && (quote == '\'' || result[i - 1] != '\\')) {
      quote = 0;
    }
  }
  return result;
}

}  // namespace

Result<Scenario> load_scenario(const std::filesystem::path& path) {
  const Result<std::string> text = config::read_text_file(path);
  if (!text) return std::unexpected(text.error());
  return parse_scenario(*text, path.string());
}

Result<Scenario> parse_scenario(std::string_view text, std::string_view name) {
  const Result<std::string> ascii = ascii_text(text, name);
  if (!ascii) return std::unexpected(ascii.error());
  const toml::parse_result parsed = toml::parse(std::string_view(*ascii));
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
