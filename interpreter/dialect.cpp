#include "interpreter/dialect.h"

#include <algorithm>
#include <array>

#include "interpreter/handlers.h"

namespace cnc::interp {
namespace {

using enum AxisUse;
constexpr WordSet kArcWords = words("IJKR");

// The codes of the PSCNC manual, 3.3; the names are its own. Its M codes "always get executed after
// the G-code". M3 and M5 asked the operator to turn the spindle; here they turn it.
// clang-format off
constexpr auto kPscncG = std::to_array<Code>({
    {"G00",   0, Group::motion,      Step::motion,      required, kNoWords,   kNoWords,   rapid_move,      "rapid motion"},
    {"G01",  10, Group::motion,      Step::motion,      required, kNoWords,   kNoWords,   feed_move,       "linear motion"},
    {"G02",  20, Group::motion,      Step::motion,      required, kArcWords,  kNoWords,   arc_move,        "clockwise arc"},
    {"G03",  30, Group::motion,      Step::motion,      required, kArcWords,  kNoWords,   arc_move,        "counter-clockwise arc"},
    {"G04",  40, Group::non_modal,   Step::dwell,       none,     words("P"), words("P"), dwell,           "dwell, P seconds"},
    {"G17", 170, Group::plane,       Step::plane,       none,     kNoWords,   kNoWords,   select_plane,    "XY plane"},
    {"G18", 180, Group::plane,       Step::plane,       none,     kNoWords,   kNoWords,   select_plane,    "ZX plane"},
    {"G19", 190, Group::plane,       Step::plane,       none,     kNoWords,   kNoWords,   select_plane,    "YZ plane"},
    {"G43", 430, Group::tool_length, Step::tool_length, none,     words("H"), words("H"), use_tool_length, "length of tool H"},
});
constexpr auto kPscncM = std::to_array<Code>({
    {"M00",  0, Group::stopping,     Step::stop,         none, kNoWords, kNoWords, stop_program,      "program pause"},
    {"M03",  3, Group::spindle,      Step::after_motion, none, kNoWords, kNoWords, turn_spindle,      "spindle on"},
    {"M05",  5, Group::spindle,      Step::after_motion, none, kNoWords, kNoWords, turn_spindle,      "spindle off"},
    {"M06",  6, Group::tool_change,  Step::after_motion, none, kNoWords, kNoWords, change_tool,       "tool change"},
    {"M21", 21, Group::path_control, Step::after_motion, none, kNoWords, kNoWords, switch_contouring, "contouring on"},
    {"M22", 22, Group::path_control, Step::after_motion, none, kNoWords, kNoWords, switch_contouring, "contouring off"},
    {"M30", 30, Group::stopping,     Step::stop,         none, kNoWords, kNoWords, end_program,       "program end"},
});
// clang-format on

[[nodiscard]] const Code* find_in(std::span<const Code> codes, std::int32_t number) {
  const auto row = std::ranges::find(codes, number, &Code::number);
  return row == codes.end() ? nullptr : &*row;
}

[[nodiscard]] const Code* find_pscnc_g(std::int32_t number) { return find_in(kPscncG, number); }
[[nodiscard]] const Code* find_pscnc_m(std::int32_t number) { return find_in(kPscncM, number); }

}  // namespace

const Dialect& dialect(DialectId id) {
  static const std::array<Dialect, 2> kDialects{{
      {.name = "eding",
       .g_codes = g_codes(),
       .m_codes = m_codes(),
       .find_g_code = find_g_code,
       .find_m_code = find_m_code,
       .max_m_codes = 4,
       .ignores_unknown_g = false,
       .short_radius_is_half_circle = false,
       .radius_is_positive = false,
       .circle_needs_end = true,
       .needs_end = false,
       .has_names = true},
      {.name = "pscnc",
       .g_codes = kPscncG,
       .m_codes = kPscncM,
       .find_g_code = find_pscnc_g,
       .find_m_code = find_pscnc_m,
       .max_m_codes = 1,
       .ignores_unknown_g = true,
       .short_radius_is_half_circle = true,
       .radius_is_positive = true,
       .circle_needs_end = false,
       .needs_end = true,
       .has_names = false},
  }};
  return kDialects.at(static_cast<std::size_t>(id));
}

}  // namespace cnc::interp
