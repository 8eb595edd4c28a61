#include "config/ini_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <optional>

#include "config/atomic_file.h"
#include "config/config_checks.h"
#include "config/ini_document.h"
#include "config/nearest_name.h"
#include "config/schema.h"
#include "config/text_lines.h"

namespace cnc::config {
namespace {

using Place = std::optional<TextPlace>;

std::vector<std::string_view> section_names() {
  std::vector<std::string_view> names;
  for (const Setting& setting : settings()) {
    if (names.empty() || names.back() != setting.section) names.push_back(setting.section);
  }
  return names;
}

std::vector<std::string_view> key_names(std::string_view section) {
  std::vector<std::string_view> names;
  for (const Setting& setting : settings()) {
    if (setting.section == section) names.push_back(setting.key);
  }
  return names;
}

bool is_section(std::string_view name) {
  return std::ranges::find(settings(), name, &Setting::section) != settings().end();
}

Error unknown_section(std::string_view section, Place place) {
  return {ErrorCode::config_unknown_section,
          fmt::format("There is no section {}; the nearest is [{}].", in_quotes(section),
                      nearest_name(section, section_names())),
          std::move(place)};
}

Error unknown_key(std::string_view section, std::string_view key, Place place) {
  return {ErrorCode::config_unknown_key,
          fmt::format("[{}] has no key {}; the nearest is \"{}\".", section, in_quotes(key),
                      nearest_name(key, key_names(section))),
          std::move(place)};
}

// For sorting: what is not in the file comes last.
std::uint32_t line_of(const Error& error) {
  return error.place ? error.place->line : std::numeric_limits<std::uint32_t>::max();
}

/// A value that a text gives to a setting.
struct Assignment {
  std::string_view text;
  Place place;
};

/// Gathers the texts of all settings first, because the machine unit that the lengths are in may
/// stand anywhere among them; finish() then turns them into a configuration.
class Loader {
 public:
  explicit Loader(const MachineConfig& base) : base_(base), assignments_(settings().size()) {}

  void add_file(std::string_view text, std::string_view name) {
    file_ = name;
    IniDocument document = parse_ini(text, name);
    errors_ = std::move(document.errors);
    for (const IniSection& section : document.sections) {
      if (!is_section(section.name)) report(unknown_section(section.name, section.place));
    }
    for (const IniEntry& entry : document.entries) {
      if (is_section(entry.section)) add_entry(entry);
    }
  }

  void add_override(std::string_view text) {
    const auto equals = text.find('=');
    const auto name = trimmed(text.substr(0, equals));
    const auto point = name.find('.');
    if (equals == std::string_view::npos || point == std::string_view::npos) {
      return report({ErrorCode::config_bad_line,
                     fmt::format("Read {}; allowed is \"SECTION.key=value\".", in_quotes(text)),
                     std::nullopt});
    }
    const auto section = name.substr(0, point);
    const auto key = name.substr(point + 1);
    if (!is_section(section)) return report(unknown_section(section, std::nullopt));
    const Setting* setting = find_setting(section, key);
    if (setting == nullptr) return report(unknown_key(section, key, std::nullopt));
    assignment(*setting) = Assignment{trimmed(text.substr(equals + 1)), std::nullopt};
  }

  std::expected<MachineConfig, Errors> finish() {
    MachineConfig config = base_;
    // The unit comes first: the other texts are read in it.
    const Setting& unit = *find_setting("USERINTERFACE", "machineUnit");
    evaluate(unit, config);
    for (const Setting& setting : settings()) {
      if (&setting != &unit) evaluate(setting, config);
    }
    if (errors_.empty()) check_required(config);
    if (errors_.empty()) check_conflicts(config);
    if (errors_.empty()) return config;
    std::ranges::stable_sort(errors_, {}, line_of);
    return std::unexpected(std::move(errors_));
  }

