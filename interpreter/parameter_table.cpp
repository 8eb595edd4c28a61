#include "interpreter/parameter_table.h"

#include <algorithm>
#include <array>

namespace cnc::interp {
namespace {

using From = const ParameterSources&;
using N = std::int32_t;
using enum Quantity;
using enum Writing;

/// The n-th of six values.
[[nodiscard]] double nth(const Position& position, N n) {
  return position.values.at(static_cast<std::size_t>(n));
}
[[nodiscard]] double one_if(bool yes) { return yes ? 1.0 : 0.0; }
[[nodiscard]] const config::Tool& spindle_tool(From from) {
  return from.tools.tool(from.state.modal.tool);
}
/// Tool n; tool 0 is all zero.
[[nodiscard]] const config::Tool& tool(From from, N n) { return from.tools.tool(n); }

constexpr auto kStored = nullptr;

constexpr std::string_view kUsePosition =
    "Moves change the position; G92 or G10 L20 give it other coordinates.";
constexpr std::string_view kUseToolChange = "M6 changes the tool.";
constexpr std::string_view kUseToolTable = "#5401 to #5799 change the data of a tool.";
constexpr std::string_view kUseG43 = "G43, G43.1 and G49 change the tool length in force.";
constexpr std::string_view kUseProbe = "G38.2 writes it; #1 to #4999 are free.";
constexpr std::string_view kUseMachine = "The machine measures it; #1 to #4999 are free.";
constexpr std::string_view kUseSetup = "The machine's set-up says it; #1 to #4999 are free.";
constexpr std::string_view kUseHeads =
    "M90 to M97 select the head, with Q1 they measure its offset.";
constexpr std::string_view kUseHeightMap = "ZHC ON and ZHC OFF switch the height map.";
constexpr std::string_view kRunMode = "Checking and running set it; #1 to #4999 are free.";
constexpr std::string_view kWorkSystems = "A whole number from 1 (G54) to 9 (G59.3).";
static_assert(config::kMaxToolLength == 10'000.0 && config::kMaxToolDiameter == 1'000.0);
constexpr std::string_view kToolLengths = "-10000 to 10000 mm.";
constexpr std::string_view kToolDiameters = "-1000 to 1000 mm.";
constexpr std::string_view kToolOrientations = "A whole number from 1 to 9.";

// clang-format off
constexpr auto kMeanings = std::to_array<ParameterMeaning>({
    {5001, 5006, position, never, [](From f, N n) { return nth(f.state.work_position(), n); }, kUsePosition},
    {5008, 5008, plain, never, [](From f, N) { return static_cast<double>(f.state.modal.tool); }, kUseToolChange},
    {5009, 5009, length, never, [](From f, N) { return spindle_tool(f).diameter / 2.0; }, kUseToolTable},
    {5010, 5010, length, never, [](From f, N) { return spindle_tool(f).length; }, kUseToolTable},
    {5012, 5012, length, never, [](From f, N) { return spindle_tool(f).x_offset; }, kUseToolTable},
    {5013, 5013, length, never, [](From f, N) { return f.state.coordinates.tool_length()[Axis::Z]; }, kUseG43},
    {5014, 5014, length, never, [](From f, N) { return f.state.coordinates.tool_length()[Axis::X]; }, kUseG43},
    {5051, 5056, position, never, kStored, kUseProbe},
    {5061, 5066, position, never, kStored, kUseProbe},
    {5067, 5067, plain, never, kStored, kUseProbe},
    {5068, 5068, plain, never, [](From f, N) { return one_if(f.state.live.probe); }, kUseMachine, nullptr, true},
    {5069, 5069, plain, never, [](From f, N) { return f.state.live.hand_wheel; }, kUseMachine, nullptr, true},
    {5070, 5070, plain, never, [](From f, N) { return f.state.live.spindle_speed; }, kUseMachine, nullptr, true},
    {5071, 5076, position, never, [](From f, N n) { return nth(f.state.position, n); }, kUsePosition},
    {5081, 5086, position, never, kStored, kUseProbe},
    {5101, 5106, position, never, [](From f, N n) { return nth(f.machine.negative_limit, n); }, kUseSetup},
    {5111, 5116, position, never, [](From f, N n) { return nth(f.machine.positive_limit, n); }, kUseSetup},
    {5121, 5126, position, never, [](From f, N n) { return nth(f.machine.home_position, n); }, kUseSetup},
    {5131, 5133, position, never, [](From f, N n) { return nth(f.machine.tool_change_area_low, n); }, kUseSetup},
    {5141, 5143, position, never, [](From f, N n) { return nth(f.machine.tool_change_area_high, n); }, kUseSetup},
    {5150, 5150, plain, never, [](From f, N) { return static_cast<double>(f.machine.kinematics); }, kUseSetup},
    {5151, 5151, plain, never, [](From f, N) { return one_if(f.state.live.height_map); }, kUseHeightMap, nullptr, true},
    {5161, 5166, position, allowed, kStored, {}},  // G28
    {5181, 5186, position, allowed, kStored, {}},  // G30
    {5211, 5216, position, allowed, kStored, {}},  // G92
    {5220, 5220, whole, work_system, kStored, kWorkSystems},
    {5221, 5226, position, allowed, kStored, {}},  // G54 …
    {5241, 5246, position, allowed, kStored, {}},
    {5261, 5266, position, allowed, kStored, {}},
    {5281, 5286, position, allowed, kStored, {}},
    {5301, 5306, position, allowed, kStored, {}},
    {5321, 5326, position, allowed, kStored, {}},
    {5341, 5346, position, allowed, kStored, {}},
    {5361, 5366, position, allowed, kStored, {}},
    {5380, 5380, plain, never, [](From f, N) { return one_if(f.machine.simulation); }, kUseSetup},
    {5381, 5386, position, allowed, kStored, {}},  // G59.3
    {5390, 5390, plain, never, [](From f, N) { return static_cast<double>(f.state.modal.head); }, kUseHeads},
    {5391, 5393, position, never, [](From f, N n) { return nth(f.state.coordinates.head_offset(), n); }, kUseHeads},
    {5394, 5396, plain, never, [](From f, N n) { return f.machine.max_speed.at(static_cast<std::size_t>(n)); }, kUseSetup},
    {5397, 5397, plain, never, [](From f, N) { return one_if(f.state.rendering); }, kRunMode},
    {5400, 5499, length, tool_data, [](From f, N n) { return tool(f, n).length; }, kToolLengths, [](config::Tool& t, double v) { t.length = v; }},
    {5500, 5599, length, tool_data, [](From f, N n) { return tool(f, n).diameter; }, kToolDiameters, [](config::Tool& t, double v) { t.diameter = v; }},
    {5600, 5699, length, tool_data, [](From f, N n) { return tool(f, n).x_offset; }, kToolLengths, [](config::Tool& t, double v) { t.x_offset = v; }},
    {5700, 5799, whole, tool_data, [](From f, N n) { return static_cast<double>(tool(f, n).orientation); }, kToolOrientations, [](config::Tool& t, double v) { t.orientation = static_cast<std::int32_t>(v); }},
});
// clang-format on

static_assert(std::ranges::is_sorted(kMeanings, {}, &ParameterMeaning::first));

}  // namespace

const ParameterMeaning* meaning_of(std::int32_t number) {
  const auto behind = std::ranges::upper_bound(kMeanings, number, {}, &ParameterMeaning::first);
  if (behind == kMeanings.begin()) return nullptr;
  const ParameterMeaning& row = *std::prev(behind);
  return number <= row.last ? &row : nullptr;
}

}  // namespace cnc::interp
