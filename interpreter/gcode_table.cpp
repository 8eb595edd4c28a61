// Every G code of this interpreter. The manual's tables 3-3 (groups) and 3-4 (meanings).
#include <array>

#include "interpreter/code_table.h"
#include "interpreter/handlers.h"

namespace cnc::interp {
namespace {

using enum AxisUse;
constexpr WordSet kArcWords = words("IJKR");

// clang-format off
constexpr auto kCodes = std::to_array<Code>({
    {"G0",     0, Group::motion,    Step::motion,    required, kNoWords,     kNoWords,   rapid_move,    "rapid positioning"},
    {"G1",    10, Group::motion,    Step::motion,    required, kNoWords,     kNoWords,   feed_move,     "straight line at feed rate"},
    {"G2",    20, Group::motion,    Step::motion,    required, kArcWords,    kNoWords,   arc_move,      "clockwise arc or helix"},
    {"G3",    30, Group::motion,    Step::motion,    required, kArcWords,    kNoWords,   arc_move,      "counter-clockwise arc or helix"},
    {"G4",    40, Group::non_modal, Step::dwell,     none,     words("P"),   words("P"), dwell,         "dwell, P seconds"},
    {"G10",  100, Group::non_modal, Step::non_modal, optional, words("LP"),  words("LP"), set_coordinate_system, "set a work offset: L2 to values, L20 so that the tool stands at values"},
    {"G17",  170, Group::plane,     Step::plane,     none,     kNoWords,     kNoWords,   select_plane,  "XY plane"},
    {"G18",  180, Group::plane,     Step::plane,     none,     kNoWords,     kNoWords,   select_plane,  "XZ plane"},
    {"G19",  190, Group::plane,     Step::plane,     none,     kNoWords,     kNoWords,   select_plane,  "YZ plane"},
    {"G20",  200, Group::units,     Step::units,     none,     kNoWords,     kNoWords,   use_length_unit, "inches"},
    {"G21",  210, Group::units,     Step::units,     none,     kNoWords,     kNoWords,   use_length_unit, "millimetres"},
    {"G28",  280, Group::non_modal, Step::non_modal, optional, kNoWords,     kNoWords,   go_home,       "rapid to park position 1"},
    {"G30",  300, Group::non_modal, Step::non_modal, optional, kNoWords,     kNoWords,   go_home,       "rapid to park position 2"},
    {"G33",  330, Group::motion,    Step::motion,    required, words("K"),   words("K"), spindle_move,  "straight line that follows the spindle, K per revolution"},
    {"G33.1", 331, Group::motion,   Step::motion,    required, words("K"),   words("K"), spindle_move_there_and_back, "G33 and back with the spindle reversed: rigid tapping"},
    {"G38.2", 382, Group::motion,   Step::motion,    required, kNoWords,     kNoWords,   probe,         "straight line until the probe trips"},
    {"G40",  400, Group::cutter_compensation, Step::cutter_compensation, none, kNoWords, kNoWords, cancel_cutter_compensation, "cutter compensation off"},
    {"G41",  410, Group::cutter_compensation, Step::cutter_compensation, none, words("D"), kNoWords, begin_cutter_compensation, "cutter compensation left of the path, for the spindle's tool or tool D"},
    {"G41.1", 411, Group::cutter_compensation, Step::cutter_compensation, none, words("D"), words("D"), begin_cutter_compensation, "cutter compensation left of the path, for the diameter D"},
    {"G42",  420, Group::cutter_compensation, Step::cutter_compensation, none, words("D"), kNoWords, begin_cutter_compensation, "cutter compensation right of the path, for the spindle's tool or tool D"},
    {"G42.1", 421, Group::cutter_compensation, Step::cutter_compensation, none, words("D"), words("D"), begin_cutter_compensation, "cutter compensation right of the path, for the diameter D"},
    {"G43",  430, Group::tool_length, Step::tool_length, none, words("H"),   kNoWords,   use_tool_length, "tool length of the spindle's tool, or of tool H"},
    {"G43.1", 431, Group::tool_length, Step::tool_length, none, words("IK"), kNoWords,   use_length_words, "tool length of the words: I along X, K along Z"},
    {"G49",  490, Group::tool_length, Step::tool_length, none, kNoWords,     kNoWords,   cancel_tool_length, "no tool length"},
    {"G50",  500, Group::scaling,   Step::scaling,   none,     kNoWords,     kNoWords,   cancel_scaling, "scaling off"},
    {"G51",  510, Group::scaling,   Step::scaling,   optional, words("PIJ"), kNoWords,   scale,         "scaling of X and Y by P, or by X and by Y, about I J"},
    {"G53",  530, Group::non_modal, Step::machine_coordinates, none, kNoWords, kNoWords, use_machine_coordinates, "this move in machine coordinates"},
    {"G54",  540, Group::work_system, Step::work_system, none, kNoWords,     kNoWords,   select_work_system, "work system 1"},
    {"G55",  550, Group::work_system, Step::work_system, none, kNoWords,     kNoWords,   select_work_system, "work system 2"},
    {"G56",  560, Group::work_system, Step::work_system, none, kNoWords,     kNoWords,   select_work_system, "work system 3"},
    {"G57",  570, Group::work_system, Step::work_system, none, kNoWords,     kNoWords,   select_work_system, "work system 4"},
    {"G58",  580, Group::work_system, Step::work_system, none, kNoWords,     kNoWords,   select_work_system, "work system 5"},
    {"G59",  590, Group::work_system, Step::work_system, none, kNoWords,     kNoWords,   select_work_system, "work system 6"},
    {"G59.1", 591, Group::work_system, Step::work_system, none, kNoWords,    kNoWords,   select_work_system, "work system 7"},
    {"G59.2", 592, Group::work_system, Step::work_system, none, kNoWords,    kNoWords,   select_work_system, "work system 8"},
    {"G59.3", 593, Group::work_system, Step::work_system, none, kNoWords,    kNoWords,   select_work_system, "work system 9"},
    {"G61",  610, Group::path_control, Step::path_control, none, words("QR"), kNoWords,  set_path_control, "exact path; Q simplification, R look-ahead angle"},
    {"G61.1", 611, Group::path_control, Step::path_control, none, kNoWords,  kNoWords,   set_path_control, "exact stop"},
    {"G64",  640, Group::path_control, Step::path_control, none, words("PQR"), kNoWords, set_path_control, "continuous; P tolerance, Q simplification, R look-ahead angle"},
    {"G68",  680, Group::rotation,  Step::rotation,  optional, words("R"),   words("R"), rotate,        "rotation of the XY plane by R degrees about X Y"},
    {"G69",  690, Group::rotation,  Step::rotation,  none,     kNoWords,     kNoWords,   cancel_rotation, "rotation off"},
    {"G70",  700, Group::units,     Step::units,     none,     kNoWords,     kNoWords,   use_length_unit, "inches (as G20)"},
    {"G71",  710, Group::units,     Step::units,     none,     kNoWords,     kNoWords,   use_length_unit, "millimetres (as G21)"},
    {"G73",  730, Group::motion,    Step::motion,    required, words("RLQP"), kNoWords, canned_cycle,  "canned cycle: drill in steps of Q, break the chip; P dwell"},
    {"G74",  740, Group::motion,    Step::motion,    required, words("RL"),  kNoWords,   canned_cycle,  "canned cycle: left-hand tapping, F per revolution"},
    {"G76",  760, Group::motion,    Step::motion,    required, words("PIJRKQHEL"), words("PIJK"), threading_cycle, "threading on a lathe: pitch P, peak I, first cut J, depth K"},
    {"G80",  800, Group::motion,    Step::motion,    none,     kNoWords,     kNoWords,   cancel_motion, "no motion mode"},
    {"G81",  810, Group::motion,    Step::motion,    required, words("RL"), kNoWords, canned_cycle,  "canned cycle: drill"},
    {"G82",  820, Group::motion,    Step::motion,    required, words("RLP"), kNoWords, canned_cycle,  "canned cycle: drill, dwell P"},
    {"G83",  830, Group::motion,    Step::motion,    required, words("RLQP"), kNoWords, canned_cycle,  "canned cycle: drill in steps of Q, clear the hole; P dwell"},
    {"G84",  840, Group::motion,    Step::motion,    required, words("RL"),  kNoWords,   canned_cycle,  "canned cycle: right-hand tapping, F per revolution"},
    {"G85",  850, Group::motion,    Step::motion,    required, words("RL"), kNoWords, canned_cycle,  "canned cycle: bore, feed out"},
    {"G86",  860, Group::motion,    Step::motion,    required, words("RLP"), kNoWords, canned_cycle,  "canned cycle: bore, dwell P, spindle off, rapid out"},
    {"G87",  870, Group::motion,    Step::motion,    required, words("RLIJK"), kNoWords, canned_cycle,  "canned cycle: back boring up to K, inserted at I J"},
    {"G88",  880, Group::motion,    Step::motion,    required, words("RLP"), kNoWords,   canned_cycle,  "canned cycle: bore, dwell P, spindle off, retract by hand"},
    {"G89",  890, Group::motion,    Step::motion,    required, words("RLP"), kNoWords, canned_cycle,  "canned cycle: bore, dwell P, feed out"},
    {"G90",  900, Group::distance_mode, Step::distance_mode, none, kNoWords, kNoWords,   set_distance_mode, "absolute distances"},
    {"G90.1", 901, Group::arc_distance_mode, Step::arc_distance_mode, none, kNoWords, kNoWords, set_arc_distance_mode, "I J K are positions"},
    {"G91",  910, Group::distance_mode, Step::distance_mode, none, kNoWords, kNoWords,   set_distance_mode, "incremental distances"},
    {"G91.1", 911, Group::arc_distance_mode, Step::arc_distance_mode, none, kNoWords, kNoWords, set_arc_distance_mode, "I J K are distances from the start"},
    {"G92",  920, Group::non_modal, Step::non_modal, required, kNoWords,     kNoWords,   set_g92_offset, "give the present point these coordinates"},
    {"G92.1", 921, Group::non_modal, Step::non_modal, none,    kNoWords,     kNoWords,   clear_g92_offset, "G92 offset off and forgotten"},
    {"G92.2", 922, Group::non_modal, Step::non_modal, none,    kNoWords,     kNoWords,   suspend_g92_offset, "G92 offset off, kept in #5211-#5216"},
    {"G92.3", 923, Group::non_modal, Step::non_modal, none,    kNoWords,     kNoWords,   restore_g92_offset, "G92 offset from #5211-#5216"},
    {"G93",  930, Group::feed_mode, Step::feed_mode, none,     kNoWords,     kNoWords,   set_feed_mode, "inverse time feed"},
    {"G94",  940, Group::feed_mode, Step::feed_mode, none,     kNoWords,     kNoWords,   set_feed_mode, "feed per minute"},
    {"G95",  950, Group::feed_mode, Step::feed_mode, none,     kNoWords,     kNoWords,   set_feed_mode, "feed per revolution of the spindle"},
    {"G96",  960, Group::spindle_mode, Step::spindle_mode, none, words("D"), kNoWords,   set_spindle_mode, "S is the surface speed, m/min or feet/min; D largest rpm"},
    {"G97",  970, Group::spindle_mode, Step::spindle_mode, none, kNoWords,   kNoWords,   set_spindle_mode, "S is the spindle's speed, rpm"},
    {"G98",  980, Group::retract_mode, Step::retract_mode, none, kNoWords,   kNoWords,   set_retract_mode, "canned cycles retract to where they began"},
    {"G99",  990, Group::retract_mode, Step::retract_mode, none, kNoWords,   kNoWords,   set_retract_mode, "canned cycles retract to R"},
});
// clang-format on

constexpr std::int32_t kNumberLimit = 1000;
constexpr std::uint8_t kNoRow = 0xFF;
static_assert(kCodes.size() < kNoRow);

/// Number to row, so that finding a code costs one memory access.
constexpr auto kRowOfNumber = [] {
  std::array<std::uint8_t, kNumberLimit> rows{};
  rows.fill(kNoRow);
  for (std::size_t i = 0; i < kCodes.size(); ++i) {
    rows[static_cast<std::size_t>(kCodes[i].number)] = static_cast<std::uint8_t>(i);
  }
  return rows;
}();

}  // namespace

std::span<const Code> g_codes() { return kCodes; }

const Code* find_g_code(std::int32_t ten_times_number) {
  if (ten_times_number < 0 || ten_times_number >= kNumberLimit) return nullptr;
  const std::uint8_t row = kRowOfNumber[static_cast<std::size_t>(ten_times_number)];
  return row == kNoRow ? nullptr : &kCodes[row];
}

}  // namespace cnc::interp
