// [[event]]: when, and what.
#include <cmath>

#include "hal/sim/scenario_sections.h"

namespace cnc::hal::sim {
namespace {

// --- what ----------------------------------------------------------------------------------------

std::optional<bool> stuck_state(ScenarioTable& event) {
  static constexpr std::array<std::string_view, 3> kStates{"on", "off", "free"};
  const std::size_t state = event.choice("state", kStates);
  return state == 2 ? std::nullopt : std::optional(state == 0);
}

// Names of VirtualMotor::Switch, in its order.
VirtualMotor::Switch switch_of(ScenarioTable& event) {
  static constexpr std::array<std::string_view, 3> kSwitches{"home", "limit_low", "limit_high"};
  return static_cast<VirtualMotor::Switch>(event.choice("switch", kSwitches));
}

ScenarioAction estop(ScenarioTable& event, bool pressed) {
  static constexpr std::array<std::string_view, 3> kChannels{"both", "1", "2"};
  const std::size_t channel = event.has("channel") ? event.choice("channel", kChannels) : 0;
  event.know("channel");
  return EstopButton{channel != 2, channel != 1, pressed};
}

ScenarioAction link_changes(ScenarioTable& event) {
  LinkChanges link{};
  event.read("loss", link.loss, kProbabilityRange);
  event.read("duplication", link.duplication, kProbabilityRange);
  event.read("corruption", link.corruption, kProbabilityRange);
  event.read("delay", link.delay, kLinkTimeRange);
  event.read("jitter", link.jitter, kLinkTimeRange);
  return link;
}

ScenarioAction switch_sticks(ScenarioTable& event) {
  return SwitchSticks{event.axis("axis"), switch_of(event), stuck_state(event)};
}

ScenarioAction steps_are_lost(ScenarioTable& event) {
  return StepsAreLost{event.axis("axis"),
                      static_cast<std::int64_t>(event.whole_number("steps", {-1e6, 1e6}))};
}

ScenarioAction analog_changes(ScenarioTable& event) {
  return AnalogChanges{static_cast<std::size_t>(event.whole_number("input", {1, 8})) - 1,
                       event.number("value", {0.0, 1.0})};
}

ScenarioAction hand_wheel_turns(ScenarioTable& event) {
  return HandWheelTurns{static_cast<std::int32_t>(event.whole_number("counts", {-1e6, 1e6}))};
}

ScenarioAction tool_is_loaded(ScenarioTable& event) {
  return ToolIsLoaded{static_cast<int>(event.whole_number("number", kToolRange))};
}

struct ActionRow {
  std::string_view name;
  ScenarioAction (*read)(ScenarioTable&);
};

using Table = ScenarioTable;
using Action = ScenarioAction;

constexpr std::array kActions{
    ActionRow{"cable_out", [](Table&) -> Action { return CableMoves{true}; }},
    ActionRow{"cable_in", [](Table&) -> Action { return CableMoves{false}; }},
    ActionRow{"link_trouble", link_changes},
    ActionRow{"board_reset", [](Table&) -> Action { return BoardRestarts{}; }},
    ActionRow{"switch_stuck", switch_sticks},
    ActionRow{"probe_stuck", [](Table& t) -> Action { return ProbeSticks{stuck_state(t)}; }},
    ActionRow{"door_stuck", [](Table& t) -> Action { return DoorContactSticks{stuck_state(t)}; }},
    ActionRow{"estop_press", [](Table& t) -> Action { return estop(t, true); }},
    ActionRow{"estop_release", [](Table& t) -> Action { return estop(t, false); }},
    ActionRow{"external_error", [](Table& t) -> Action { return ExternalError{t.flag("on")}; }},
    ActionRow{"step_loss", steps_are_lost},
    ActionRow{"drive_alarm",
              [](Table& t) -> Action {
                return DriveAlarm{t.axis("axis"), t.flag("on")};
              }},
    ActionRow{"index_missing", [](Table&) -> Action { return IndexSensor{true}; }},
    ActionRow{"index_back", [](Table&) -> Action { return IndexSensor{false}; }},
    ActionRow{"door_open", [](Table&) -> Action { return DoorMoves{true}; }},
    ActionRow{"door_close", [](Table&) -> Action { return DoorMoves{false}; }},
    ActionRow{"analog", analog_changes},
    ActionRow{"port",
              [](Table& t) -> Action {
                return PortChanges{t.port("port"), t.flag("on")};
              }},
    ActionRow{"hand_wheel", hand_wheel_turns},
    ActionRow{"load_tool", tool_is_loaded},
};

ScenarioAction read_action(ScenarioTable& event) {
  std::array<std::string_view, kActions.size()> names;
  std::ranges::transform(kActions, names.begin(), &ActionRow::name);
  return kActions.at(event.choice("action", names)).read(event);
}

// --- when ----------------------------------------------------------------------------------------

PlacePassed read_place(ScenarioTable& event) {
  std::optional<ScenarioTable> when = event.table("when");
  if (!when) return {};
  PlacePassed passed{.axis = when->axis("axis"), .place = 0.0, .upwards = when->has("beyond")};
  when->know("beyond");
  when->know("below");
  passed.place = when->number(passed.upwards ? "beyond" : "below", kPlaceRange);
  if (when->has("beyond") && when->has("below")) {
    when->refuse(ErrorCode::scenario_contradiction,
                 "An event happens beyond a place, coming from below it, or below one; not both.");
  }
  when->finish();
  return passed;
}

ScenarioEvent read_event(ScenarioTable& event) {
  event.know("at");
  event.know("when");
  ScenarioEvent result;
  result.action = read_action(event);
  if (event.has("at") == event.has("when")) {
    event.refuse(
        event.has("at") ? ErrorCode::scenario_contradiction : ErrorCode::scenario_key_missing,
        "An event has either at, in seconds, or when, with an axis and a place.");
  } else if (event.has("at")) {
    constexpr double kSecond{cpu5::firmware::kTicksPerSecond};
    result.when = std::llround(event.number("at", {0.0, 1e6, "s"}) * kSecond);
  } else {
    result.when = read_place(event);
  }
  event.finish();
  return result;
}

}  // namespace

void read_events(ScenarioTable& file, std::vector<ScenarioEvent>& events) {
  for (ScenarioTable& event : file.tables("event")) events.push_back(read_event(event));
}

}  // namespace cnc::hal::sim
