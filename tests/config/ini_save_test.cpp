#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "config/atomic_file.h"
#include "config/ini_document.h"
#include "config/ini_file.h"
#include "config/schema.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;
using Catch::Matchers::Contains;
using test::content_of;
using test::put;

namespace {

const std::string kOldFile =
    "; my machine\n"
    "[AXIS_X]              ; the long one\n"
    "port = 1\n"
    "stepsPerUnit=200      ; do not touch\n"
    "  negativeLimit =0.000\n"
    "positiveLimit\t= 600\n"
    "velocity = 1.00e2     # fast enough\n"
    "acceleration = 500\n"
    "\n"
    "# the rest\n"
    "[JOB]\n"
    "autoToolChange = 0\n";

MachineConfig parsed(std::string_view text) {
  return parse_machine_config(text, "cnc.ini").value();
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  return text.replace(text.find(what), what.size(), with);
}

/// A machine with random values that break no rule.
MachineConfig random_machine(std::mt19937& random, MachineUnit unit) {
  std::uniform_real_distribution<double> some(0.0, 1.0);
  MachineConfig config;
  config.unit = unit;
  for (const Axis axis : kAllAxes) {
    config.axes[axis] = {.visible = some(random) < 0.5,
                         .port = static_cast<std::int32_t>(index_of(axis)),
                         .steps_per_unit = -1.0 - 100.0 * some(random),
                         .negative_limit = -500.0 * some(random),
                         .positive_limit = 1.0 + 500.0 * some(random),
                         .velocity = 50.0 + 100.0 * some(random),
                         .acceleration = 1.0 + 1000.0 * some(random),
                         .backlash = some(random),
                         .home_velocity = 40.0 * some(random) - 20.0,
                         .home_position = some(random)};
  }
  config.trajectory.fifo_time = 0.25 + some(random);
  config.safety.home_sensor_is_estop = some(random) < 0.5;
  return config;
}

void check_equal(const MachineConfig& a, const MachineConfig& b, double relative) {
  for (const Setting& setting : settings()) {
    INFO(setting.name());
    CHECK(a.unit == b.unit);
    const SettingValue one = setting.value(a);
    const SettingValue other = setting.value(b);
    if (const auto* number = std::get_if<double>(&one)) {
      CHECK(std::abs(*number - std::get<double>(other)) <= relative * std::abs(*number));
    } else {
      CHECK(one == other);
    }
  }
}

}  // namespace

TEST_CASE("A save without a change leaves every byte of the file", "[CFG-1]") {
  CHECK(machine_config_text(parsed(kOldFile), kOldFile) == kOldFile);
}

TEST_CASE("A save replaces the changed value and nothing else", "[CFG-1]") {
  MachineConfig config = parsed(kOldFile);
  config.axes[Axis::X].velocity = 80.5;
  CHECK(machine_config_text(config, kOldFile) == replaced(kOldFile, "1.00e2", "80.5"));
  config.axes[Axis::X].velocity = 100.0;
  config.job.auto_tool_change = true;
  CHECK(machine_config_text(config, kOldFile) ==
        replaced(kOldFile, "autoToolChange = 0", "autoToolChange = 1"));
}

TEST_CASE("A setting that the file lacks goes to the end of its section", "[CFG-1]") {
  MachineConfig config = parsed(kOldFile);
  config.axes[Axis::X].backlash = 0.05;
  config.axes[Axis::X].home_velocity = -10;
  CHECK(machine_config_text(config, kOldFile) ==
        replaced(kOldFile, "acceleration = 500\n",
                 "acceleration = 500\nbacklash = 0.05\nhomeVelocity = -10\n"));
}

TEST_CASE("A section that the file lacks goes to the end of the file", "[CFG-1]") {
  MachineConfig config = parsed(kOldFile);
  config.trajectory.fifo_time = 0.5;
  config.trajectory.laf_angle = 3;
  config.spindle.ramp_up_time = 2;
  CHECK(machine_config_text(config, kOldFile) ==
        kOldFile +
            "\n[TRAJECTORY]\nfifoTime = 0.5\nlafAngle = 3\n"
            "\n[SPINDLE_0]\nspindleRampUpTime = 2\n");
}

TEST_CASE("Windows line ends, a byte order mark and an open last line are kept up", "[CFG-1]") {
  const std::string old = "\xEF\xBB\xBF[TRAJECTORY]\r\nfifoTime = 0.5";
  MachineConfig config = parsed(old);
  config.trajectory.fifo_time = 0.4;
  config.trajectory.laf_angle = 3;
  config.job.auto_tool_change = true;
  CHECK(machine_config_text(config, old) ==
        "\xEF\xBB\xBF[TRAJECTORY]\r\nfifoTime = 0.4\r\nlafAngle = 3\r\n"
        "\r\n[JOB]\r\nautoToolChange = 1\r\n");
}

TEST_CASE("An empty value is filled in its place", "[CFG-1]") {
  const std::string old = "[TRAJECTORY]\nfifoTime = ; here\n";
  MachineConfig config;
  config.trajectory.fifo_time = 0.5;
  CHECK(machine_config_text(config, old) == "[TRAJECTORY]\nfifoTime =0.5 ; here\n");
}

