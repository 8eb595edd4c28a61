#include "interpreter/habit.h"

#include <array>

namespace cnc::interp {
namespace {

constexpr auto kHabits = std::to_array<HabitInfo>({
    {Habit::none, ErrorCode::manual_is_stricter, "", ""},
    {Habit::long_line, ErrorCode::manual_is_stricter, "This line has more than 256 characters.",
     "At most 256 characters per line."},
    {Habit::long_line_number, ErrorCode::manual_is_stricter,
     "This line number has more than five digits.", "N0 to N99999."},
    {Habit::program_number, ErrorCode::manual_is_stricter,
     "O numbers mean nothing here: this one is skipped.", "Programs without an O number."},
    {Habit::nested_comment, ErrorCode::manual_is_stricter,
     "A \"(\" stands within this comment, which ends at the first \")\".",
     "No parenthesis within a comment."},
    {Habit::text_behind_statement, ErrorCode::manual_is_stricter,
     "The text behind this statement is skipped.", "A comment, or nothing."},
    {Habit::extra_bracket, ErrorCode::manual_is_stricter, "A \"]\" too many is skipped.",
     "As many \"]\" as \"[\"."},
    {Habit::format_directive, ErrorCode::manual_is_stricter,
     "The format directive behind the text is skipped.", "Texts and values only."},
    {Habit::mode_without_axes, ErrorCode::manual_is_stricter,
     "This motion code has no axis words: it only sets the mode.", "X Y Z A B C"},
    {Habit::home_beside_rapid, ErrorCode::manual_is_stricter,
     "G0 beside G28 or G30 only sets the mode: the axis words belong to the home move.",
     "G28 and G30 without G0."},
    {Habit::third_centre_word, ErrorCode::manual_is_stricter,
     "This centre word is 0 and does not belong to the plane of the arc: it is skipped.",
     "The two centre words of the plane."},
    {Habit::circle_without_end, ErrorCode::manual_is_stricter,
     "This arc names no end point in its plane: it is a full circle.",
     "At least one of the two axis words of the plane."},
    {Habit::cancel_beside_motion, ErrorCode::manual_is_stricter,
     "G80 beside another motion code: G80 counts.", "One code of a modal group per line."},
    {Habit::text_outside_sub, ErrorCode::code_outside_sub,
     "This line of the macro file is no statement and is skipped.", "Comments and subs."},
    {Habit::code_outside_sub, ErrorCode::code_outside_sub,
     "This line of the macro file stands outside of all subs and is not executed.",
     "Outside of subs only #n=value, if and while are executed, when the file is loaded."},
    {Habit::ignored_code, ErrorCode::code_ignored, "This code is ignored.",
     "The codes of the chosen dialect."},
});

static_assert(kHabits.size() == static_cast<std::size_t>(Habit::ignored_code) + 1);

}  // namespace

const HabitInfo& habit_info(Habit habit) { return kHabits.at(static_cast<std::size_t>(habit)); }

std::unexpected<Refusal> refuse_habit(Habit habit, Span span) {
  const HabitInfo& info = habit_info(habit);
  return refuse(info.code, span, std::string(info.sentence), std::string(info.allowed));
}

}  // namespace cnc::interp
