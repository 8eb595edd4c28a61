// What programs contain although the manual does not allow it, and what everybody expects to work.
//
// The interpreter accepts these with a warning (each kind once per program); with the setting
// `strict` they are errors.
#pragma once

#include <cstdint>
#include <string_view>

#include "config/error.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

enum class Habit : std::uint8_t {
  none,
  long_line,
  long_line_number,
  program_number,
  nested_comment,
  text_behind_statement,
  extra_bracket,
  format_directive,
  mode_without_axes,
  home_beside_rapid,
  third_centre_word,
  circle_without_end,
  cancel_beside_motion,
  text_outside_sub,
  code_outside_sub,
  ignored_code,
};

struct HabitInfo {
  Habit habit;
  ErrorCode code;
  std::string_view sentence;
  std::string_view allowed;  ///< what the manual wants
};
[[nodiscard]] const HabitInfo& habit_info(Habit habit);
[[nodiscard]] std::unexpected<Refusal> refuse_habit(Habit habit, Span span);

}  // namespace cnc::interp
