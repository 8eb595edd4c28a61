// The codes that the interpreter knows, as rows of tables: modal group, when it is executed, which
// words belong to it and the function that carries it out. Adding a code means adding a row in
// gcode_table.cpp or mcode_table.cpp and, mostly, one small handler (handlers.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "interpreter/refusal.h"

namespace cnc::interp {

class Execution;

/// Bit of a letter in a set of words.
using WordSet = std::uint32_t;
[[nodiscard]] constexpr WordSet word_bit(char upper_letter) {
  return WordSet{1} << (upper_letter - 'A');
}
[[nodiscard]] constexpr WordSet words(std::string_view upper_letters) {
  WordSet set = 0;
  for (const char letter : upper_letters) set |= word_bit(letter);
  return set;
}
inline constexpr WordSet kNoWords = 0;
inline constexpr WordSet kAxisWords = words("XYZABC");
/// Words that mean something on every line, whatever codes stand there.
inline constexpr WordSet kFreeWords = words("FST");

/// Items of a line in the order in which they are executed: table 3-7 of the manual.
enum class Step : std::uint8_t {
  comment,
  feed_mode,
  feed,
  head,  ///< M90 … M97: S and M3 are for the head of their line
  spindle_mode,
  speed,
  tool,
  tool_change,
  drives,
  spindle,
  spindle_direction_output,
  spindle_pwm_output,
  coolant,
  overrides,
  hold_input,
  torch_set_point,
  torch_height,
  clamp,
  heating,
  fan,
  axis_scale,
  io,
  dwell,
  plane,
  units,
  cutter_compensation,
  tool_length,
  work_system,
  path_control,
  distance_mode,
  arc_distance_mode,
  retract_mode,
  scaling,
  rotation,
  non_modal,            ///< G10 G28 G30 G92
  machine_coordinates,  ///< G53, read by the motion that follows
  motion,
  after_motion,  ///< M codes of dialects that execute them behind the motion of their line
  stop,
};
inline constexpr std::size_t kStepCount = static_cast<std::size_t>(Step::stop) + 1;

/// Steps of a line as bits, bit 0 the first.
using StepSet = std::uint64_t;
static_assert(kStepCount <= 64);

/// Groups of a line as bits.
using GroupSet = std::uint64_t;

/// Modal groups: table 3-3, and for codes that it leaves out those that set the same thing. Two
/// codes of one group cannot stand on a line.
enum class Group : std::uint8_t {
  non_modal,
  motion,
  plane,
  distance_mode,
  arc_distance_mode,
  feed_mode,
  spindle_mode,
  units,
  cutter_compensation,
  tool_length,
  work_system,
  path_control,
  stopping,
  tool_change,
  spindle,
  coolant,
  overrides,
  retract_mode,
  scaling,
  rotation,
  io,                        ///< group 5
  head,                      ///< group 10
  torch_height,              ///< Enable THC
  torch_set_point,           ///< M22 M23
  clamp,                     ///< A axis clamp
  hold_input,                ///< M53
  drives,                    ///< M80 M81
  spindle_direction_output,  ///< M84 M85
  spindle_pwm_output,        ///< M86 M87
  heating,                   ///< M104 M109 M140 M143 M190
  fan,                       ///< M106 M107
  axis_scale,                ///< M100
  word,                      ///< F S T and comments: not codes, but executed like them
};

/// What a code does with the words X Y Z A B C of its line.
enum class AxisUse : std::uint8_t { none, optional, required };

using Handler = Accepted (*)(Execution&);

struct Code {
  std::string_view name;  ///< "G59.1"
  std::int32_t number;    ///< G: ten times the number; M: the number
  Group group;
  Step step;
  AxisUse axes;
  WordSet uses;   ///< words that belong to it, besides axis words
  WordSet needs;  ///< those of them that must be there
  Handler handler;
  std::string_view meaning;
};

[[nodiscard]] std::span<const Code> g_codes();
[[nodiscard]] std::span<const Code> m_codes();

/// Row of a code; nullptr for a number that is not in the table.
[[nodiscard]] const Code* find_g_code(std::int32_t ten_times_number);
[[nodiscard]] const Code* find_m_code(std::int32_t number);

/// The words F, S and T, and the comment of a line, as items to execute.
[[nodiscard]] const Code& feed_word();
[[nodiscard]] const Code& speed_word();
[[nodiscard]] const Code& tool_word();
[[nodiscard]] const Code& comment_item();

/// "G0 G1 G2 …" of all rows; of those that use the word `letter`.
[[nodiscard]] std::string names_of(std::span<const Code> codes);
[[nodiscard]] std::string codes_with_word(char letter);

}  // namespace cnc::interp
