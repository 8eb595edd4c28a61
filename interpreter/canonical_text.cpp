// text_of(): canonical commands in the names of NIST RS274/NGC. docs/canonical.md lists every line.
#include <array>
#include <fmt/format.h>
#include <span>

#include "interpreter/canonical.h"
#include "interpreter/decimal_text.h"

namespace cnc::interp {
namespace {

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

[[nodiscard]] std::string_view on_off(bool on) { return on ? "ON" : "OFF"; }

/// ", P0.050000" for a word that is set.
struct Option {
  std::string_view letter;
  const std::optional<double>& value;
};

class Printer {
 public:
  explicit Printer(std::string& text) : text_(text) {}

  void operator()(const RapidMove& c) const { put("STRAIGHT_TRAVERSE(", c.end, ")"); }
  void operator()(const FeedMove& c) const { put("STRAIGHT_FEED(", c.end, ")"); }
  void operator()(const ArcMove& c) const {
    const PlaneAxes axes = axes_of(c.plane);
    const std::array before{c.end[axes.first], c.end[axes.second], c.first_centre, c.second_centre};
    const std::array behind{c.end[axes.third], c.end[Axis::A], c.end[Axis::B], c.end[Axis::C]};
    put("ARC_FEED(", std::span<const double>(before), ", ", c.turns, ", ",
        std::span<const double>(behind), ")");
  }
  void operator()(const ProbeMove& c) const { put("STRAIGHT_PROBE(", c.end, ")"); }
  void operator()(const SyncMove& c) const { put("SPINDLE_SYNC_FEED(", c.end, ", ", c.pitch, ")"); }
  void operator()(const Dwell& c) const { put("DWELL(", c.duration, ")"); }
  void operator()(const SetFeedRate& c) const {
    put("SET_FEED_RATE(", c.feed, name_in(kFeedModes, c.mode), ")");
  }
  void operator()(const SetPathMode& c) const {
    put("SET_MOTION_CONTROL_MODE(", name_in(kPathModes, c.mode), Option{", P", c.tolerance},
        Option{", Q", c.simplification}, Option{", R", c.laf_angle}, ")");
  }
  void operator()(const SelectPlane& c) const {
    put("SELECT_PLANE(", name_in(kPlanes, c.plane), ")");
  }
  void operator()(const UseLengthUnit& c) const {
    put("USE_LENGTH_UNITS(", name_in(kUnits, c.unit), ")");
  }
  void operator()(const SetWorkOffset& c) const {
    put(c.is_active ? "SET_ORIGIN_OFFSETS" : "STORE_ORIGIN_OFFSETS", "(", c.system, ", ", c.offset,
        ")");
  }
  void operator()(const SetG92Offset& c) const { put("SET_G92_OFFSETS(", c.offset, ")"); }
  void operator()(const UseToolLength& c) const {
    put("USE_TOOL_LENGTH_OFFSET(", c.z, ", ", c.x, ")");
  }
  void operator()(const SetSpindleSpeed& c) const { put("SET_SPINDLE_SPEED(", c.speed, ")"); }
  void operator()(const UseSurfaceSpeed& c) const {
    put("SET_SURFACE_SPEED(", c.surface_speed, Option{", D", c.max_speed}, ")");
  }
  void operator()(const OrientSpindle& c) const { put("ORIENT_SPINDLE(", c.angle, ")"); }
  void operator()(const TurnSpindle& c) const { put(name_in(kSpindle, c.direction)); }
  void operator()(const SetCoolant& c) const {
    put("SET_COOLANT(MIST_", on_off(c.mist), ", FLOOD_", on_off(c.flood), ")");
  }
  void operator()(const SelectTool& c) const { put("SELECT_TOOL(", c.tool, ")"); }
  void operator()(const ChangeTool& c) const { put("CHANGE_TOOL(", c.tool, ")"); }
  void operator()(const EnableOverrides& c) const {
    put("ENABLE_OVERRIDES(FEED_", on_off(c.feed), ", SPEED_", on_off(c.speed), ")");
  }
  void operator()(const ProgramStop& c) const { put(name_in(kStops, c.kind)); }
  void operator()(const ProgramEnd&) const { put("PROGRAM_END()"); }
  void operator()(const Message& c) const { put(name_in(kMessages, c.kind), "(\"", c.text, "\")"); }
  void operator()(const SetOverride& c) const {
    put("SET_OVERRIDE(", name_in(kOverrides, c.which), c.factor ? "" : ", KEEP",
        Option{", ", c.factor}, ")");
  }
  void operator()(const UseOverrideInput& c) const {
    put("USE_FEED_OVERRIDE_INPUT(", on_off(c.on), ")");
  }
  void operator()(const UseHoldInput& c) const { put("USE_FEED_HOLD_INPUT(", on_off(c.on), ")"); }
  void operator()(const SelectHead& c) const {
    put("SELECT_HEAD(", name_in(kHeads, c.head), ", ", c.offset, ")");
  }
  void operator()(const StoreHeadOffset& c) const {
    put("STORE_HEAD_OFFSET(", name_in(kHeads, c.head), ", ", c.offset, ")");
  }
  void operator()(const EnableDrives& c) const { put("ENABLE_DRIVES(", on_off(c.on), ")"); }
  void operator()(const SetOutput& c) const { put("SET_OUTPUT(", c.port, ", ", on_off(c.on), ")"); }
  void operator()(const SetAnalogOutput& c) const {
    put("SET_ANALOG_OUTPUT(", c.port, ", ", c.value, ")");
  }
  void operator()(const ReadInput& c) const {
    if (c.analog) return put("READ_ANALOG_INPUT(", c.port, ")");
    if (c.wait == WaitForInput::no) return put("READ_INPUT(", c.port, ")");
    put("READ_INPUT(", c.port, name_in(kWaits, c.wait), ", ", c.timeout, ")");
  }
  void operator()(const SetSpindleOutput& c) const {
    put("SET_SPINDLE_OUTPUT(", name_in(kSpindleOutputs, c.output), ", ", on_off(c.on), ")");
  }
  void operator()(const ClampAxis& c) const {
    put(c.on ? "CLAMP_AXIS(" : "UNCLAMP_AXIS(", axis_name(c.axis));
    if (c.port) put(", ", *c.port);
    put(")");
  }
  void operator()(const UseTorchHeight& c) const {
    put("TORCH_HEIGHT_CONTROL(", on_off(c.on), ")");
  }
  void operator()(const SetTorchHeight& c) const { put("SET_TORCH_HEIGHT(", c.set_point, ")"); }
  void operator()(const SetTemperature& c) const {
    put("SET_TEMPERATURE(", name_in(kHeaters, c.heater), ", ", c.celsius, c.wait ? ", WAIT" : "",
        ")");
  }
  void operator()(const SetTemperatureLimit& c) const {
    put("SET_TEMPERATURE_LIMIT(", c.celsius, ")");
  }
  void operator()(const SetFan& c) const { put("SET_FAN(", c.power, ")"); }
  void operator()(const HeatersOff&) const { put("HEATERS_OFF()"); }
  void operator()(const ScaleAxis& c) const {
    put("SCALE_AXIS(", axis_name(c.axis), ", ", c.factor, ")");
  }
  void operator()(const AskOperator& c) const {
    put("DIALOG(\"", c.dialog->title, "\"");
    for (const DialogField& field : c.dialog->fields) {
      put(", \"", field.label, "\", #", field.parameter, "=", field.value);
    }
    put(")");
  }
  void operator()(const OpenLogFile& c) const {
    put("LOG_OPEN(\"", c.name, "\"", c.append ? ", APPEND" : "", ")");
  }
  void operator()(const StorePosition& c) const {
    put("STORE_POSITION(\"", c.name, "\"", c.append ? ", APPEND" : "", ")");
  }
  void operator()(const SetGuard& c) const {
    put("GUARD(", name_in(kGuards, c.guard), ", ", on_off(c.on), ")");
  }
  void operator()(const UseHomeSensorsAsEstop& c) const {
    put("HOME_IS_ESTOP(", on_off(c.on), ")");
  }
  void operator()(const HomeAxis& c) const {
    put(name_in(kHomeSteps, c.step), "(", axis_name(c.axis), ")");
  }
  void operator()(const SetKnife& c) const {
    put("TANGENTIAL_KNIFE(", name_in(kKnife, c.command), ")");
  }
  void operator()(const ChangeHeightMap& c) const {
    const std::string_view command = name_in(kHeightMap, c.command);
    if (c.command == HeightMapCommand::begin) {
      return put("HEIGHT_MAP(", command, ", ", c.grid_size, ", ", c.columns, ", ", c.rows, ")");
    }
    if (c.command != HeightMapCommand::store) return put("HEIGHT_MAP(", command, ")");
    put("HEIGHT_MAP(", command, ", \"", c.name, "\")");
  }
  void operator()(const Synchronise&) const { put("SYNCHRONISE()"); }

 private:
  template <typename... Parts>
  void put(const Parts&... parts) const {
    (add(parts), ...);
  }
  void add(std::string_view text) const { text_ += text; }
  void add(double number) const { append_six_decimals(text_, {&number, 1}); }
  void add(std::span<const double> numbers) const { append_six_decimals(text_, numbers); }
  void add(const Position& position) const { add(std::span(position.values)); }
  void add(std::int32_t number) const {
    const fmt::format_int digits(number);
    text_.append(digits.data(), digits.size());
  }
  void add(const Option& option) const {
    if (option.value) put(option.letter, *option.value);
  }

  std::string& text_;
};

}  // namespace

bool waits_for_answer(const CommandBody& body) {
  return std::visit([]<typename Body>(const Body&) { return kWaitsForAnswer<Body>; }, body);
}

void append_text(std::string& text, const Command& command) {
  std::visit(Printer(text), command.body);
}

std::string text_of(const Command& command) {
  std::string text;
  append_text(text, command);
  return text;
}

}  // namespace cnc::interp
