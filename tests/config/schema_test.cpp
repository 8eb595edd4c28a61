#include "config/schema.h"

#include <catch2/catch.hpp>
#include <set>

#include "config/config_checks.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;

namespace {

double parsed(std::string_view section, std::string_view key, std::string_view text,
              MachineUnit unit) {
  return std::get<double>(parse_setting(*find_setting(section, key), text, unit).value());
}

/// Another value than the default, that a file may hold.
SettingValue another_value(const Setting& setting) {
  const SettingValue usual = setting.default_value();
  if (setting.type == SettingType::text) return std::get<std::string>(usual) + "!";
  if (setting.type == SettingType::toggle) return 1.0 - std::get<double>(usual);
  if (!setting.choices.empty()) {
    const bool first = usual == SettingValue{setting.choices[0].value};
    return setting.choices[first ? 1 : 0].value;
  }
  return usual == SettingValue{setting.max} ? setting.min : setting.max;
}

std::string allowed(std::string_view section, std::string_view key, MachineUnit unit) {
  return allowed_text(*find_setting(section, key), unit);
}

constexpr auto kMm = MachineUnit::millimetre;
constexpr auto kInch = MachineUnit::inch;

}  // namespace

TEST_CASE("Every row of the settings table is complete, and no name stands twice", "[CFG-1]") {
  std::set<std::string> names;
  for (const Setting& setting : settings()) {
    INFO(setting.name());
    CHECK(names.insert(setting.name()).second);
    CHECK_FALSE(setting.section.empty());
    CHECK_FALSE(setting.key.empty());
    CHECK(setting.help.ends_with('.'));
    CHECK((setting.type == SettingType::choice) == !setting.choices.empty());
    const bool has_range =
        setting.type == SettingType::number || setting.type == SettingType::integer;
    const bool is_text = setting.type == SettingType::text;
    CHECK((setting.min < setting.max) == (has_range || is_text));
    CHECK(std::holds_alternative<std::string>(setting.default_value()) == is_text);
    CHECK(find_setting(setting.section, setting.key) == &setting);
  }
}

TEST_CASE("Only A can carry the work piece of a mill", "[CFG-3]") {
  CHECK(parse_setting(*find_setting("AXIS_A", "mode"), "mill4", kMm));
  CHECK_FALSE(parse_setting(*find_setting("AXIS_B", "mode"), "mill4", kMm));
  CHECK(find_setting("AXIS_X", "mode") == nullptr);
}

TEST_CASE("Every default is a value that its own file may hold", "[CFG-1]") {
  for (const MachineUnit unit : {kMm, kInch}) {
    for (const Setting& setting : settings()) {
      const SettingValue value = setting.default_value();
      const auto text = setting_text(setting, value, unit);
      INFO(setting.name() << " = " << text);
      const auto read = parse_setting(setting, text, unit);
      REQUIRE(read);
      if (const auto* number = std::get_if<double>(&value)) {
        CHECK(std::get<double>(*read) == Approx(*number).epsilon(1e-15));
      } else {
        CHECK(*read == value);
      }
    }
  }
}

TEST_CASE("The defaults of an empty file break no rule", "[CFG-1]") {
  CHECK(find_conflicts(MachineConfig{}).empty());
}

TEST_CASE("Every setting changes its own member and no other", "[CFG-1]") {
  for (const Setting& setting : settings()) {
    INFO(setting.name());
    MachineConfig config;
    const SettingValue other = another_value(setting);
    setting.assign(config, other);
    for (const Setting& row : settings()) {
      INFO(row.name());
      CHECK(row.value(config) == (&row == &setting ? other : row.default_value()));
    }
  }
}

TEST_CASE("Bounds are in, what lies beyond them is out, in either machine unit", "[CFG-1][CFG-4]") {
  for (const MachineUnit unit : {kMm, kInch}) {
    for (const Setting& setting : settings()) {
      if (setting.type != SettingType::number) continue;
      INFO(setting.name());
      CHECK(parse_setting(setting, setting_text(setting, setting.min, unit), unit) ==
            SettingValue{setting.min});
      CHECK(parse_setting(setting, setting_text(setting, setting.max, unit), unit) ==
            SettingValue{setting.max});
      for (const double outside :
           {setting.min - 1e-6 * (1.0 + std::abs(setting.min)), setting.max * (1.0 + 1e-6)}) {
        const auto refused = parse_setting(setting, setting_text(setting, outside, unit), unit);
        REQUIRE_FALSE(refused);
        CHECK(refused.error().code == ErrorCode::config_value_out_of_range);
      }
    }
  }
}

TEST_CASE("With machine unit inch lengths are inches and steps are per inch", "[CFG-4]") {
  CHECK(parsed("AXIS_X", "positiveLimit", "10", kInch) == 254.0);
  CHECK(parsed("AXIS_X", "velocity", "4", kInch) == 4 * 25.4);
  CHECK(parsed("AXIS_X", "acceleration", "4", kInch) == 4 * 25.4);
  CHECK(parsed("AXIS_X", "stepsPerUnit", "5080", kInch) == Approx(200.0));  // 5080 / 25.4
  CHECK(parsed("AXIS_A", "stepsPerUnit", "100", kInch) == 100.0);           // per degree
  CHECK(parsed("AXIS_A", "velocity", "90", kInch) == 90.0);
  CHECK(parsed("TRAJECTORY", "fifoTime", "0.25", kInch) == 0.25);
}

TEST_CASE("A length entered in inches is shown again as it was entered", "[CFG-4]") {
  const Setting& limit = *find_setting("AXIS_X", "positiveLimit");
  for (int thousandths = -40'000; thousandths <= 40'000; thousandths += 7) {
    const std::string text = setting_text(limit, thousandths / 1000.0, kMm);
    const SettingValue value = parse_setting(limit, text, kInch).value();
    REQUIRE(setting_text(limit, value, kInch) == text);
  }
}

TEST_CASE("What is allowed is said in words of the machine's unit", "[CFG-1][CFG-4]") {
  CHECK(allowed("AXIS_X", "visible", kMm) == "0 or 1");
  CHECK(allowed("AXIS_X", "port", kMm) == "a whole number from 0 to 6");
  CHECK(allowed("AXIS_X", "velocity", kMm) == "a number from 0.001 to 10000 mm/s");
  // 10000 / 25.4 = 393.70079, 0.001 / 25.4 = 3.937008e-5
  CHECK(allowed("AXIS_X", "velocity", kInch) == "a number from 3.937008e-05 to 393.7008 inch/s");
  CHECK(allowed("AXIS_C", "velocity", kInch) == "a number from 0.001 to 10000 °/s");
  CHECK(allowed("USERINTERFACE", "machineUnit", kMm) == "one of mm, inch");
  CHECK(allowed("CONNECTION", "pulseWidth", kInch) == "a number from 0.1 to 20 µs");
  CHECK(allowed("CONNECTION", "board", kMm) ==
        "a text of at most 200 bytes, in quotes if it has a ; or #");
}

TEST_CASE("The page of the settings is the one that the table writes", "[CFG-1]") {
  INFO("reference_pages settings > docs/settings.md brings the page up to date");
  CHECK(test::content_of(CNC_SOURCE_DIR "/docs/settings.md") == settings_as_markdown());
}
