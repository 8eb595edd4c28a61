// text_of(): canonical commands in the names of NIST RS274/NGC. docs/canonical.md lists every line.
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/canonical.h"

namespace cnc::interp {
namespace {

/// Six decimals; never "-0.000000", which would differ between equal positions.
[[nodiscard]] std::string number(double value) {
  constexpr double kHalfOfLastDecimal = 0.5e-6;
  return fmt::format("{:.6f}", std::abs(value) < kHalfOfLastDecimal ? 0.0 : value);
}

[[nodiscard]] std::string numbers(const Position& position) {
  std::string text;
  for (const Axis axis : kAllAxes) {
    if (!text.empty()) text += ", ";
    text += number(position[axis]);
  }
  return text;
}

template <typename Enum, std::size_t size>
[[nodiscard]] std::string_view name_in(const std::array<std::string_view, size>& names,
                                       Enum value) {
  return names.at(static_cast<std::size_t>(value));
}

constexpr std::array<std::string_view, 3> kPlanes{"CANON_PLANE_XY", "CANON_PLANE_XZ",
                                                  "CANON_PLANE_YZ"};
constexpr std::array<std::string_view, 2> kUnits{"CANON_UNITS_MM", "CANON_UNITS_INCHES"};
constexpr std::array<std::string_view, 3> kFeedModes{"", ", INVERSE_TIME", ", PER_REVOLUTION"};
constexpr std::array<std::string_view, 3> kPathModes{"CANON_EXACT_PATH", "CANON_EXACT_STOP",
                                                     "CANON_CONTINUOUS"};
constexpr std::array<std::string_view, 3> kSpindle{
    "STOP_SPINDLE_TURNING()", "START_SPINDLE_CLOCKWISE()", "START_SPINDLE_COUNTERCLOCKWISE()"};
constexpr std::array<std::string_view, 3> kStops{"PROGRAM_STOP()", "OPTIONAL_PROGRAM_STOP()",
                                                 "PALLET_SHUTTLE()"};
constexpr std::array<std::string_view, 2> kOverrides{"FEED", "SPEED"};
constexpr std::array<std::string_view, 5> kHeads{"SPINDLE_0", "SPINDLE_1", "SPINDLE_2", "PROBE",
                                                 "CAMERA"};
constexpr std::array<std::string_view, 2> kSpindleOutputs{"DIRECTION", "PWM"};
constexpr std::array<std::string_view, 3> kWaits{"", ", HIGH", ", LOW"};
constexpr std::array<std::string_view, 2> kHeaters{"EXTRUDER", "BED"};
constexpr std::array<std::string_view, 2> kGuards{"MACHINE_AREA", "TOOL_CHANGE_AREA"};
constexpr std::array<std::string_view, 4> kHomeSteps{"HOME", "HOME_TANDEM", "PREPARE_TANDEM_HOME",
                                                     "MOVE_SLAVE_TO_MASTER"};
constexpr std::array<std::string_view, 8> kKnife{"OFF", "ON", "ON_90", "ON_-90",
                                                 "B",   "C",  "LOW",   "HIGH"};
constexpr std::array<std::string_view, 5> kHeightMap{"OFF", "ON", "INIT", "ADD_POINT", "STORE"};
constexpr std::array<std::string_view, 5> kMessages{"MESSAGE", "WARNING", "ERROR", "LOG",
                                                    "COMMENT"};

/// ", P0.050000" for a word that is set.
[[nodiscard]] std::string option(char letter, const std::optional<double>& value) {
  return value ? fmt::format(", {}{}", letter, number(*value)) : std::string();
}

[[nodiscard]] std::string_view on_off(bool on) { return on ? "ON" : "OFF"; }

struct Printer {
  std::string operator()(const RapidMove& c) const {
    return fmt::format("STRAIGHT_TRAVERSE({})", numbers(c.end));
  }
  std::string operator()(const FeedMove& c) const {
    return fmt::format("STRAIGHT_FEED({})", numbers(c.end));
  }
  std::string operator()(const ArcMove& c) const {
    const PlaneAxes axes = axes_of(c.plane);
    return fmt::format("ARC_FEED({}, {}, {}, {}, {}, {}, {}, {}, {})", number(c.end[axes.first]),
                       number(c.end[axes.second]), number(c.first_centre), number(c.second_centre),
                       c.turns, number(c.end[axes.third]), number(c.end[Axis::A]),
                       number(c.end[Axis::B]), number(c.end[Axis::C]));
  }
  std::string operator()(const ProbeMove& c) const {
    return fmt::format("STRAIGHT_PROBE({})", numbers(c.end));
  }
  std::string operator()(const SyncMove& c) const {
    return fmt::format("SPINDLE_SYNC_FEED({}, {})", numbers(c.end), number(c.pitch));
  }
  std::string operator()(const Dwell& c) const {
    return fmt::format("DWELL({})", number(c.duration));
  }
  std::string operator()(const SetFeedRate& c) const {
    return fmt::format("SET_FEED_RATE({}{})", number(c.feed), name_in(kFeedModes, c.mode));
  }
  std::string operator()(const SetPathMode& c) const {
    return fmt::format("SET_MOTION_CONTROL_MODE({}{}{}{})", name_in(kPathModes, c.mode),
                       option('P', c.tolerance), option('Q', c.simplification),
                       option('R', c.laf_angle));
  }
  std::string operator()(const SelectPlane& c) const {
    return fmt::format("SELECT_PLANE({})", name_in(kPlanes, c.plane));
  }
  std::string operator()(const UseLengthUnit& c) const {
    return fmt::format("USE_LENGTH_UNITS({})", name_in(kUnits, c.unit));
  }
  std::string operator()(const SetWorkOffset& c) const {
    return fmt::format("{}({}, {})", c.is_active ? "SET_ORIGIN_OFFSETS" : "STORE_ORIGIN_OFFSETS",
                       c.system, numbers(c.offset));
  }
  std::string operator()(const SetG92Offset& c) const {
    return fmt::format("SET_G92_OFFSETS({})", numbers(c.offset));
  }
  std::string operator()(const UseToolLength& c) const {
    return fmt::format("USE_TOOL_LENGTH_OFFSET({}, {})", number(c.z), number(c.x));
  }
  std::string operator()(const SetSpindleSpeed& c) const {
    return fmt::format("SET_SPINDLE_SPEED({})", number(c.speed));
  }
  std::string operator()(const UseSurfaceSpeed& c) const {
    return fmt::format("SET_SURFACE_SPEED({}{})", number(c.surface_speed),
                       option('D', c.max_speed));
  }
  std::string operator()(const OrientSpindle& c) const {
    return fmt::format("ORIENT_SPINDLE({})", number(c.angle));
  }
  std::string operator()(const TurnSpindle& c) const {
    return std::string(name_in(kSpindle, c.direction));
  }
  std::string operator()(const SetCoolant& c) const {
    return fmt::format("SET_COOLANT(MIST_{}, FLOOD_{})", on_off(c.mist), on_off(c.flood));
  }
  std::string operator()(const SelectTool& c) const {
    return fmt::format("SELECT_TOOL({})", c.tool);
  }
  std::string operator()(const ChangeTool& c) const {
    return fmt::format("CHANGE_TOOL({})", c.tool);
  }
  std::string operator()(const EnableOverrides& c) const {
    return fmt::format("ENABLE_OVERRIDES(FEED_{}, SPEED_{})", on_off(c.feed), on_off(c.speed));
  }
  std::string operator()(const ProgramStop& c) const {
    return std::string(name_in(kStops, c.kind));
  }
  std::string operator()(const ProgramEnd&) const { return "PROGRAM_END()"; }
  std::string operator()(const Message& c) const {
    return fmt::format("{}(\"{}\")", name_in(kMessages, c.kind), c.text);
  }
  std::string operator()(const SetOverride& c) const {
    return fmt::format("SET_OVERRIDE({}, {})", name_in(kOverrides, c.which),
                       c.factor ? number(*c.factor) : "KEEP");
  }
  std::string operator()(const UseOverrideInput& c) const {
    return fmt::format("USE_FEED_OVERRIDE_INPUT({})", on_off(c.on));
  }
  std::string operator()(const UseHoldInput& c) const {
    return fmt::format("USE_FEED_HOLD_INPUT({})", on_off(c.on));
  }
  std::string operator()(const SelectHead& c) const {
    return fmt::format("SELECT_HEAD({}, {})", name_in(kHeads, c.head), numbers(c.offset));
  }
  std::string operator()(const StoreHeadOffset& c) const {
    return fmt::format("STORE_HEAD_OFFSET({}, {})", name_in(kHeads, c.head), numbers(c.offset));
  }
  std::string operator()(const EnableDrives& c) const {
    return fmt::format("ENABLE_DRIVES({})", on_off(c.on));
  }
  std::string operator()(const SetOutput& c) const {
    return fmt::format("SET_OUTPUT({}, {})", c.port, on_off(c.on));
  }
  std::string operator()(const SetAnalogOutput& c) const {
    return fmt::format("SET_ANALOG_OUTPUT({}, {})", c.port, number(c.value));
  }
  std::string operator()(const ReadInput& c) const {
    if (c.analog) return fmt::format("READ_ANALOG_INPUT({})", c.port);
    if (c.wait == WaitForInput::no) return fmt::format("READ_INPUT({})", c.port);
    return fmt::format("READ_INPUT({}{}, {})", c.port, name_in(kWaits, c.wait), number(c.timeout));
  }
  std::string operator()(const SetSpindleOutput& c) const {
    return fmt::format("SET_SPINDLE_OUTPUT({}, {})", name_in(kSpindleOutputs, c.output),
                       on_off(c.on));
  }
  std::string operator()(const ClampAxis& c) const {
    return fmt::format("{}({}{})", c.on ? "CLAMP_AXIS" : "UNCLAMP_AXIS", axis_name(c.axis),
                       c.port ? fmt::format(", {}", *c.port) : "");
  }
  std::string operator()(const UseTorchHeight& c) const {
    return fmt::format("TORCH_HEIGHT_CONTROL({})", on_off(c.on));
  }
  std::string operator()(const SetTorchHeight& c) const {
    return fmt::format("SET_TORCH_HEIGHT({})", number(c.set_point));
  }
  std::string operator()(const SetTemperature& c) const {
    return fmt::format("SET_TEMPERATURE({}, {}{})", name_in(kHeaters, c.heater), number(c.celsius),
                       c.wait ? ", WAIT" : "");
  }
  std::string operator()(const SetTemperatureLimit& c) const {
    return fmt::format("SET_TEMPERATURE_LIMIT({})", number(c.celsius));
  }
  std::string operator()(const SetFan& c) const {
    return fmt::format("SET_FAN({})", number(c.power));
  }
  std::string operator()(const HeatersOff&) const { return "HEATERS_OFF()"; }
  std::string operator()(const ScaleAxis& c) const {
    return fmt::format("SCALE_AXIS({}, {})", axis_name(c.axis), number(c.factor));
  }
  std::string operator()(const AskOperator& c) const {
    std::string text = fmt::format("DIALOG(\"{}\"", c.dialog->title);
    for (const DialogField& field : c.dialog->fields) {
      text += fmt::format(", \"{}\", #{}={}", field.label, field.parameter, number(field.value));
    }
    return text + ")";
  }
  std::string operator()(const OpenLogFile& c) const {
    return fmt::format("LOG_OPEN(\"{}\"{})", c.name, c.append ? ", APPEND" : "");
  }
  std::string operator()(const StorePosition& c) const {
    return fmt::format("STORE_POSITION(\"{}\"{})", c.name, c.append ? ", APPEND" : "");
  }
  std::string operator()(const SetGuard& c) const {
    return fmt::format("GUARD({}, {})", name_in(kGuards, c.guard), on_off(c.on));
  }
  std::string operator()(const UseHomeSensorsAsEstop& c) const {
    return fmt::format("HOME_IS_ESTOP({})", on_off(c.on));
  }
  std::string operator()(const HomeAxis& c) const {
    return fmt::format("{}({})", name_in(kHomeSteps, c.step), axis_name(c.axis));
  }
  std::string operator()(const SetKnife& c) const {
    return fmt::format("TANGENTIAL_KNIFE({})", name_in(kKnife, c.command));
  }
  std::string operator()(const ChangeHeightMap& c) const {
    const std::string_view command = name_in(kHeightMap, c.command);
    if (c.command == HeightMapCommand::begin) {
      return fmt::format("HEIGHT_MAP({}, {}, {}, {})", command, number(c.grid_size), c.columns,
                         c.rows);
    }
    if (c.command != HeightMapCommand::store) return fmt::format("HEIGHT_MAP({})", command);
    return fmt::format("HEIGHT_MAP({}, \"{}\")", command, c.name);
  }
  std::string operator()(const Synchronise&) const { return "SYNCHRONISE()"; }
};

}  // namespace

bool waits_for_answer(const CommandBody& body) {
  return std::visit([]<typename Body>(const Body&) { return kWaitsForAnswer<Body>; }, body);
}

std::string text_of(const Command& command) { return std::visit(Printer{}, command.body); }

}  // namespace cnc::interp
