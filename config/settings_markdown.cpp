// docs/settings.md, written from the settings table.
#include <fmt/format.h>
#include <string>

#include "config/schema.h"

namespace cnc::config {
namespace {

constexpr std::string_view kIntroduction =
    "# Settings of cnc.ini\n"
    "\n"
    "This page is written from the table in `config/settings_table.cpp` "
    "(`settings_as_markdown()`);\n"
    "a test fails when the two differ.\n"
    "\n"
    "`key = value` under `[SECTION]`; `;` and `#` begin a comment. Lengths are in the machine "
    "unit:\n"
    "the ranges and defaults below are for `machineUnit = mm`, with `inch` they are the same "
    "lengths\n"
    "in inches. A key that is not in the file has its default, except where the default column "
    "says\n"
    "*required*: such a key must be there for an axis whose port is not 0. On the command line and "
    "in\n"
    "the API a setting is written `SECTION.key=value`.\n";

/// The sections of the linear and of the rotary axes are alike: one table stands for three.
std::string heading(const Setting& setting) {
  if (setting.section == axis_section(Axis::X)) return "[AXIS_X], [AXIS_Y], [AXIS_Z]";
  if (setting.section == axis_section(Axis::A)) return "[AXIS_A], [AXIS_B], [AXIS_C]";
  return fmt::format("[{}]", setting.section);
}

bool is_repetition(const Setting& setting) {
  return setting.axis != Axis::X && setting.axis != Axis::A;
}

std::string default_text(const Setting& setting) {
  if (setting.required_when_connected) return "*required*";
  return setting_text(setting, setting.default_value(), MachineUnit::millimetre);
}

}  // namespace

std::string settings_as_markdown() {
  std::string page(kIntroduction);
  std::string_view section;
  for (const Setting& setting : settings()) {
    if (is_repetition(setting)) continue;
    if (setting.section != section) {
      page += fmt::format("\n## {}\n\n| key | allowed | default | meaning |\n|---|---|---|---|\n",
                          heading(setting));
    }
    section = setting.section;
    page += fmt::format("| `{}` | {} | {} | {} |\n", setting.key,
                        allowed_text(setting, MachineUnit::millimetre), default_text(setting),
                        setting.help);
  }
  return page;
}

}  // namespace cnc::config
