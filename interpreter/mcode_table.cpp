// Every M code of this interpreter (manual, tables 3-3 and 3-6), and the words that act by
// themselves.
#include <algorithm>
#include <array>

#include "interpreter/code_table.h"
#include "interpreter/handlers.h"

namespace cnc::interp {
namespace {

using enum AxisUse;

// clang-format off
constexpr auto kCodes = std::to_array<Code>({
    {"M0",     0, Group::stopping,                 Step::stop,                     none, kNoWords,      kNoWords,   stop_program,          "stop until the operator goes on"},
    {"M1",     1, Group::stopping,                 Step::stop,                     none, kNoWords,      kNoWords,   stop_program,          "stop if the optional stop is on; 3D printer: heaters and fans off"},
    {"M2",     2, Group::stopping,                 Step::stop,                     none, kNoWords,      kNoWords,   end_program,           "end of program"},
    {"M3",     3, Group::spindle,                  Step::spindle,                  none, kNoWords,      kNoWords,   turn_spindle,          "spindle clockwise"},
    {"M4",     4, Group::spindle,                  Step::spindle,                  none, kNoWords,      kNoWords,   turn_spindle,          "spindle counter-clockwise"},
    {"M5",     5, Group::spindle,                  Step::spindle,                  none, kNoWords,      kNoWords,   turn_spindle,          "spindle off"},
    {"M6",     6, Group::tool_change,              Step::tool_change,              none, kNoWords,      kNoWords,   change_tool,           "tool change"},
    {"M7",     7, Group::coolant,                  Step::coolant,                  none, kNoWords,      kNoWords,   switch_coolant,        "mist on"},
    {"M8",     8, Group::coolant,                  Step::coolant,                  none, kNoWords,      kNoWords,   switch_coolant,        "flood on"},
    {"M9",     9, Group::coolant,                  Step::coolant,                  none, kNoWords,      kNoWords,   switch_coolant,        "mist and flood off"},
    {"M20",   20, Group::torch_height,             Step::torch_height,             none, kNoWords,      kNoWords,   switch_torch_height,   "torch height control on"},
    {"M21",   21, Group::torch_height,             Step::torch_height,             none, kNoWords,      kNoWords,   switch_torch_height,   "torch height control off"},
    {"M22",   22, Group::torch_set_point,          Step::torch_set_point,          none, words("Q"),    words("Q"), set_torch_height,      "set point Q of the torch height"},
    {"M23",   23, Group::torch_set_point,          Step::torch_set_point,          none, words("Q"),    words("Q"), set_torch_height,      "set point Q of the torch height"},
    {"M26",   26, Group::clamp,                    Step::clamp,                    none, words("P"),    kNoWords,   switch_clamp,          "clamp the A axis; P output of the brake"},
    {"M27",   27, Group::clamp,                    Step::clamp,                    none, words("P"),    kNoWords,   switch_clamp,          "release the A axis; P output of the brake"},
    {"M30",   30, Group::stopping,                 Step::stop,                     none, kNoWords,      kNoWords,   end_program,           "end of program"},
    {"M48",   48, Group::overrides,                Step::overrides,                none, kNoWords,      kNoWords,   switch_overrides,      "overrides enabled"},
    {"M49",   49, Group::overrides,                Step::overrides,                none, kNoWords,      kNoWords,   switch_overrides,      "overrides disabled"},
    {"M50",   50, Group::overrides,                Step::overrides,                none, words("P"),    words("P"), set_override,          "feed override P percent; below 0: disabled"},
    {"M51",   51, Group::overrides,                Step::overrides,                none, words("P"),    words("P"), set_override,          "speed override P percent; below 0: disabled"},
    {"M52",   52, Group::overrides,                Step::overrides,                none, words("P"),    kNoWords,   switch_override_input, "feed override from the analog input: P1 on, P0 off"},
    {"M53",   53, Group::hold_input,               Step::hold_input,               none, words("P"),    kNoWords,   switch_hold_input,     "feed hold input: P1 acts, P0 does not"},
    {"M54",   54, Group::io,                       Step::io,                       none, words("PEQ"),  kNoWords,   set_output,            "output P on; PWM output E to Q per mille"},
    {"M55",   55, Group::io,                       Step::io,                       none, words("P"),    words("P"), clear_output,          "output P off"},
    {"M56",   56, Group::io,                       Step::io,                       none, words("PELQ"), kNoWords,   read_input,            "read input P or analog input E into #5399; L1 L2 wait for high or low, at most Q seconds"},
    {"M60",   60, Group::stopping,                 Step::stop,                     none, kNoWords,      kNoWords,   stop_program,          "stop between the pieces of a nest; spindle and coolant stay on"},
    {"M80",   80, Group::drives,                   Step::drives,                   none, kNoWords,      kNoWords,   switch_drives,         "drives on"},
    {"M81",   81, Group::drives,                   Step::drives,                   none, kNoWords,      kNoWords,   switch_drives,         "drives off"},
    {"M84",   84, Group::spindle_direction_output, Step::spindle_direction_output, none, kNoWords,      kNoWords,   switch_spindle_output, "spindle direction output on"},
    {"M85",   85, Group::spindle_direction_output, Step::spindle_direction_output, none, kNoWords,      kNoWords,   switch_spindle_output, "spindle direction output off"},
    {"M86",   86, Group::spindle_pwm_output,       Step::spindle_pwm_output,       none, kNoWords,      kNoWords,   switch_spindle_output, "spindle PWM output on, as S says"},
    {"M87",   87, Group::spindle_pwm_output,       Step::spindle_pwm_output,       none, kNoWords,      kNoWords,   switch_spindle_output, "spindle PWM output off"},
    {"M90",   90, Group::head,                     Step::head,                     none, words("P"),    kNoWords,   select_head,           "head: spindle 0; P1 moves it to where the head before it was"},
    {"M91",   91, Group::head,                     Step::head,                     none, words("PQ"),   kNoWords,   select_head,           "head: spindle 1; P1 moves it to where the head before it was, Q1 measures its offset"},
    {"M92",   92, Group::head,                     Step::head,                     none, words("PQ"),   kNoWords,   select_head,           "head: spindle 2; P1 moves it to where the head before it was, Q1 measures its offset"},
    {"M93",   93, Group::head,                     Step::head,                     none, words("PQ"),   kNoWords,   select_head,           "head: spindle 2 (as M92); P1 moves it to where the head before it was, Q1 measures its offset"},
    {"M95",   95, Group::head,                     Step::head,                     none, words("PQ"),   kNoWords,   select_head,           "head: probe; P1 moves it to where the head before it was, Q1 measures its offset"},
    {"M97",   97, Group::head,                     Step::head,                     none, words("PQ"),   kNoWords,   select_head,           "head: camera; P1 moves it to where the head before it was, Q1 measures its offset"},
    {"M100", 100, Group::axis_scale,               Step::axis_scale,               none, words("P"),    words("P"), scale_axis,            "steps per unit of the A axis times P"},
    {"M104", 104, Group::heating,                  Step::heating,                  none, words("S"),    words("S"), set_temperature,       "extruder to S degrees"},
    {"M106", 106, Group::fan,                      Step::fan,                      none, words("S"),    kNoWords,   set_fan,               "work piece fan on, S of 255"},
    {"M107", 107, Group::fan,                      Step::fan,                      none, kNoWords,      kNoWords,   set_fan,               "work piece fan off"},
    {"M109", 109, Group::heating,                  Step::heating,                  none, words("S"),    kNoWords,   set_temperature,       "extruder to S degrees, wait for it"},
    {"M140", 140, Group::heating,                  Step::heating,                  none, words("S"),    words("S"), set_temperature,       "bed to S degrees"},
    {"M143", 143, Group::heating,                  Step::heating,                  none, words("S"),    words("S"), set_temperature_limit, "extruder never above S degrees"},
    {"M190", 190, Group::heating,                  Step::heating,                  none, words("S"),    kNoWords,   set_temperature,       "bed to S degrees, wait for it"},
});

constexpr Code kFeedWord   {"F",       0, Group::word, Step::feed,    none, kNoWords, kNoWords, set_feed,     "feed rate"};
constexpr Code kSpeedWord  {"S",       0, Group::word, Step::speed,   none, kNoWords, kNoWords, set_speed,    "spindle speed"};
constexpr Code kToolWord   {"T",       0, Group::word, Step::tool,    none, kNoWords, kNoWords, select_tool,  "tool"};
constexpr Code kCommentItem{"comment", 0, Group::word, Step::comment, none, kNoWords, kNoWords, show_comment, "comment or message"};
// clang-format on

}  // namespace

std::span<const Code> m_codes() { return kCodes; }

const Code* find_m_code(std::int32_t number) {
  const auto row = std::ranges::find(kCodes, number, &Code::number);
  return row == kCodes.end() ? nullptr : &*row;
}

const Code& feed_word() { return kFeedWord; }
const Code& speed_word() { return kSpeedWord; }
const Code& tool_word() { return kToolWord; }
const Code& comment_item() { return kCommentItem; }

std::string names_of(std::span<const Code> codes) {
  std::string names;
  for (const Code& code : codes) {
    if (!names.empty()) names += ' ';
    names += code.name;
  }
  return names;
}

std::string codes_with_word(char letter) {
  std::string names;
  for (const std::span<const Code> table : {g_codes(), m_codes()}) {
    for (const Code& code : table) {
      if ((code.uses & word_bit(letter)) == 0) continue;
      if (!names.empty()) names += ' ';
      names += code.name;
    }
  }
  return names;
}

}  // namespace cnc::interp
