// Writing cnc.ini: a new file with help for every setting, or the operator's own with the values
// replaced in their places.
#include <algorithm>
#include <fmt/format.h>

#include "config/ini_document.h"
#include "config/ini_file.h"
#include "config/schema.h"

namespace cnc::config {
namespace {

std::string value_text(const Setting& setting, const MachineConfig& config) {
  return setting_text(setting, setting.value(config), config.unit);
}

std::string new_file_text(const MachineConfig& config) {
  std::string text = "; The machine. docs/settings.md explains every setting.\n";
  std::string_view section;
  for (const Setting& setting : settings()) {
    if (setting.section != section) text += fmt::format("\n[{}]\n", setting.section);
    section = setting.section;
    text +=
        fmt::format("; {} Allowed: {}.\n{} = {}\n", setting.help,
                    allowed_text(setting, config.unit), setting.key, value_text(setting, config));
  }
  return text;
}

/// Brings the text of an old file to the values of a configuration, with as few edits as possible.
class Editor {
 public:
  Editor(const MachineConfig& config, std::string_view old_text)
      : config_(config),
        line_end_(old_text.find("\r\n") != std::string_view::npos ? "\r\n" : "\n"),
        text_(old_text) {
    if (!text_.ends_with('\n')) text_ += line_end_;
    document_ = parse_ini(text_, "");
  }

  std::string edited() {
    for (const Setting& setting : settings()) edit(setting);
    return with_edits(text_, std::move(edits_));
  }

 private:
  void edit(const Setting& setting) {
    const auto entry = std::ranges::find_if(document_.entries, [&setting](const IniEntry& row) {
      return row.section == setting.section && row.key == setting.key;
    });
    if (entry != document_.entries.end()) {
      replace(*entry, setting);
    } else if (must_be_written(setting)) {
      add(setting);
    }
  }

  // What an old file leaves out stays out as long as its absence means the same.
  [[nodiscard]] bool must_be_written(const Setting& setting) const {
    return setting.value(config_) != setting.default_value() ||
           (setting.required_when_connected && config_.axes[setting.axis].connected());
  }

  // "1.50" stays "1.50" when that is the value.
  void replace(const IniEntry& entry, const Setting& setting) {
    if (parse_setting(setting, entry.value, config_.unit) == setting.value(config_)) return;
    edits_.push_back({static_cast<std::size_t>(entry.value.data() - text_.data()),
                      entry.value.size(), value_text(setting, config_)});
  }

  void add(const Setting& setting) {
    const auto line =
        fmt::format("{} = {}{}", setting.key, value_text(setting, config_), line_end_);
    const auto section = std::ranges::find(document_.sections, setting.section, &IniSection::name);
    if (section != document_.sections.end()) {
      edits_.push_back({section->end, 0, line});
      return;
    }
    if (setting.section != new_section_) {
      edits_.push_back({text_.size(), 0, fmt::format("{0}[{1}]{0}", line_end_, setting.section)});
      new_section_ = setting.section;
    }
    edits_.push_back({text_.size(), 0, line});
  }

  const MachineConfig& config_;
  std::string_view line_end_;
  std::string text_;
  IniDocument document_;
  std::string_view new_section_;  ///< the section begun at the end of the text last
  std::vector<TextEdit> edits_;
};

}  // namespace

std::string machine_config_text(const MachineConfig& config, std::string_view old_text) {
  return old_text.empty() ? new_file_text(config) : Editor(config, old_text).edited();
}

}  // namespace cnc::config
