#include "config/ini_file.h"

#include <catch2/catch.hpp>

#include "config/config_checks.h"
#include "config/ini_document.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;
using Catch::Matchers::Contains;

namespace {

// A file with one connected axis that breaks no rule; line 1 is the section.
const std::string kGoodX =
    "[AXIS_X]\n"
    "port = 1\n"
    "stepsPerUnit = 200\n"
    "negativeLimit = 0\n"
    "positiveLimit = 600\n"
    "velocity = 100\n"
    "acceleration = 500\n";

Errors refusals(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const auto result = parse_machine_config(text, "cnc.ini", overrides);
  REQUIRE_FALSE(result);
  return result.error();
}

/// The text is refused for exactly one reason, in that line.
void check_refusal(const std::string& text, ErrorCode code, std::uint32_t line,
                   std::initializer_list<std::string> parts) {
  INFO(text);
  const Errors errors = refusals(text);
  REQUIRE(errors.size() == 1);
  INFO(errors[0].to_string());
  CHECK(errors[0].code == code);
  REQUIRE(errors[0].place);
  CHECK(errors[0].place->file == "cnc.ini");
  CHECK(errors[0].place->line == line);
  for (const std::string& part : parts) CHECK_THAT(errors[0].message, Contains(part));
}

}  // namespace

TEST_CASE("An empty file is a machine with nothing connected and every default", "[CFG-1]") {
  CHECK(parse_machine_config("", "cnc.ini").value() == MachineConfig{});
}

