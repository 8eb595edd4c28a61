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
constexpr std::array<std::string_view, 2> kStops{"PROGRAM_STOP()", "OPTIONAL_PROGRAM_STOP()"};
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
};

}  // namespace

std::string text_of(const Command& command) { return std::visit(Printer{}, command.body); }

}  // namespace cnc::interp
