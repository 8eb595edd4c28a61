#include "interpreter/parameter_access.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace cnc::interp {
namespace {

// Values that change while nobody writes them.
constexpr std::int32_t kFirstLive = 5068;
constexpr std::int32_t kLastLive = 5070;

/// What a number or range of numbers holds, as far as it is not simply the store's.
struct Meaning {
  using Reader = double (*)(const MachineState& state, const config::ToolTable& tools,
                            std::int32_t offset);
  std::int32_t first;
  std::int32_t last;
  Reader read;
};

[[nodiscard]] const config::Tool& tool_at(const config::ToolTable& tools, std::int32_t number) {
  return tools.tool(number);
}

/// The axis of the n-th of six numbers.
[[nodiscard]] Axis nth_axis(std::int32_t n) { return kAllAxes.at(static_cast<std::size_t>(n)); }

using State = const MachineState&;
using Tools = const config::ToolTable&;

// Read-only, ascending. Lengths in mm: get_system() turns them into the program's unit.
constexpr auto kMeanings = std::to_array<Meaning>({
    {5001, 5006, [](State s, Tools, std::int32_t n) { return s.work_position()[nth_axis(n)]; }},
    {5008, 5008, [](State s, Tools, std::int32_t) { return static_cast<double>(s.modal.tool); }},
    {5009, 5009,
     [](State s, Tools t, std::int32_t) { return tool_at(t, s.modal.tool).diameter / 2; }},
    {5010, 5010, [](State s, Tools t, std::int32_t) { return tool_at(t, s.modal.tool).length; }},
    {5012, 5012, [](State s, Tools t, std::int32_t) { return tool_at(t, s.modal.tool).x_offset; }},
    {5013, 5013, [](State s, Tools, std::int32_t) { return s.coordinates.tool_length()[Axis::Z]; }},
    {5014, 5014, [](State s, Tools, std::int32_t) { return s.coordinates.tool_length()[Axis::X]; }},
    {5068, 5068, [](State s, Tools, std::int32_t) { return s.live.probe ? 1.0 : 0.0; }},
    {5069, 5069, [](State s, Tools, std::int32_t) { return s.live.hand_wheel; }},
    {5070, 5070, [](State s, Tools, std::int32_t) { return s.live.spindle_speed; }},
    {5071, 5076, [](State s, Tools, std::int32_t n) { return s.position[nth_axis(n)]; }},
    {5397, 5397, [](State s, Tools, std::int32_t) { return s.rendering ? 1.0 : 0.0; }},
    {5401, 5499, [](State, Tools t, std::int32_t n) { return tool_at(t, n + 1).length; }},
    {5501, 5599, [](State, Tools t, std::int32_t n) { return tool_at(t, n + 1).diameter; }},
    {5601, 5699, [](State, Tools t, std::int32_t n) { return tool_at(t, n + 1).x_offset; }},
    {5701, 5799,
     [](State, Tools t,
        std::int32_t n) { return static_cast<double>(tool_at(t, n + 1).orientation); }},
});

[[nodiscard]] const Meaning* meaning_of(std::int32_t number) {
  const auto row = std::ranges::find_if(
      kMeanings, [&](const Meaning& m) { return number >= m.first && number <= m.last; });
  return row == kMeanings.end() ? nullptr : &*row;
}

/// Numbers that hold a length of X, Y or Z, besides tool data: the first three of six.
constexpr auto kPositions = std::to_array<std::int32_t>(
    {5001, 5051, 5061, 5071, 5081, 5101, 5111, 5121, 5131, 5141, 5161, 5181,
     5211, 5221, 5241, 5261, 5281, 5301, 5321, 5341, 5361, 5381, 5391});

[[nodiscard]] bool is_length(std::int32_t number) {
  if (number == 5009 || number == 5010 || (number >= 5012 && number <= 5014)) return true;
  if (number > 5400) return number < 5700;
  return std::ranges::any_of(
      kPositions, [&](std::int32_t first) { return number >= first && number < first + 3; });
}

}  // namespace

double ParameterAccess::scale_of(std::int32_t number) const {
  return is_length(number) ? state_.scale() : 1.0;
}

double ParameterAccess::get_system(std::int32_t number) const {
  if (number >= kFirstLive && number <= kLastLive && !live_is_fresh_) wants_live_ = true;
  const Meaning* meaning = meaning_of(number);
  const double value =
      meaning ? meaning->read(state_, tools_, number - meaning->first) : store_.get(number);
  return value / scale_of(number);
}

void ParameterAccess::set(std::int32_t number, double value) {
  store_.set(number, number < kFirstSystem ? value : value * scale_of(number));
}

Accepted ParameterAccess::check_writable(std::int32_t number, Span span) {
  const Meaning* meaning = meaning_of(number);
  if (meaning == nullptr) return {};
  return refuse(ErrorCode::parameter_read_only, span, fmt::format("#{} can only be read.", number),
                "#1 to #4999 are free; offsets are set with G10 and G92, tools in the tool table.");
}

bool ParameterAccess::affects_offsets(std::int32_t number) {
  using namespace config::parameter;
  return number >= kActiveSystem &&
         number < kWorkOffset + kWorkSystemStride * (config::kWorkSystemCount - 1) +
                      static_cast<std::int32_t>(kAxisCount);
}

}  // namespace cnc::interp