TEST_CASE("Every kind of value is read into its member", "[CFG-1][CFG-2]") {
  const auto config = parse_machine_config(kGoodX +
                                               "visible = 1\nbacklash=0.02\nhomeVelocity = -20\n"
                                               "homePosition = -2.5\n"
                                               "[CONNECTION]\nmaxStepFrequency = 50000\n"
                                               "[SPINDLE_0]\nspindleNmax = 18000\n"
                                               "[SAFETY]\nhomingMandatory = 0\n",
                                           "cnc.ini")
                          .value();
  const AxisConfig expected{.visible = true,
                            .port = 1,
                            .steps_per_unit = 200,
                            .negative_limit = 0,
                            .positive_limit = 600,
                            .velocity = 100,
                            .acceleration = 500,
                            .backlash = 0.02,
                            .home_velocity = -20,
                            .home_position = -2.5};
  CHECK(config.axes[Axis::X] == expected);
  CHECK(config.axes[Axis::Y] == AxisConfig{});
  CHECK(config.connection.max_step_frequency == 50'000);
  CHECK(config.spindle.max_speed == 18'000);
  CHECK_FALSE(config.safety.homing_mandatory);
}

TEST_CASE("Comments, blanks, a byte order mark and Windows line ends change nothing", "[CFG-1]") {
  const std::string text =
      "\xEF\xBB\xBF; head\r\n# head\r\n\r\n [ TRAJECTORY ] ; section\r\n"
      "\tfifoTime\t=\t0.5 ; half a second\r\nlafAngle=2#two";
  const auto config = parse_machine_config(text, "cnc.ini").value();
  CHECK(config.trajectory.fifo_time == 0.5);
  CHECK(config.trajectory.laf_angle == 2.0);
}

TEST_CASE("A line that is neither section nor key is refused", "[CFG-1]") {
  check_refusal("\n[TRAJECTORY\n", ErrorCode::config_bad_line, 2, {"\"[TRAJECTORY\"", "[SECTION]"});
  check_refusal("[]\n", ErrorCode::config_bad_line, 1, {"\"[]\""});
  check_refusal("[TRAJECTORY]\nfifoTime 0.5\n", ErrorCode::config_bad_line, 2,
                {"\"fifoTime 0.5\"", "key = value"});
  check_refusal("[TRAJECTORY]\n= 0.5\n", ErrorCode::config_bad_line, 2, {"\"= 0.5\""});
  check_refusal("fifoTime = 0.5\n", ErrorCode::config_bad_line, 1, {"before any key"});
}

TEST_CASE("A misspelt name is refused with the nearest known one", "[CFG-1]") {
  check_refusal("[TRAJECTRY]\nfifoTime = 1\n", ErrorCode::config_unknown_section, 1,
                {"\"TRAJECTRY\"", "[TRAJECTORY]"});
  check_refusal("[TRAJECTORY]\n\nfifotime = 1\n", ErrorCode::config_unknown_key, 3,
                {"[TRAJECTORY]", "\"fifotime\"", "\"fifoTime\""});
}

TEST_CASE("A setting that stands twice is refused with both lines", "[CFG-1]") {
  check_refusal("[TRAJECTORY]\nfifoTime = 1\n[TRAJECTORY]\nfifoTime = 1\n",
                ErrorCode::config_duplicate_key, 4, {"fifoTime", "line 2"});
}

TEST_CASE("A value that is not of its type is refused with what is allowed", "[CFG-1]") {
  check_refusal("[TRAJECTORY]\nfifoTime = fast\n", ErrorCode::config_bad_value, 2,
                {"[TRAJECTORY] fifoTime", "\"fast\"", "a number from 0.05 to 2 s"});
  check_refusal("[TRAJECTORY]\nfifoTime =\n", ErrorCode::config_bad_value, 2, {"\"\""});
  check_refusal("[TRAJECTORY]\nfifoTime = 0,5\n", ErrorCode::config_bad_value, 2, {"\"0,5\""});
  check_refusal("[AXIS_X]\nport = 1.5\n", ErrorCode::config_bad_value, 2, {"whole number"});
  check_refusal("[AXIS_X]\nvisible = yes\n", ErrorCode::config_bad_value, 2, {"0 or 1"});
  check_refusal("[USERINTERFACE]\nmachineUnit = cm\n", ErrorCode::config_bad_value, 2,
                {"one of mm, inch"});
  check_refusal("[CONNECTION]\nmaxStepFrequency = 90000\n", ErrorCode::config_bad_value, 2,
                {"25000, 50000, 100000, 125000, 200000, 400000"});
}

TEST_CASE("A value out of its range is refused with the range", "[CFG-1]") {
  check_refusal("[TRAJECTORY]\ninterpolationTime = 0.001\n", ErrorCode::config_value_out_of_range,
                2, {"\"0.001\"", "0.0025 to 0.1 s"});
  check_refusal("[AXIS_X]\nport = 7\n", ErrorCode::config_value_out_of_range, 2, {"0 to 6"});
  check_refusal("[AXIS_X]\nvelocity = 0\n", ErrorCode::config_value_out_of_range, 2, {"0.001"});
  check_refusal("[AXIS_X]\nacceleration = -1\n", ErrorCode::config_value_out_of_range, 2,
                {"\"-1\""});
}

TEST_CASE("Every error of a file is reported at once, in the order of the lines", "[CFG-1]") {
  const Errors errors = refusals(
      "[AXIS_X]\n"
      "velocty = 1\n"
      "port = 9\n"
      "[NOWHERE]\n"
      "nothing at all\n"
      "[JOB]\n"
      "autoToolChange = maybe\n");
  std::vector<std::uint32_t> lines;
  for (const Error& error : errors) lines.push_back(error.place.value().line);
  CHECK(lines == std::vector<std::uint32_t>{2, 3, 4, 5, 7});
}

TEST_CASE("The number of reported errors is bounded", "[CFG-1]") {
  std::string text = "[JOB]\n";
  for (int i = 0; i < 10'000; ++i) text += "rubbish\n";
  CHECK(refusals(text).size() == kMaxIniErrors);
}

TEST_CASE("The column of an error is that of the value", "[CFG-1]") {
  CHECK(refusals("[AXIS_X]\n  port =  9 ; too many\n")[0].place == TextPlace{"cnc.ini", 2, 11});
}

TEST_CASE("A connected axis must say what it is", "[CFG-2]") {
  const Errors errors = refusals("[AXIS_Y]\nport = 2\nvelocity = 10\n");
  REQUIRE(errors.size() == 4);
  const std::vector<std::string> keys{"stepsPerUnit", "positiveLimit", "negativeLimit",
                                      "acceleration"};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    CHECK(errors[i].code == ErrorCode::config_missing_key);
    CHECK(errors[i].place.value().line == 2);  // where the axis is connected
    CHECK_THAT(errors[i].message, Contains("[AXIS_Y] " + keys[i]));
  }
}

TEST_CASE("Rules between settings name both settings and their values", "[CFG-2]") {
  const auto with = [](std::string key, const std::string& value) {
    std::string text = kGoodX;
    const auto line = text.find(key + " = ");
    if (line == std::string::npos) return text + key + " = " + value + "\n";
    const auto from = line + key.size() + 3;
    return text.replace(from, text.find('\n', from) - from, value);
  };
  check_refusal(with("negativeLimit", "600"), ErrorCode::config_limits_reversed, 4,
                {"negativeLimit = 600 mm", "positiveLimit = 600 mm"});
  check_refusal(with("stepsPerUnit", "0"), ErrorCode::config_steps_zero, 3, {"stepsPerUnit = 0"});
  check_refusal(with("homeVelocity", "-100.5"), ErrorCode::config_home_velocity_too_high, 8,
                {"homeVelocity = -100.5 mm/s", "velocity = 100 mm/s"});
  // Travel is 600: a switch at -600 may be, one at -601 may not.
  CHECK(parse_machine_config(with("homePosition", "-600"), "cnc.ini"));
  check_refusal(with("homePosition", "-601"), ErrorCode::config_home_position_far, 8,
                {"homePosition = -601 mm"});
  check_refusal(kGoodX + "[TRAJECTORY]\ninterpolationTime = 0.1\nfifoTime = 0.399\n",
                ErrorCode::config_fifo_time_too_short, 10, {"0.399 s", "4 times", "0.1 s"});
  check_refusal("[SPINDLE_0]\nspindleNmax = 500\nspindleNmin = 501\n",
                ErrorCode::config_spindle_range, 3, {"501 rpm", "500 rpm"});
}

TEST_CASE("A speed that would exceed the step frequency is refused", "[LNK-3]") {
  // 100 mm/s * 1250 steps/mm = 125000 Hz, the default maximum; the sign only reverses the motor.
  const auto at = [](const std::string& steps) {
    return "[AXIS_X]\nport = 1\nnegativeLimit = 0\npositiveLimit = 600\nvelocity = 100\n"
           "acceleration = 500\nstepsPerUnit = " +
           steps + "\n";
  };
  CHECK(parse_machine_config(at("1250"), "cnc.ini"));
  CHECK(parse_machine_config(at("-1250"), "cnc.ini"));
  for (const char* steps : {"1250.01", "-1250.01"}) {
    check_refusal(at(steps), ErrorCode::config_step_frequency_too_high, 5,
                  {"[AXIS_X] velocity = 100 mm/s", std::string("[AXIS_X] stepsPerUnit = ") + steps,
                   "125001 steps per second", "[CONNECTION] maxStepFrequency = 125000 Hz"});
  }
  CHECK(parse_machine_config(at("1250.01") + "[CONNECTION]\nmaxStepFrequency = 200000\n", "c"));
}

TEST_CASE("Two axes on one port are refused; axes without a port are free", "[CFG-2]") {
  std::string y = kGoodX;
  y.replace(y.find("AXIS_X"), 6, "AXIS_Y");
  check_refusal(kGoodX + y, ErrorCode::config_port_used_twice, 9,
                {"[AXIS_Y] port = 1", "axis X already"});
  y.replace(y.find("port = 1"), 8, "port = 0");
  CHECK(parse_machine_config(kGoodX + y, "cnc.ini"));
}

TEST_CASE("Rules do not bind an axis that is not connected", "[CFG-2]") {
  CHECK(parse_machine_config("[AXIS_B]\nnegativeLimit = 5\npositiveLimit = -5\n", "cnc.ini"));
}

TEST_CASE("The machine unit holds for the whole file, wherever it stands", "[CFG-4]") {
  const std::string unit = "[USERINTERFACE]\nmachineUnit = inch\n";
  const std::string axis =
      "[AXIS_X]\nport=1\nstepsPerUnit=5080\nnegativeLimit=0\npositiveLimit=10\nvelocity=4\n"
      "acceleration=20\n";
  const auto before = parse_machine_config(unit + axis, "cnc.ini").value();
  const auto after = parse_machine_config(axis + unit, "cnc.ini").value();
  CHECK(before == after);
  CHECK(before.axes[Axis::X].positive_limit == 254.0);
  CHECK(before.axes[Axis::X].steps_per_unit == Approx(200.0));
}

TEST_CASE("An override stands in the place of the file's value", "[CFG-1]") {
  const std::vector<std::string> overrides{"AXIS_X.velocity=80", "JOB.autoToolChange = 1",
                                           "AXIS_X.velocity=90"};
  const auto config = parse_machine_config(kGoodX, "cnc.ini", overrides).value();
  CHECK(config.axes[Axis::X].velocity == 90.0);
  CHECK(config.job.auto_tool_change);
}

TEST_CASE("An override can mend a wrong value of the file", "[CFG-1]") {
  const std::vector<std::string> overrides{"AXIS_X.port=1"};
  CHECK(
      parse_machine_config("[AXIS_X]\nport = 9\nstepsPerUnit=1\nnegativeLimit=0\n"
                           "positiveLimit=1\nvelocity=1\nacceleration=1\n",
                           "cnc.ini", overrides));
}

TEST_CASE("A wrong override is refused and names what it was", "[CFG-1]") {
  const auto one = [](const std::string& text) {
    const Errors errors = refusals(kGoodX, {text});
    REQUIRE(errors.size() == 1);
    return errors[0];
  };
  CHECK(one("AXIS_X.velocity").code == ErrorCode::config_bad_line);
  CHECK(one("velocity=1").code == ErrorCode::config_bad_line);
  CHECK(one("AXIS_W.velocity=1").code == ErrorCode::config_unknown_section);
  CHECK_THAT(one("AXIS_X.velocty=1").message, Contains("\"velocity\""));
  CHECK_THAT(one("AXIS_X.velocity=x").message, Contains("[AXIS_X] velocity") && Contains("\"x\""));
  CHECK(one("AXIS_X.velocity=1000").code == ErrorCode::config_step_frequency_too_high);
}

TEST_CASE("Changes to a running configuration are taken all or none", "[CFG-1]") {
  const auto config = parse_machine_config(kGoodX, "cnc.ini").value();
  // The limits cross on the way from one pair to the other; only the end result counts.
  const std::vector<std::string> both{"AXIS_X.negativeLimit=700", "AXIS_X.positiveLimit=900",
                                      "AXIS_X.homePosition=700"};
  const auto changed = apply_settings(config, both).value();
  CHECK(changed.axes[Axis::X].negative_limit == 700.0);
  CHECK(changed.axes[Axis::X].acceleration == 500.0);

  const std::vector<std::string> one_wrong{"AXIS_X.velocity=50", "AXIS_X.acceleration=0"};
  const auto refused = apply_settings(config, one_wrong);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().size() == 1);
  CHECK_FALSE(refused.error()[0].place);
}

TEST_CASE("A change of the machine unit moves nothing; lengths changed with it are in it",
          "[CFG-4]") {
  const auto config = parse_machine_config(kGoodX, "cnc.ini").value();
  const std::vector<std::string> changes{"AXIS_X.velocity=2", "USERINTERFACE.machineUnit=inch"};
  const auto changed = apply_settings(config, changes).value();
  CHECK(changed.unit == MachineUnit::inch);
  CHECK(changed.axes[Axis::X].positive_limit == 600.0);
  CHECK(changed.axes[Axis::X].velocity == 50.8);
}

TEST_CASE("An axis that is connected later must be known by then", "[CFG-2]") {
  const auto config = parse_machine_config(kGoodX, "cnc.ini").value();
  const std::vector<std::string> connect{"AXIS_Y.port=2"};
  const auto refused = apply_settings(config, connect);
  REQUIRE_FALSE(refused);
  CHECK(refused.error()[0].code == ErrorCode::config_missing_key);
}

TEST_CASE("Files that cannot be read are one error", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  const auto refused = load_machine_config(directory.file("none.ini"));
  REQUIRE_FALSE(refused);
  REQUIRE(refused.error().size() == 1);
  CHECK(refused.error()[0].code == ErrorCode::file_not_found);
}

TEST_CASE("A text may stand in quotes, and has none inside", "[CFG-1][LNK-1]") {
  const auto board = [](const std::string& value) {
    return parse_machine_config("[CONNECTION]\nboard = " + value + "\n", "cnc.ini")
        .value()
        .connection.board;
  };
  CHECK(board("auto ; asks around") == "auto");
  CHECK(board("\"auto ; asks around\"") == "auto ; asks around");
  CHECK(board("\"a#b\"   # the comment") == "a#b");
  CHECK(board("\"\"") == "");
  check_refusal("[CONNECTION]\nboard = \"auto\n", ErrorCode::config_bad_value, 2,
                {"[CONNECTION] board", "a text of at most 200 bytes"});
  check_refusal("[CONNECTION]\nboard = a\"b\n", ErrorCode::config_bad_value, 2, {"board"});
  check_refusal("[CONNECTION]\nboard = " + std::string(201, 'a') + "\n",
                ErrorCode::config_value_out_of_range, 2, {"board"});
}

TEST_CASE("A silent host is missed while the board still has a way to brake", "[CFG-1][LNK-4]") {
  CHECK(parse_machine_config("[CONNECTION]\nhostTimeout = 5.11\n", "cnc.ini"));
  check_refusal("[CONNECTION]\nhostTimeout = 5.12\n", ErrorCode::config_host_timeout_too_long, 2,
                {"less than 5.12 s", "interpolationTime = 0.005"});
}

TEST_CASE("A caution says which axis a board that hears nothing could not brake along its motion",
          "[CFG-1][LNK-4][safety]") {
  struct Row {
    const char* rule;
    std::vector<std::string> settings;
    std::vector<std::string> caution{};  // parts of the message; none: no caution
  };
  // X makes 100 mm/s; 1024 segments of 2.5 ms are 2.56 s.
  static const Row kRows[]{
      {"2.06 s of silence and 0.5 s to brake",
       {"AXIS_X.acceleration=200", "CONNECTION.hostTimeout=2.06",
        "TRAJECTORY.interpolationTime=0.0025"}},
      {"that is more than 2.56 s",
       {"AXIS_X.acceleration=200", "CONNECTION.hostTimeout=2.07",
        "TRAJECTORY.interpolationTime=0.0025"},
       {"[AXIS_X] velocity = 100 mm/s", "acceleration = 200 mm/s²", "2.570 s", "holds 2.56 s",
        "the acceleration or interpolationTime should be higher, or the velocity or hostTimeout "
        "lower"}},
      {"a limit of jerk adds 200 / 4000 s",
       {"AXIS_X.acceleration=200", "AXIS_X.jerk=4000", "CONNECTION.hostTimeout=2.06",
        "TRAJECTORY.interpolationTime=0.0025"},
       {"2.610 s", "0.550 s to brake"}},
      // Below a²/j = 4000 mm/s the acceleration is never reached: 2 sqrt(100 / 10).
      {"or all of the ramp",
       {"AXIS_X.acceleration=200", "AXIS_X.jerk=10"},
       {"6.525 s", "6.325 s to brake", "holds 5.12 s"}},
      {"an axis without a motor brakes nothing",
       {"AXIS_X.port=0", "AXIS_X.acceleration=1", "CONNECTION.hostTimeout=0.2"}},
  };
  for (const Row& row : kRows) {
    INFO(row.rule);
    const auto config = parse_machine_config(kGoodX, "cnc.ini", row.settings);
    REQUIRE(config);
    const std::vector<Error> cautions = find_cautions(*config);
    REQUIRE(cautions.size() == (row.caution.empty() ? 0 : 1));
    if (cautions.empty()) continue;
    CHECK(cautions[0].code == ErrorCode::config_way_to_brake_short);
    for (const std::string& part : row.caution) CHECK_THAT(cautions[0].message, Contains(part));
  }
}

TEST_CASE("A pulse and its pause fit into a period of the highest step frequency",
          "[CFG-1][LNK-3]") {
  // 1 % above 400 kHz a period is 2.475 µs, two times 1.2376.
  const std::string fast = "[CONNECTION]\nmaxStepFrequency = 400000\npulseWidth = ";
  CHECK(parse_machine_config(fast + "1.23\n", "cnc.ini"));
  check_refusal(fast + "1.24\n", ErrorCode::config_pulse_too_wide, 3, {"1.24 µs", "1.23 µs"});
}

TEST_CASE("Guard rules of the I/O cards are read by card and rule, and garbage in them is named",
          "[CFG-16]") {
  const auto config = parse_machine_config(kGoodX +
                                               "[GPIO_RULES]\n"
                                               "card_1_rule_1_text = \"Vacuum; too low\"\n"
                                               "card_1_rule_1_inputParticipantBits = 3\n"
                                               "card_1_rule_1_inputCompareBits = 1\n"
                                               "card_1_rule_1_action = 2\n"
                                               "card_3_rule_8_inputParticipantBits = 255\n"
                                               "card_3_rule_8_action = 3\n",
                                           "cnc.ini");
  REQUIRE(config);
  CHECK(config->guards[0] == GuardRule{"Vacuum; too low", 3, 1, GuardAction::smooth_stop});
  CHECK(config->guards[23] == GuardRule{"", 255, 0, GuardAction::quick_stop});
  CHECK(config->guards[1] == GuardRule{});
  for (const std::string bad :
       {"card_1_rule_1_action = 4", "card_2_rule_3_action = stop", "card_1_rule_1_action = 1.5",
        "card_1_rule_2_inputParticipantBits = 256", "card_1_rule_2_inputCompareBits = -1"}) {
    const Errors errors = refusals(kGoodX + "[GPIO_RULES]\n" + bad + "\n");
    REQUIRE(errors.size() == 1);
    CHECK_THAT(errors.front().to_string(), Contains(bad.substr(0, bad.find(' '))));
  }
}
