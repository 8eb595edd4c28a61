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
    {"M0",   0, Group::stopping,    Step::stop,        none, kNoWords, kNoWords, stop_program,     "stop until the operator goes on"},
    {"M1",   1, Group::stopping,    Step::stop,        none, kNoWords, kNoWords, stop_program,     "stop if the optional stop is on"},
    {"M2",   2, Group::stopping,    Step::stop,        none, kNoWords, kNoWords, end_program,      "end of program"},
    {"M3",   3, Group::spindle,     Step::spindle,     none, kNoWords, kNoWords, turn_spindle,     "spindle clockwise"},
    {"M4",   4, Group::spindle,     Step::spindle,     none, kNoWords, kNoWords, turn_spindle,     "spindle counter-clockwise"},
    {"M5",   5, Group::spindle,     Step::spindle,     none, kNoWords, kNoWords, turn_spindle,     "spindle off"},
    {"M6",   6, Group::tool_change, Step::tool_change, none, kNoWords, kNoWords, change_tool,      "tool change"},
    {"M7",   7, Group::coolant,     Step::coolant,     none, kNoWords, kNoWords, switch_coolant,   "mist on"},
    {"M8",   8, Group::coolant,     Step::coolant,     none, kNoWords, kNoWords, switch_coolant,   "flood on"},
    {"M9",   9, Group::coolant,     Step::coolant,     none, kNoWords, kNoWords, switch_coolant,   "mist and flood off"},
    {"M30", 30, Group::stopping,    Step::stop,        none, kNoWords, kNoWords, end_program,      "end of program"},
    {"M48", 48, Group::overrides,   Step::overrides,   none, kNoWords, kNoWords, switch_overrides, "overrides enabled"},
    {"M49", 49, Group::overrides,   Step::overrides,   none, kNoWords, kNoWords, switch_overrides, "overrides disabled"},
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
