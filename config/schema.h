// The one table of every setting in cnc.ini.
//
// Name, type, unit, range, default and help of a setting stand here once; the reader and writer of
// cnc.ini, the setup pages, the API and docs/settings.md all work from this table. Adding a setting
// is a member in machine_config.h and a row in settings_table.cpp.
//
// Every value but a text travels as a double in base units (mm, s, degree, rpm; µs of pulses): a
// toggle is 0 or 1, a choice is the value of one of its names. Only the texts of a file whose
// machine unit is the inch hold inches.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "config/axis.h"
#include "config/error.h"
#include "config/machine_config.h"

namespace cnc::config {

enum class SettingType : std::uint8_t { number, integer, toggle, choice, text };

using SettingValue = std::variant<double, std::string>;  ///< a string of a text only

enum class SettingUnit : std::uint8_t {
  none,
  length,
  length_per_second,
  length_per_second2,
  length_per_second3,
  steps_per_length,
  degree,
  degree_per_second,
  degree_per_second2,
  degree_per_second3,
  steps_per_degree,
  second,
  microsecond,
  rpm,
  hertz,
};

/// One of the texts that a choice may have, and the value that it stands for.
struct Choice {
  std::string_view text;
  double value;
};

/// How the value of a setting is read from and written to the configuration.
struct SettingAccess {
  SettingValue (*get)(const MachineConfig&, Axis);
  void (*set)(MachineConfig&, Axis, const SettingValue&);
};

struct Setting {
  std::string_view section{};  ///< "AXIS_X"
  std::string_view key{};      ///< "stepsPerUnit"
  SettingType type = SettingType::number;
  SettingUnit unit = SettingUnit::none;
  double min = 0.0;                   ///< mm and degrees, whatever the machine unit
  double max = 0.0;                   ///< of a text: the most bytes
  std::span<const Choice> choices{};  ///< of a choice only
  std::string_view help{};
  SettingAccess access{};
  /// A connected axis must say this itself: a machine moved by a guessed value is a danger.
  bool required_when_connected = false;
  Axis axis = Axis::X;  ///< of an axis' section

  [[nodiscard]] SettingValue value(const MachineConfig& config) const {
    return access.get(config, axis);
  }
  void assign(MachineConfig& config, const SettingValue& value) const {
    access.set(config, axis, value);
  }
  [[nodiscard]] SettingValue default_value() const { return value(MachineConfig{}); }
  /// "[AXIS_X] stepsPerUnit"
  [[nodiscard]] std::string name() const;
};

/// All settings, section by section in the order of the documents and the setup pages.
[[nodiscard]] std::span<const Setting> settings();

/// "AXIS_X" … "AXIS_C".
[[nodiscard]] std::string_view axis_section(Axis axis);

/// The setting of that name, or nullptr. Names are exact, capitals included.
[[nodiscard]] const Setting* find_setting(std::string_view section, std::string_view key);

/// "mm/s", "inch/s", "s", …; "" for a plain number.
[[nodiscard]] std::string_view unit_text(SettingUnit unit, MachineUnit machine_unit);

/// The value that `text` stands for in a file with this machine unit; an error says what was read
/// and what is allowed.
[[nodiscard]] Result<SettingValue> parse_setting(const Setting& setting, std::string_view text,
                                                 MachineUnit machine_unit);
/// The text of a value in a file with this machine unit, as short as reads back the same.
[[nodiscard]] std::string setting_text(const Setting& setting, const SettingValue& value,
                                       MachineUnit machine_unit);
/// "a number from 0.001 to 10000 mm/s", "one of mm, inch", "0 or 1", "a text of at most 80 bytes"
[[nodiscard]] std::string allowed_text(const Setting& setting, MachineUnit machine_unit);

/// The page docs/settings.md.
[[nodiscard]] std::string settings_as_markdown();

}  // namespace cnc::config