TEST_CASE("A change of unit rewrites the lengths and keeps the machine", "[CFG-4]") {
  MachineConfig config = parsed(kOldFile);
  config.unit = MachineUnit::inch;
  const std::string text = machine_config_text(config, kOldFile);
  // 600 / 25.4 = 23.622047244094…; 200 steps/mm = 5080 steps/inch
  CHECK_THAT(text, Contains("positiveLimit\t= 23.622047244") && Contains("stepsPerUnit=5080 ") &&
                       Contains("machineUnit = inch") && Contains("negativeLimit =0.000"));
  check_equal(parsed(text), config, 1e-15);
}

TEST_CASE("Any machine comes back from a new file, with help for every setting", "[CFG-1]") {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const auto config = random_machine(random, MachineUnit::millimetre);
    REQUIRE(parsed(machine_config_text(config)) == config);
  }
  for (int i = 0; i < 50; ++i) {
    const auto config = random_machine(random, MachineUnit::inch);
    check_equal(parsed(machine_config_text(config)), config, 1e-15);
  }
  const std::string text = machine_config_text(MachineConfig{});
  for (const Setting& setting : settings()) CHECK_THAT(text, Contains(std::string(setting.help)));
}

TEST_CASE("Any machine can be saved over any other", "[CFG-1][CFG-4]") {
  std::mt19937 random(4);
  std::string text = kOldFile;
  for (int i = 0; i < 50; ++i) {
    const auto config =
        random_machine(random, i % 2 == 0 ? MachineUnit::inch : MachineUnit::millimetre);
    text = machine_config_text(config, text);
    check_equal(parsed(text), config, 1e-15);
    CHECK_THAT(text, Contains("; my machine\n") && Contains("; the long one\n") &&
                         Contains("; do not touch\n") && Contains("# fast enough\n"));
  }
}

TEST_CASE("A saved file can be loaded, and the one before is its backup", "[CFG-1][STA-9]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("cnc.ini");
  put(path, kOldFile);
  auto config = load_machine_config(path).value();
  config.axes[Axis::X].velocity = 80;
  REQUIRE(save_machine_config(path, config));
  CHECK(load_machine_config(path).value() == config);
  CHECK(content_of(path) == replaced(kOldFile, "1.00e2", "80"));
  CHECK(content_of(backup_path(path)) == kOldFile);
}

TEST_CASE("A configuration that could not be loaded again is not saved", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("cnc.ini");
  put(path, kOldFile);
  auto config = load_machine_config(path).value();
  config.axes[Axis::X].velocity = 1'000'000;
  const auto refused = save_machine_config(path, config);
  REQUIRE_FALSE(refused);
  CHECK(refused.error()[0].code == ErrorCode::config_value_out_of_range);
  CHECK(content_of(path) == kOldFile);
}

TEST_CASE("A value that a file cannot hold is refused, not replaced by another", "[CFG-1][CFG-4]") {
  const test::TemporaryDirectory directory;
  MachineConfig odd_choice;
  odd_choice.connection.max_step_frequency = 90'000;
  MachineConfig not_a_number;
  not_a_number.unit = MachineUnit::inch;
  not_a_number.axes[Axis::X].backlash = std::numeric_limits<double>::quiet_NaN();
  MachineConfig quote_inside;
  quote_inside.connection.board = "auto\"";
  for (const MachineConfig& config : {odd_choice, not_a_number, quote_inside}) {
    const auto refused = save_machine_config(directory.file("cnc.ini"), config);
    REQUIRE_FALSE(refused);
    CHECK(refused.error()[0].code == ErrorCode::config_bad_value);
  }
  CHECK_FALSE(std::filesystem::exists(directory.file("cnc.ini")));
}

TEST_CASE("A file that someone spoiled meanwhile is not saved over", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("cnc.ini");
  put(path, kOldFile + "rubbish\n");
  const auto refused = save_machine_config(path, parsed(kOldFile));
  REQUIRE_FALSE(refused);
  CHECK(refused.error()[0].place.value().line == 13);
  CHECK(content_of(path) == kOldFile + "rubbish\n");
}

TEST_CASE("A file that does not exist is created whole", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("new.ini");
  REQUIRE(save_machine_config(path, parsed(kOldFile)));
  CHECK(load_machine_config(path).value() == parsed(kOldFile));
}

TEST_CASE("Edits of one place keep their order and the rest of the text", "[CFG-1]") {
  CHECK(with_edits("abcdef", {{6, 0, "1"}, {2, 2, "X"}, {6, 0, "2"}, {0, 0, "<"}}) == "<abXef12");
  CHECK(with_edits("abc", {}) == "abc");
}

TEST_CASE("A text of two lines brings no second setting into the file", "[CFG-1][safety]") {
  const test::TemporaryDirectory directory;
  MachineConfig config;
  config.connection.board = "auto\npulseWidth = 0.1";
  CHECK_FALSE(save_machine_config(directory.file("cnc.ini"), config));
  CHECK_FALSE(std::filesystem::exists(directory.file("cnc.ini")));
}

TEST_CASE("A text comes back as it was, whatever it holds", "[CFG-1]") {
  for (const std::string text :
       {"virtual", "", " serial:/dev/tty 1 ", "a;b#c", "[x]=y", "50 µm", "'x'"}) {
    MachineConfig config;
    config.connection.board = text;
    const std::string written = machine_config_text(config);
    INFO(written);
    CHECK(parsed(written).connection.board == text);
    // Changed in its place, with the comment behind it left alone.
    const std::string old = "[CONNECTION]\nboard = \"old; text\" ; mine\n";
    const std::string changed = machine_config_text(config, old);
    CHECK(parsed(changed).connection.board == text);
    CHECK(changed.ends_with(" ; mine\n"));
  }
}
