// The tables of a scenario that build the machine.
#include <fmt/format.h>

#include "hal/sim/height_map.h"
#include "hal/sim/scenario_sections.h"

namespace cnc::hal::sim {
namespace {

constexpr double kTiny = 1e-6;
constexpr Range kMarginRange{0.0, 1000.0, "mm or degrees"};
constexpr Range kBounceRange{0.0, 1.0, "s"};
constexpr Range kVelocityRange{kTiny, 1e6, "mm/s or degrees/s"};
constexpr Range kAccelerationRange{kTiny, 1e9, "mm/s^2 or degrees/s^2"};
constexpr Range kLengthRange{-kFarthest, kFarthest, "mm"};
constexpr Range kSizeRange{kTiny, kFarthest, "mm"};
constexpr Range kChannelRange{1, 8};

using Read = void (*)(ScenarioTable&, MachineOptions&);

// --- [machine] -----------------------------------------------------------------------------------

void read_io_cards(ScenarioTable& table, MachineOptions& options) {
  if (!table.has("io_cards")) return;
  std::vector<double> cards;
  table.read("io_cards", cards, {1, kCardCount});
  options.io_cards = {};
  for (const double card : cards) options.io_cards.at(static_cast<std::size_t>(card) - 1) = true;
}

void read_analog(ScenarioTable& table, MachineOptions& options) {
  std::vector<double> values;
  table.read("analog", values, {0.0, 1.0});
  if (values.size() > kAnalogCount) {
    table.refuse(ErrorCode::scenario_out_of_range,
                 fmt::format("analog of [machine] has {} values; the board has {} inputs.",
                             values.size(), kAnalogCount));
    return;
  }
  std::ranges::copy(values, options.analog.begin());
}

void read_general(ScenarioTable& table, MachineOptions& options) {
  table.read_whole("seed", options.seed, {0, 1e15});
  if (table.has("start")) {
    options.start.emplace();
    table.read("start", *options.start, kPlaceRange);
  }
  table.read("stop_margin", options.stop_margin, kMarginRange);
  table.read("limit_switch_margin", options.limit_switch_margin, kMarginRange);
  if (options.limit_switch_margin > options.stop_margin) {
    table.refuse(
        ErrorCode::scenario_contradiction,
        fmt::format("A limit switch {} behind the travel is never reached: the hard stop is "
                    "at stop_margin, {}. limit_switch_margin has to be less.",
                    options.limit_switch_margin, options.stop_margin));
  }
  table.read("switch_hysteresis", options.switch_hysteresis, kMarginRange);
  table.read("switch_bounce", options.switch_bounce, kBounceRange);
  table.read("loop_back_delay", options.loop_back_delay, kBounceRange);
  for (const std::size_t port : table.ports("ports_on")) {
    options.ports_on |= cpu5::firmware::PortBits{1} << port;
  }
  read_io_cards(table, options);
  read_analog(table, options);
}

// --- [axis.X] ------------------------------------------------------------------------------------

void read_axis(ScenarioTable& table, AxisOptions& options) {
  table.read("acceleration", options.motor.acceleration, kAccelerationRange);
  table.read("corner_velocity", options.motor.corner_velocity, kVelocityRange);
  table.read("top_velocity", options.motor.top_velocity, kVelocityRange);
  table.read("microsteps", options.motor.microsteps, {1.0, 1000.0, "steps to a full step"});
  table.read("closed_loop", options.motor.closed_loop);
  table.read_port("limit_low_port", options.limit_low_port);
  table.read_port("limit_high_port", options.limit_high_port);
  table.read("limits_in_estop_chain", options.limits_in_estop_chain);
  const MotorOptions& motor = options.motor;
  if (motor.corner_velocity && motor.top_velocity && *motor.corner_velocity > *motor.top_velocity) {
    table.refuse(ErrorCode::scenario_contradiction,
                 fmt::format("The torque falls from a corner_velocity of {} on and ends at a "
                             "top_velocity of {}, which has to be higher.",
                             *motor.corner_velocity, *motor.top_velocity));
  }
}

void read_axes(ScenarioTable& table, MachineOptions& options) {
  for (const Axis axis : kAllAxes) {
    if (std::optional<ScenarioTable> one = table.table(axis_name(axis))) {
      read_axis(*one, options.axes[axis]);
      one->finish();
    }
  }
}

// --- what the axes meet --------------------------------------------------------------------------

void read_door(ScenarioTable& table, MachineOptions& options) {
  DoorOptions& door = options.door.emplace();
  table.read_port("port", door.port);
  table.read("open", door.open);
  table.read("in_estop_chain", door.in_estop_chain);
  table.read("stops_spindle", door.stops_spindle);
  table.read("stops_coolant", door.stops_coolant);
}

HeightMap height_map(ScenarioTable& table) {
  HeightMap map;
  map.x = table.number("x", kLengthRange);
  map.y = table.number("y", kLengthRange);
  map.dx = table.number("dx", kSizeRange);
  map.dy = table.number("dy", kSizeRange);
  for (const std::vector<double>& row : table.rows("heights", kLengthRange)) {
    map.columns = row.size();
    map.heights.insert(map.heights.end(), row.begin(), row.end());
  }
  return map;
}

void read_stock(ScenarioTable& table, MachineOptions& options) {
  if (!table.has("height")) {
    options.touch.stock = height_map(table);
    return;
  }
  const double height = table.number("height", kLengthRange);
  options.touch.stock = [height](double, double) { return height; };
  if (table.has("heights")) {
    table.refuse(ErrorCode::scenario_contradiction,
                 "[stock] has height, for a level stock, and heights, for a grid; one of them.");
  }
}

void read_tool_setter(ScenarioTable& table, MachineOptions& options) {
  ToolSetter& setter = options.touch.tool_setter.emplace();
  setter.x = table.number("x", kLengthRange);
  setter.y = table.number("y", kLengthRange);
  setter.top = table.number("top", kLengthRange);
  table.read("half_width", setter.half_width, kSizeRange);
}

void read_tool(ScenarioTable& table, MachineOptions& options) {
  const auto number = static_cast<int>(table.whole_number("number", kToolRange));
  const double length = table.number("length", {0.0, 1000.0, "mm"});
  if (options.touch.tool_lengths.emplace(number, length).second) return;
  table.refuse(ErrorCode::scenario_contradiction,
               fmt::format("Tool {} stands in the scenario twice.", number));
}

void read_spindle(ScenarioTable& table, MachineOptions& options) {
  table.read("time_constant", options.spindle.time_constant, {0.001, 100.0, "s"});
  table.read("acceleration", options.spindle.acceleration, {1.0, 1e7, "rpm/s"});
  table.read("sync_width", options.spindle.sync_width, {0.0, 1.0, "revolutions"});
}

void read_heater(ScenarioTable& table, MachineOptions& options) {
  HeaterOptions heater;
  heater.pwm = static_cast<std::size_t>(table.whole_number("pwm", kChannelRange)) - 1;
  heater.analog = static_cast<std::size_t>(table.whole_number("analog", kChannelRange)) - 1;
  table.read("power", heater.power, {0.0, 1e5, "W"});
  table.read("capacity", heater.capacity, {0.001, 1e6, "J/K"});
  table.read("loss", heater.loss, {0.001, 1e4, "W/K"});
  table.read("ambient", heater.ambient, {-50.0, 200.0, "deg C"});
  table.read("sensor_range", heater.sensor_range, {1.0, 5000.0, "deg C"});
  options.heaters.push_back(heater);
}

struct Section {
  std::string_view key;
  bool repeated;  ///< written as [[key]]
  Read read;
};

constexpr std::array kSections{
    Section{"machine", false, read_general},
    Section{"axis", false, read_axes},
    Section{"door", false, read_door},
    Section{"stock", false, read_stock},
    Section{"tool_setter", false, read_tool_setter},
    Section{"tool", true, read_tool},
    Section{"spindle", false, read_spindle},
    Section{"heater", true, read_heater},
};

}  // namespace

void read_machine(ScenarioTable& file, MachineOptions& options) {
  const auto read = [&options](const Section& section, ScenarioTable& table) {
    section.read(table, options);
    table.finish();
  };
  for (const Section& section : kSections) {
    if (section.repeated) {
      for (ScenarioTable& table : file.tables(section.key)) read(section, table);
    } else if (std::optional<ScenarioTable> table = file.table(section.key)) {
      read(section, *table);
    }
  }
}

}  // namespace cnc::hal::sim