 private:
  void add_entry(const IniEntry& entry) {
    const Setting* setting = find_setting(entry.section, entry.key);
    if (setting == nullptr) return report(unknown_key(entry.section, entry.key, entry.place));
    auto& slot = assignment(*setting);
    if (slot) {
      return report(
          {ErrorCode::config_duplicate_key,
           fmt::format("{} stands in line {} already.", setting->name(), slot->place->line),
           entry.place});
    }
    slot = Assignment{entry.value, entry.place};
  }

  void evaluate(const Setting& setting, MachineConfig& config) {
    const auto& given = assignment(setting);
    if (!given) return;
    auto value = parse_setting(setting, given->text, config.unit);
    if (value) return setting.assign(config, *value);
    value.error().place = given->place;
    report(std::move(value.error()));
  }

  void check_required(const MachineConfig& config) {
    for (const Setting& setting : settings()) {
      if (!setting.required_when_connected || !config.axes[setting.axis].connected()) continue;
      const bool known = assignment(setting) || base_.axes[setting.axis].connected() ||
                         setting.value(base_) != setting.default_value();
      if (known) continue;
      report({ErrorCode::config_missing_key,
              fmt::format("{} is missing, but axis {} is connected; allowed is {}.", setting.name(),
                          axis_name(setting.axis), allowed_text(setting, config.unit)),
              place_of(*find_setting(setting.section, "port"))});
    }
  }

  void check_conflicts(const MachineConfig& config) {
    for (ConfigConflict& conflict : find_conflicts(config)) {
      conflict.error.place = place_of(*conflict.setting);
      report(std::move(conflict.error));
    }
  }

  // A setting that no text gives has its default; the file is then all that can be named.
  Place place_of(const Setting& setting) {
    const auto& given = assignment(setting);
    if (given) return given->place;
    return file_.empty() ? Place{} : TextPlace{std::string(file_), 0, 0};
  }

  std::optional<Assignment>& assignment(const Setting& setting) {
    return assignments_[static_cast<std::size_t>(&setting - settings().data())];
  }

  void report(Error error) {
    if (errors_.size() < kMaxIniErrors) errors_.push_back(std::move(error));
  }

  const MachineConfig base_;
  std::string_view file_;
  std::vector<std::optional<Assignment>> assignments_;  ///< in the order of settings()
  Errors errors_;
};

std::expected<MachineConfig, Errors> finish_with(Loader& loader,
                                                 std::span<const std::string> overrides) {
  for (const std::string& text : overrides) loader.add_override(text);
  return loader.finish();
}

}  // namespace

std::expected<MachineConfig, Errors> load_machine_config(const std::filesystem::path& path,
                                                         std::span<const std::string> overrides) {
  const auto text = read_text_file(path);
  if (!text) return std::unexpected(Errors{text.error()});
  return parse_machine_config(*text, path.string(), overrides);
}

std::expected<MachineConfig, Errors> parse_machine_config(std::string_view text,
                                                          std::string_view name,
                                                          std::span<const std::string> overrides) {
  Loader loader{MachineConfig{}};
  loader.add_file(text, name);
  return finish_with(loader, overrides);
}

std::expected<MachineConfig, Errors> apply_settings(const MachineConfig& config,
                                                    std::span<const std::string> changes) {
  Loader loader{config};
  return finish_with(loader, changes);
}

std::expected<void, Errors> save_machine_config(const std::filesystem::path& path,
                                                const MachineConfig& config) {
  const auto old_text = read_text_file(path);
  if (!old_text && old_text.error().code != ErrorCode::file_not_found) {
    return std::unexpected(Errors{old_text.error()});
  }
  const std::string text = machine_config_text(config, old_text.value_or(""));
  const auto reread = parse_machine_config(text, path.string());
  if (!reread) return std::unexpected(reread.error());
  const auto written = write_file_atomically(path, text);
  if (!written) return std::unexpected(Errors{written.error()});
  return {};
}

}  // namespace cnc::config
