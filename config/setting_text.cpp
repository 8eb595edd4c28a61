// The texts of a setting: how a value is read, written, and described to a person.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

#include "config/schema.h"
#include "config/text_lines.h"

namespace cnc::config {
namespace {

constexpr double kMillimetresPerInch = 25.4;

struct UnitInfo {
  SettingUnit unit;
  std::string_view metric;
  std::string_view inch;
  int length_power;  ///< how often the unit holds the length unit: 1, 0, or -1 for "per length"
};

constexpr std::array kUnits{
    UnitInfo{SettingUnit::none, "", "", 0},
    UnitInfo{SettingUnit::length, "mm", "inch", 1},
    UnitInfo{SettingUnit::length_per_second, "mm/s", "inch/s", 1},
    UnitInfo{SettingUnit::length_per_second2, "mm/s²", "inch/s²", 1},
    UnitInfo{SettingUnit::length_per_second3, "mm/s³", "inch/s³", 1},
    UnitInfo{SettingUnit::steps_per_length, "steps/mm", "steps/inch", -1},
    UnitInfo{SettingUnit::degree, "°", "°", 0},
    UnitInfo{SettingUnit::degree_per_second, "°/s", "°/s", 0},
    UnitInfo{SettingUnit::degree_per_second2, "°/s²", "°/s²", 0},
    UnitInfo{SettingUnit::degree_per_second3, "°/s³", "°/s³", 0},
    UnitInfo{SettingUnit::steps_per_degree, "steps/°", "steps/°", 0},
    UnitInfo{SettingUnit::second, "s", "s", 0},
    UnitInfo{SettingUnit::microsecond, "µs", "µs", 0},
    UnitInfo{SettingUnit::rpm, "rpm", "rpm", 0},
    UnitInfo{SettingUnit::hertz, "Hz", "Hz", 0},
};

constexpr const UnitInfo& info_of(SettingUnit unit) { return kUnits[std::to_underlying(unit)]; }

static_assert(std::ranges::all_of(kUnits,
                                  [](const UnitInfo& row) { return &info_of(row.unit) == &row; }),
              "kUnits stands in the order of SettingUnit");

double to_base(double value, SettingUnit unit, MachineUnit machine_unit) {
  if (machine_unit == MachineUnit::millimetre) return value;
  const int power = info_of(unit).length_power;
  return power > 0 ? value * kMillimetresPerInch : power < 0 ? value / kMillimetresPerInch : value;
}

double from_base(double value, SettingUnit unit, MachineUnit machine_unit) {
  if (machine_unit == MachineUnit::millimetre) return value;
  const int power = info_of(unit).length_power;
  return power > 0 ? value / kMillimetresPerInch : power < 0 ? value * kMillimetresPerInch : value;
}

// A bound that was written in inches may miss itself by a rounding when it is read back.
std::optional<double> within_range(double value, const Setting& setting) {
  constexpr double kRounding = 1e-12;
  if (value < setting.min - kRounding * std::abs(setting.min)) return std::nullopt;
  if (value > setting.max + kRounding * std::abs(setting.max)) return std::nullopt;
  return std::clamp(value, setting.min, setting.max);
}

std::string choice_names(const Setting& setting) {
  std::string names;
  for (const Choice& choice : setting.choices) {
    if (!names.empty()) names += ", ";
    names += choice.text;
  }
  return names;
}

std::unexpected<Error> refuse(ErrorCode code, const Setting& setting, std::string_view text,
                              MachineUnit machine_unit) {
  return fail(code, fmt::format("{}: read {}; allowed is {}.", setting.name(), in_quotes(text),
                                allowed_text(setting, machine_unit)));
}

std::optional<double> parse_toggle(std::string_view text) {
  if (text == "0") return 0.0;
  if (text == "1") return 1.0;
  return std::nullopt;
}

std::optional<double> parse_choice(const Setting& setting, std::string_view text) {
  const auto choice = std::ranges::find(setting.choices, text, &Choice::text);
  return choice == setting.choices.end() ? std::nullopt : std::optional(choice->value);
}

std::optional<double> parse_raw(const Setting& setting, std::string_view text) {
  switch (setting.type) {
    case SettingType::number:
      return parse_number(text);
    case SettingType::integer:
      return parse_integer(text);
    case SettingType::toggle:
      return parse_toggle(text);
    case SettingType::choice:
      return parse_choice(setting, text);
    case SettingType::text:
      break;
  }
  return std::nullopt;
}

/// The text in quotes, or as it is; nothing if it has a quote or a control character inside.
std::optional<std::string_view> parse_text(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  const auto content = quoted ? text.substr(1, text.size() - 2) : text;
  const bool plain = std::ranges::none_of(
      content, [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '"'; });
  return plain ? std::optional(content) : std::nullopt;
}

/// In quotes where blanks or a comment's sign would be lost without.
std::string written_text(const std::string& text) {
  const bool bare =
      !text.empty() && trimmed(text) == text && text.find_first_of(";#") == std::string::npos;
  return bare ? text : fmt::format("\"{}\"", text);
}

bool has_range(const Setting& setting) {
  return setting.type == SettingType::number || setting.type == SettingType::integer;
}

// In inches, an entered 4 must not come back as 3.9999999999999996: the fewest digits that read
// back as the same millimetres. Not every double in mm is 25.4 times a double; 17 digits are then
// as near as one gets.
std::string length_text(double value, SettingUnit unit, MachineUnit machine_unit) {
  const double shown = from_base(value, unit, machine_unit);
  std::string text;
  for (int digits = 12; digits <= 17; ++digits) {
    text = fmt::format("{:.{}g}", shown, digits);
    const auto read = parse_number(text);
    if (read && to_base(*read, unit, machine_unit) == value) break;
  }
  return text;
}

// A value that is no choice is written as it is, for the reader to refuse: a save must not pick
// one.
std::string choice_text(const Setting& setting, double value) {
  const auto choice = std::ranges::find(setting.choices, value, &Choice::value);
  return choice == setting.choices.end() ? number_text(value) : std::string(choice->text);
}

}  // namespace

std::string Setting::name() const { return fmt::format("[{}] {}", section, key); }

std::string_view unit_text(SettingUnit unit, MachineUnit machine_unit) {
  return machine_unit == MachineUnit::inch ? info_of(unit).inch : info_of(unit).metric;
}

Result<SettingValue> parse_setting(const Setting& setting, std::string_view text,
                                   MachineUnit machine_unit) {
  if (setting.type == SettingType::text) {
    const auto content = parse_text(text);
    if (!content) return refuse(ErrorCode::config_bad_value, setting, text, machine_unit);
    if (static_cast<double>(content->size()) > setting.max)
      return refuse(ErrorCode::config_value_out_of_range, setting, text, machine_unit);
    return std::string(*content);
  }
  const auto raw = parse_raw(setting, text);
  if (!raw) return refuse(ErrorCode::config_bad_value, setting, text, machine_unit);
  if (!has_range(setting)) return *raw;
  const auto value = within_range(to_base(*raw, setting.unit, machine_unit), setting);
  if (!value) return refuse(ErrorCode::config_value_out_of_range, setting, text, machine_unit);
  return *value;
}

std::string setting_text(const Setting& setting, const SettingValue& any,
                         MachineUnit machine_unit) {
  if (const auto* text = std::get_if<std::string>(&any)) return written_text(*text);
  const double value = std::get<double>(any);
  if (setting.type == SettingType::choice) return choice_text(setting, value);
  const bool converted =
      machine_unit == MachineUnit::inch && info_of(setting.unit).length_power != 0;
  return converted ? length_text(value, setting.unit, machine_unit) : number_text(value);
}

std::string allowed_text(const Setting& setting, MachineUnit machine_unit) {
  if (setting.type == SettingType::toggle) return "0 or 1";
  if (setting.type == SettingType::choice) return "one of " + choice_names(setting);
  if (setting.type == SettingType::text)
    return fmt::format("a text of at most {} bytes, in quotes if it has a ; or #", setting.max);
  const auto unit = unit_text(setting.unit, machine_unit);
  return fmt::format("{} from {:.7g} to {:.7g}{}{}",
                     setting.type == SettingType::integer ? "a whole number" : "a number",
                     from_base(setting.min, setting.unit, machine_unit),
                     from_base(setting.max, setting.unit, machine_unit), unit.empty() ? "" : " ",
                     unit);
}

}  // namespace cnc::config
