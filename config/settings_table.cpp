// The rows of the settings table. The settings of an axis are written once and stand in the table
// six times, with the units of a rotary axis for A, B and C; those of rotary axes three times.
#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "config/schema.h"

namespace cnc::config {
namespace {

using enum SettingType;
using enum SettingUnit;

template <typename Field>
SettingValue value_of(const Field& field) {
  if constexpr (std::is_same_v<Field, std::string>) {
    return field;
  } else {
    return static_cast<double>(field);
  }
}

template <typename Field>
void assign_field(Field& field, const SettingValue& value) {
  if constexpr (std::is_same_v<Field, std::string>) {
    field = std::get<std::string>(value);
  } else {
    field = static_cast<Field>(std::get<double>(value));
  }
}

/// A member of an axis.
template <auto Member>
constexpr SettingAccess kOfAxis{
    [](const MachineConfig& config, Axis axis) { return value_of(config.axes[axis].*Member); },
    [](MachineConfig& config, Axis axis, const SettingValue& value) {
      assign_field(config.axes[axis].*Member, value);
    }};

/// A member of one of the groups of the machine.
template <auto Group, auto Member>
constexpr SettingAccess kOf{
    [](const MachineConfig& config, Axis) { return value_of((config.*Group).*Member); },
    [](MachineConfig& config, Axis, const SettingValue& value) {
      assign_field((config.*Group).*Member, value);
    }};

/// A member of the machine itself.
template <auto Member>
constexpr SettingAccess kOfMachine{
    [](const MachineConfig& config, Axis) { return value_of(config.*Member); },
    [](MachineConfig& config, Axis, const SettingValue& value) {
      assign_field(config.*Member, value);
    }};

constexpr std::array kUnitChoices{
    Choice{"mm", static_cast<double>(MachineUnit::millimetre)},
    Choice{"inch", static_cast<double>(MachineUnit::inch)},
};

constexpr std::array kDialectChoices{
    Choice{"eding", static_cast<double>(ProgramDialect::eding)},
    Choice{"pscnc", static_cast<double>(ProgramDialect::pscnc)},
};

constexpr std::array kModeChoices{
    Choice{"rot", static_cast<double>(AxisMode::axis)},
    Choice{"slaveX", static_cast<double>(AxisMode::slave_x)},
    Choice{"slaveY", static_cast<double>(AxisMode::slave_y)},
    Choice{"slaveZ", static_cast<double>(AxisMode::slave_z)},
    Choice{"mill4", static_cast<double>(AxisMode::mill)},  // the last: of A only
};

constexpr std::array kStepFrequencyChoices{
    Choice{"25000", 25'000},   Choice{"50000", 50'000},   Choice{"100000", 100'000},
    Choice{"125000", 125'000}, Choice{"200000", 200'000}, Choice{"400000", 400'000},
};

// Bounds catch a slip of the hand (a missing point, a wrong unit), not a bold machine.
constexpr double kFarthest = 1'000'000.0;
constexpr double kFastest = 10'000.0;

// clang-format off
constexpr std::array kGeneralRows{
    Setting{.section = "USERINTERFACE", .key = "machineUnit", .type = choice, .choices = kUnitChoices,
            .help = "Unit of every length in this file and of the machine's screens; a program chooses its own with G20 and G21.",
            .access = kOfMachine<&MachineConfig::unit>},
    Setting{.section = "CONNECTION", .key = "board", .type = text, .max = 200,
            .help = "The controller board: virtual, auto (asks around), udp:172.22.2.100:5005 or serial:/dev/ttyACM0; a line with wires may name its baud rate, serial:/dev/ttyUSB0@3000000. It runs at 2000000 otherwise, and auto asks at that rate only.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::board>},
    Setting{.section = "CONNECTION", .key = "localAddress", .type = text, .max = 200,
            .help = "Address of this computer from which the board is reached by UDP: 172.22.2.101, or with a port 172.22.2.101:5006; auto: whatever leads to the board, and any free port. The server waits until the computer has that address.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::local_address>},
    Setting{.section = "CONNECTION", .key = "hostTimeout", .unit = second, .min = 0.02, .max = 10,
            .help = "A board that has not heard the server for so long stops the machine along its path; hostTimeout and velocity / acceleration of each axis should fit into 1024 times interpolationTime.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::host_timeout>},
    Setting{.section = "CONNECTION", .key = "maxStepFrequency", .type = choice, .unit = hertz, .choices = kStepFrequencyChoices,
            .help = "Highest step frequency that the board sends to a drive; lower it for drives that cannot follow.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::max_step_frequency>},
    Setting{.section = "CONNECTION", .key = "pulseWidth", .unit = microsecond, .min = 0.1, .max = 20,
            .help = "Length of a step pulse, from the drive's data sheet; the pause behind it is as long at least.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::pulse_width>},
    Setting{.section = "CONNECTION", .key = "directionSetup", .unit = microsecond, .min = 0, .max = 40,
            .help = "A direction signal changes at least so long before the next step pulse.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::direction_setup>},
    Setting{.section = "CONNECTION", .key = "directionHold", .unit = microsecond, .min = 0, .max = 40,
            .help = "A direction signal stays at least so long after the beginning of a step pulse.",
            .access = kOf<&MachineConfig::connection, &ConnectionConfig::direction_hold>},
};

constexpr std::array kAxisRows{
    Setting{.key = "visible", .type = toggle,
            .help = "Show the axis on the screens; a connected axis that is not visible can still be used by a program.",
            .access = kOfAxis<&AxisConfig::visible>},
    Setting{.key = "port", .type = integer, .min = 0, .max = 6,
            .help = "Output port of the board that drives the motor; 0 when there is none.",
            .access = kOfAxis<&AxisConfig::port>},
    Setting{.key = "stepsPerUnit", .unit = steps_per_length, .min = -kFarthest, .max = kFarthest,
            .help = "Steps of the motor for one unit of travel; a negative number reverses the motor.",
            .access = kOfAxis<&AxisConfig::steps_per_unit>, .required_when_connected = true},
    Setting{.key = "stepActiveLow", .type = toggle,
            .help = "A step pulse is low; for a drive that is wired so.",
            .access = kOfAxis<&AxisConfig::step_active_low>},
    Setting{.key = "directionActiveLow", .type = toggle,
            .help = "The direction signal is low for upwards; to reverse a motor make stepsPerUnit negative instead.",
            .access = kOfAxis<&AxisConfig::direction_active_low>},
    Setting{.key = "positiveLimit", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Highest machine position that the axis may take.",
            .access = kOfAxis<&AxisConfig::positive_limit>, .required_when_connected = true},
    Setting{.key = "negativeLimit", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Lowest machine position that the axis may take.",
            .access = kOfAxis<&AxisConfig::negative_limit>, .required_when_connected = true},
    Setting{.key = "velocity", .unit = length_per_second, .min = 0.001, .max = kFastest,
            .help = "Highest velocity of the axis in any motion.",
            .access = kOfAxis<&AxisConfig::velocity>, .required_when_connected = true},
    Setting{.key = "acceleration", .unit = length_per_second2, .min = 0.001, .max = 1'000'000.0,
            .help = "Highest acceleration of the axis in any motion.",
            .access = kOfAxis<&AxisConfig::acceleration>, .required_when_connected = true},
    Setting{.key = "jerk", .unit = length_per_second3, .min = 0, .max = 1e9,
            .help = "Highest jerk of the axis, how fast its acceleration may change; 0: no limit. With a limit on any axis all motion is planned softly.",
            .access = kOfAxis<&AxisConfig::jerk>},
    Setting{.key = "backlash", .unit = length, .min = 0, .max = 10,
            .help = "Play between motor and axis that is made up for at every reversal; above 0.1 mm mend the machine first.",
            .access = kOfAxis<&AxisConfig::backlash>},
    Setting{.key = "pitchCompensationOn", .type = toggle,
            .help = "Correct the motor by its table, a file beside this one: Joint-X-pitchCompTable.txt with the axis' letter.",
            .access = kOfAxis<&AxisConfig::pitch_compensation>},
    Setting{.key = "homeVelocity", .unit = length_per_second, .min = -kFastest, .max = kFastest,
            .help = "Velocity of the search for the home switch; its sign is the direction, 0 means that the axis is homed by hand.",
            .access = kOfAxis<&AxisConfig::home_velocity>},
    Setting{.key = "homePosition", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Machine position at the edge of the home switch; it may lie outside of the limits.",
            .access = kOfAxis<&AxisConfig::home_position>},
};

constexpr std::array kRotaryRows{
    Setting{.key = "mode", .type = choice, .choices = kModeChoices,
            .help = "rot: a rotary axis; slaveX, slaveY or slaveZ: a second motor of that axis (gantry), whose lengths are mm where degrees are written; mill4 (A only): A turns the work piece about work Y0 Z0, and F is the speed of the tool's tip on it.",
            .access = kOfAxis<&AxisConfig::mode>},
};

constexpr std::array kMotionRows{
    Setting{.section = "TRAJECTORY", .key = "interpolationTime", .unit = second, .min = 0.0025, .max = 0.1,
            .help = "Duration of one motion segment sent to the board.",
            .access = kOf<&MachineConfig::trajectory, &TrajectoryConfig::interpolation_time>},
    Setting{.section = "TRAJECTORY", .key = "fifoTime", .unit = second, .min = 0.05, .max = 2,
            .help = "Motion that the board holds ready at least, so that a busy computer does not stop the machine. While the axes are fast it holds what it needs to brake should it hear nothing, hostTimeout and velocity / acceleration.",
            .access = kOf<&MachineConfig::trajectory, &TrajectoryConfig::fifo_time>},
    Setting{.section = "TRAJECTORY", .key = "lafAngle", .unit = degree, .min = 0, .max = 180,
            .help = "Corners flatter than this are passed without stopping; 0.1 to 3 is generally safe.",
            .access = kOf<&MachineConfig::trajectory, &TrajectoryConfig::laf_angle>},
    Setting{.section = "TRAJECTORY", .key = "pathTolerance", .unit = length, .min = 0.0001, .max = 10,
            .help = "How far the path may leave the programmed one after a G64 without P.",
            .access = kOf<&MachineConfig::trajectory, &TrajectoryConfig::path_tolerance>},
    Setting{.section = "TRAJECTORY", .key = "toleranceUse", .min = 0, .max = 1,
            .help = "Part of the G64 tolerance that the path uses on average: 1 is fastest, with less the path stays nearer to the programmed one.",
            .access = kOf<&MachineConfig::trajectory, &TrajectoryConfig::tolerance_use>},
    Setting{.section = "TRAJECTORY", .key = "backlashShare", .min = 0.05, .max = 0.5,
            .help = "Part of the velocity and acceleration of an axis with backlash that is kept for taking up its play.",
            .access = kOf<&MachineConfig::trajectory, &TrajectoryConfig::backlash_share>},
    Setting{.section = "SPINDLE_0", .key = "spindleNmax", .unit = rpm, .min = 1, .max = 1'000'000,
            .help = "Speed of the spindle when the PWM signal is at 100 %.",
            .access = kOf<&MachineConfig::spindle, &SpindleConfig::max_speed>},
    Setting{.section = "SPINDLE_0", .key = "spindleNmin", .unit = rpm, .min = 0, .max = 1'000'000,
            .help = "Lowest speed of the spindle; a lower S is raised to it.",
            .access = kOf<&MachineConfig::spindle, &SpindleConfig::min_speed>},
    Setting{.section = "SPINDLE_0", .key = "spindleRampUpTime", .unit = second, .min = 0, .max = 120,
            .help = "Wait between switching the spindle on and going on with the program.",
            .access = kOf<&MachineConfig::spindle, &SpindleConfig::ramp_up_time>},
    Setting{.section = "SAFETY", .key = "homingMandatory", .type = toggle,
            .help = "No job and no MDI before the machine is homed, because its limits do not guard it until then.",
            .access = kOf<&MachineConfig::safety, &SafetyConfig::homing_mandatory>},
    Setting{.section = "SAFETY", .key = "homeSensorIsEstop", .type = toggle,
            .help = "After homing, a home switch that becomes active is an emergency stop; mount the switches outside of the limits.",
            .access = kOf<&MachineConfig::safety, &SafetyConfig::home_sensor_is_estop>},
    Setting{.section = "SAFETY", .key = "drivesHoldPosition", .type = toggle,
            .help = "The drives know where their motors are although they are switched off and the shafts are turned (encoders). Otherwise the position of every axis is doubtful behind an emergency stop, M81 or whatever else switches the drives off.",
            .access = kOf<&MachineConfig::safety, &SafetyConfig::drives_hold_position>},
    Setting{.section = "SAFETY", .key = "shutDownOnFatal", .type = toggle,
            .help = "The server saves and ends when the connection to the controller board is lost, for machines whose power is switched off as a whole. Otherwise it waits for the board to come back.",
            .access = kOf<&MachineConfig::safety, &SafetyConfig::shut_down_on_fatal>},
    Setting{.section = "INTERPRETER", .key = "absoluteCenterCoords", .type = toggle,
            .help = "I, J and K of an arc are absolute coordinates instead of distances from its start.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::absolute_arc_centres>},
    Setting{.section = "INTERPRETER", .key = "blockDelete", .type = toggle,
            .help = "Skip the lines of a program that begin with a slash.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::block_delete>},
    Setting{.section = "INTERPRETER", .key = "dialect", .type = choice, .choices = kDialectChoices,
            .help = "Which G-code programs are written in: eding (RS274/NGC with the extensions of Eding CNC) or pscnc.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::dialect>},
    Setting{.section = "INTERPRETER", .key = "strict", .type = toggle,
            .help = "What the language does not allow is an error; off: what CAM systems often write is accepted with a warning.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::strict>},
    Setting{.section = "INTERPRETER", .key = "diameterProgramming", .type = toggle,
            .help = "X words of a turning program are diameters.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::diameter_programming>},
    Setting{.section = "INTERPRETER", .key = "frontToolPost", .type = toggle,
            .help = "A lathe whose X points towards the operator: left and right of cutter compensation and the sides of arcs in G18 are seen from there.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::front_tool_post>},
    Setting{.section = "INTERPRETER", .key = "is3DPrinter", .type = toggle,
            .help = "M1 switches the heaters off, and M codes that mean nothing to this machine are ignored.",
            .access = kOf<&MachineConfig::interpreter, &InterpreterConfig::is_3d_printer>},
    Setting{.section = "JOB", .key = "autoToolChange", .type = toggle,
            .help = "M6 calls the sub change_tool of the macro files and does not stop for the operator by itself.",
            .access = kOf<&MachineConfig::job, &JobConfig::auto_tool_change>},
    Setting{.section = "TOOLCHANGEAREA", .key = "xLow", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Lower end along X of the area that only a tool change may enter, machine coordinates; all ends 0: there is none.",
            .access = kOf<&MachineConfig::tool_change_area, &ToolChangeArea::x_low>},
    Setting{.section = "TOOLCHANGEAREA", .key = "xHigh", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Upper end along X of the area that only a tool change may enter, machine coordinates; all ends 0: there is none.",
            .access = kOf<&MachineConfig::tool_change_area, &ToolChangeArea::x_high>},
    Setting{.section = "TOOLCHANGEAREA", .key = "yLow", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Lower end along Y of the area that only a tool change may enter, machine coordinates; all ends 0: there is none.",
            .access = kOf<&MachineConfig::tool_change_area, &ToolChangeArea::y_low>},
    Setting{.section = "TOOLCHANGEAREA", .key = "yHigh", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Upper end along Y of the area that only a tool change may enter, machine coordinates; all ends 0: there is none.",
            .access = kOf<&MachineConfig::tool_change_area, &ToolChangeArea::y_high>},
    Setting{.section = "TOOLCHANGEAREA", .key = "zLow", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Lower end along Z of the area that only a tool change may enter, machine coordinates; all ends 0: there is none.",
            .access = kOf<&MachineConfig::tool_change_area, &ToolChangeArea::z_low>},
    Setting{.section = "TOOLCHANGEAREA", .key = "zHigh", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Upper end along Z of the area that only a tool change may enter, machine coordinates; all ends 0: there is none.",
            .access = kOf<&MachineConfig::tool_change_area, &ToolChangeArea::z_high>},
    Setting{.section = "SPINDLE_1", .key = "xOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along X from the first spindle to the second spindle (M91); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::spindle_1, &HeadOffset::x>},
    Setting{.section = "SPINDLE_1", .key = "yOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Y from the first spindle to the second spindle (M91); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::spindle_1, &HeadOffset::y>},
    Setting{.section = "SPINDLE_1", .key = "zOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Z from the first spindle to the second spindle (M91); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::spindle_1, &HeadOffset::z>},
    Setting{.section = "SPINDLE_2", .key = "xOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along X from the first spindle to the third spindle (M92); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::spindle_2, &HeadOffset::x>},
    Setting{.section = "SPINDLE_2", .key = "yOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Y from the first spindle to the third spindle (M92); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::spindle_2, &HeadOffset::y>},
    Setting{.section = "SPINDLE_2", .key = "zOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Z from the first spindle to the third spindle (M92); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::spindle_2, &HeadOffset::z>},
    Setting{.section = "PROBE", .key = "xOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along X from the first spindle to the probe (M95); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::probe, &HeadOffset::x>},
    Setting{.section = "PROBE", .key = "yOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Y from the first spindle to the probe (M95); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::probe, &HeadOffset::y>},
    Setting{.section = "PROBE", .key = "zOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Z from the first spindle to the probe (M95); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::probe, &HeadOffset::z>},
    Setting{.section = "CAMERA", .key = "xOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along X from the first spindle to the camera (M97); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::camera, &HeadOffset::x>},
    Setting{.section = "CAMERA", .key = "yOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Y from the first spindle to the camera (M97); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::camera, &HeadOffset::y>},
    Setting{.section = "CAMERA", .key = "zOffset", .unit = length, .min = -kFarthest, .max = kFarthest,
            .help = "Along Z from the first spindle to the camera (M97); measured with Q1 behind its M code.",
            .access = kOf<&MachineConfig::camera, &HeadOffset::z>},
};
// clang-format on

// --- guard rules: eight of each of three I/O cards
// ------------------------------------------------

/// "card_1_rule_1_inputParticipantBits"
struct GuardKey {
  std::array<char, 48> letters{};
  std::size_t size = 0;

  constexpr void add(std::string_view text) {
    for (const char letter : text) letters[size++] = letter;
  }
  [[nodiscard]] constexpr std::string_view text() const { return {letters.data(), size}; }
};

constexpr std::size_t kSettingsOfGuard = 4;
constexpr std::array<std::string_view, kSettingsOfGuard> kGuardKeys{"text", "inputParticipantBits",
                                                                    "inputCompareBits", "action"};

constexpr auto make_guard_names() {
  std::array<std::array<GuardKey, kSettingsOfGuard>, kGuardRules> names{};
  for (std::size_t rule = 0; rule < kGuardRules; ++rule) {
    const std::array<char, 2> digits{static_cast<char>('1' + rule / kRulesPerCard),
                                     static_cast<char>('1' + rule % kRulesPerCard)};
    for (std::size_t i = 0; i < kSettingsOfGuard; ++i) {
      GuardKey& name = names[rule][i];
      name.add("card_");
      name.add({&digits[0], 1});
      name.add("_rule_");
      name.add({&digits[1], 1});
      name.add("_");
      name.add(kGuardKeys[i]);
    }
  }
  return names;
}

constexpr auto kGuardNames = make_guard_names();

template <std::size_t Rule, auto Member>
constexpr SettingAccess kOfGuard{
    [](const MachineConfig& config, Axis) { return value_of(config.guards[Rule].*Member); },
    [](MachineConfig& config, Axis, const SettingValue& value) {
      assign_field(config.guards[Rule].*Member, value);
    }};

template <std::size_t Rule>
constexpr std::array<Setting, kSettingsOfGuard> guard_rows() {
  const auto& names = kGuardNames[Rule];
  return {Setting{.section = "GPIO_RULES",
                  .key = names[0].text(),
                  .type = text,
                  .max = 200,
                  .help = "What the operator is told when the rule acts.",
                  .access = kOfGuard<Rule, &GuardRule::text>},
          Setting{.section = "GPIO_RULES",
                  .key = names[1].text(),
                  .type = integer,
                  .max = 255,
                  .help = "Inputs of the card that take part, the sum of 1 for input 1, 2 for "
                          "input 2, 4 for input 3 to 128 for input 8; 0: the rule does nothing.",
                  .access = kOfGuard<Rule, &GuardRule::participants>},
          Setting{.section = "GPIO_RULES",
                  .key = names[2].text(),
                  .type = integer,
                  .max = 255,
                  .help = "Which of them have to be on, summed up like them; the others have to be "
                          "off. The rule acts when all are so.",
                  .access = kOfGuard<Rule, &GuardRule::compare>},
          Setting{.section = "GPIO_RULES",
                  .key = names[3].text(),
                  .type = integer,
                  .max = 3,
                  .help = "0: nothing; 1: a warning; 2: the board stops the machine along its "
                          "path; 3: at once, without a ramp, and axes that move may slip.",
                  .access = kOfGuard<Rule, &GuardRule::action>}};
}

template <std::size_t... kRules>
constexpr auto make_guard_rows(std::index_sequence<kRules...>) {
  std::array<Setting, kSettingsOfGuard * kGuardRules> rows{};
  auto out = rows.begin();
  ((out = std::ranges::copy(guard_rows<kRules>(), out).out), ...);
  return rows;
}

constexpr auto kGuardRows = make_guard_rows(std::make_index_sequence<kGuardRules>{});

constexpr AxisArray<std::string_view> kAxisSections{
    {"AXIS_X", "AXIS_Y", "AXIS_Z", "AXIS_A", "AXIS_B", "AXIS_C"}};

constexpr SettingUnit rotary_unit(SettingUnit unit) {
  switch (unit) {
    case length:
      return degree;
    case length_per_second:
      return degree_per_second;
    case length_per_second2:
      return degree_per_second2;
    case length_per_second3:
      return degree_per_second3;
    case steps_per_length:
      return steps_per_degree;
    case none:
    case degree:
    case degree_per_second:
    case degree_per_second2:
    case degree_per_second3:
    case steps_per_degree:
    case second:
    case microsecond:
    case rpm:
    case hertz:
      return unit;
  }
  return unit;
}

constexpr Setting for_axis(Setting row, Axis axis) {
  row.section = kAxisSections[axis];
  row.axis = axis;
  if (is_rotary(axis)) row.unit = rotary_unit(row.unit);
  if (row.type == choice && axis != Axis::A)
    row.choices = row.choices.first(row.choices.size() - 1);
  return row;
}

constexpr auto expanded_table() {
  std::array<Setting, kGeneralRows.size() + kAxisCount * kAxisRows.size() +
                          kRotaryAxes.size() * kRotaryRows.size() + kMotionRows.size() +
                          kGuardRows.size()>
      table{};
  auto out = std::ranges::copy(kGeneralRows, table.begin()).out;
  for (const Axis axis : kAllAxes) {
    for (const Setting& row : kAxisRows) *out++ = for_axis(row, axis);
    if (!is_rotary(axis)) continue;
    for (const Setting& row : kRotaryRows) *out++ = for_axis(row, axis);
  }
  out = std::ranges::copy(kMotionRows, out).out;
  std::ranges::copy(kGuardRows, out);
  return table;
}

constexpr auto kTable = expanded_table();

}  // namespace

std::span<const Setting> settings() { return kTable; }

std::string_view axis_section(Axis axis) { return kAxisSections[axis]; }

const Setting* find_setting(std::string_view section, std::string_view key) {
  const auto row = std::ranges::find_if(kTable, [section, key](const Setting& setting) {
    return setting.section == section && setting.key == key;
  });
  return row == kTable.end() ? nullptr : &*row;
}

}  // namespace cnc::config
