#include "interpreter/modal_state.h"

#include <array>
#include <fmt/format.h>
#include <iterator>

#include "interpreter/line.h"

namespace cnc::interp {
namespace {

template <typename Enum, std::size_t size>
[[nodiscard]] std::string_view name_in(const std::array<std::string_view, size>& names,
                                       Enum value) {
  return names.at(static_cast<std::size_t>(value));
}

constexpr std::array<std::string_view, 3> kPlanes{"G17", "G18", "G19"};
constexpr std::array<std::string_view, 2> kUnits{"G21", "G20"};
constexpr std::array<std::string_view, 2> kDistances{"G90", "G91"};
constexpr std::array<std::string_view, 3> kFeedModes{"G94", "G93", "G95"};
constexpr std::array<std::string_view, 3> kPathModes{"G61", "G61.1", "G64"};
constexpr std::array<std::string_view, 3> kCompensation{"G40", "G41", "G42"};
constexpr std::array<std::string_view, 4> kLengths{"G49", "G43", "G43 H", "G43.1"};
constexpr std::array<std::string_view, 9> kSystems{"G54", "G55",   "G56",   "G57",  "G58",
                                                   "G59", "G59.1", "G59.2", "G59.3"};
constexpr std::array<std::string_view, 3> kSpindle{"M5", "M3", "M4"};
constexpr std::array<std::string_view, 5> kHeads{"M90", "M91", "M92", "M95", "M97"};

[[nodiscard]] std::string_view override_code(bool feed, bool speed) {
  if (feed) return speed ? "M48" : "M51 P-1";
  return speed ? "M50 P-1" : "M49";
}

/// F as it was written.
[[nodiscard]] double programmed_feed(const ModalState& modal) {
  constexpr double kSecondsPerMinute = 60.0;
  if (modal.feed_mode == FeedMode::inverse_time) return modal.feed * kSecondsPerMinute;
  const double feed = modal.linear_feed / millimetres_per(modal.unit);
  return modal.feed_mode == FeedMode::per_revolution ? feed : feed * kSecondsPerMinute;
}

/// S as it was written.
[[nodiscard]] double programmed_speed(const ModalState& modal) {
  if (!modal.speed_by_surface) return modal.speed;
  return modal.surface_speed / surface_speed_unit(modal.unit);
}

}  // namespace

std::string ModalState::active_codes() const {
  std::string text = motion % 10 == 0 ? fmt::format("G{}", motion / 10)
                                      : fmt::format("G{}.{}", motion / 10, motion % 10);
  const auto add = [&text](std::string_view code) { text.append(" ").append(code); };
  add(name_in(kPlanes, plane));
  add(name_in(kUnits, unit));
  add(name_in(kCompensation, compensation));
  add(name_in(kLengths, length_source));
  if (length_source == LengthSource::table) text += std::to_string(length_tool);
  add(kSystems.at(static_cast<std::size_t>(work_system - 1)));
  add(name_in(kPathModes, path.mode));
  add(name_in(kDistances, distance));
  if (arc_distance == DistanceMode::absolute) add("G90.1");
  if (g92_active) add("G92");
  if (rotated) add("G68");
  if (scaled) add("G51");
  if (retract == RetractMode::r_position) add("G99");
  add(name_in(kFeedModes, feed_mode));
  add(speed_by_surface ? "G96" : "G97");
  add(name_in(kSpindle, spindle));
  if (mist) add("M7");
  if (flood) add("M8");
  if (!mist && !flood) add("M9");
  add(override_code(feed_override_enabled, speed_override_enabled));
  if (head != Head::spindle_0) add(name_in(kHeads, head));
  if (a_clamped) add("M26");
  if (torch_height) add("M20");
  fmt::format_to(std::back_inserter(text), " T{} F{} S{}", tool,
                 number_text(programmed_feed(*this)), number_text(programmed_speed(*this)));
  return text;
}

}  // namespace cnc::interp
