#include "interpreter/check_block.h"

#include <bit>
#include <fmt/format.h>
#include <optional>

namespace cnc::interp {
namespace {

constexpr std::int32_t kG0 = 0;
constexpr std::int32_t kG1 = 10;
constexpr std::int32_t kG2 = 20;
constexpr std::int32_t kG3 = 30;
constexpr std::int32_t kProbe = 382;  // G38.2
constexpr std::int32_t kG80 = 800;

[[nodiscard]] char first_letter(WordSet set) {
  return static_cast<char>('A' + std::countr_zero(set));
}

[[nodiscard]] bool is_straight(std::int32_t motion) { return motion == kG0 || motion == kG1; }

[[nodiscard]] bool is_arc(std::int32_t motion) { return motion == kG2 || motion == kG3; }

[[nodiscard]] bool takes_axes(const Code& code) { return code.axes != AxisUse::none; }

/// "G1 F300", "G0 G90 G17 G40" set the mode beside other things, with which CAM systems begin; and
/// "G1" alone does, with which the delivered change_tool ends. The manual wants axis words.
[[nodiscard]] bool only_sets_mode(const Block& block, const Code& motion) {
  const bool has_more = block.steps() != Block::step_bit(Step::motion);
  const bool stands_alone = block.words() == kNoWords;
  return is_straight(motion.number) && (has_more || stands_alone) &&
         !block.has(Step::machine_coordinates);
}

/// A full circle needs no end point: "G2 I5".
[[nodiscard]] bool is_full_circle(const Block& block, const Code& motion) {
  return is_arc(motion.number) && (block.words() & words("IJK")) != 0;
}

Accepted check_axes_of(Block& block, Step step) {
  const Code& code = block.code(step);
  const bool has_axes = (block.words() & kAxisWords) != 0;
  if (code.axes != AxisUse::required || has_axes || is_full_circle(block, code)) return {};
  if (only_sets_mode(block, code)) {
    block.note(Habit::mode_without_axes, block.span_of(step));
    return {};
  }
  return refuse(ErrorCode::axis_words_missing, block.span_of(step),
                fmt::format("{} needs at least one axis word.", code.name), "X Y Z A B C");
}

Accepted check_machine_coordinates(const Block& block, const ModalState& modal) {
  if (!block.has(Step::machine_coordinates)) return {};
  const Span span = block.span_of(Step::machine_coordinates);
  if ((block.words() & kAxisWords) == 0) {
    return refuse(ErrorCode::axis_words_missing, span, "G53 needs at least one axis word.",
                  "X Y Z A B C");
  }
  const std::int32_t motion =
      block.has(Step::motion) ? block.code(Step::motion).number : modal.motion;
  if (is_straight(motion) || motion == kProbe) return {};
  return refuse(ErrorCode::machine_move_not_straight, span,
                "G53 moves in machine coordinates with G0, G1 or G38.2 only.",
                "G0, G1 or G38.2 on this line.");
}

/// "G0 G91 G28 Z0", with which post processors end: G0 is how G28 moves anyway, so it only sets the
/// mode and the axis words belong to G28.
[[nodiscard]] bool homes_by_rapid(const Block& block) {
  constexpr std::int32_t kG28 = 280;
  constexpr std::int32_t kG30 = 300;
  const std::int32_t home = block.code(Step::non_modal).number;
  return block.code(Step::motion).number == kG0 && (home == kG28 || home == kG30);
}

/// Axis words belong to exactly one code; without any they belong to the motion in force.
Accepted assign_axes(Block& block, const ModalState& modal) {
  std::optional<Step> owner;
  for (const Step step : {Step::scaling, Step::rotation, Step::non_modal, Step::motion}) {
    if (!block.has(step) || !takes_axes(block.code(step))) continue;
    if (step == Step::motion && owner == Step::non_modal && homes_by_rapid(block)) {
      block.note(Habit::home_beside_rapid, block.span_of(step));
      continue;
    }
    if (owner) {
      return refuse(ErrorCode::axis_words_claimed_twice, block.span_of(step),
                    fmt::format("{} and {} both use the axis words of this line.",
                                block.code(*owner).name, block.code(step).name),
                    "Two lines.");
    }
    owner = step;
  }
  const bool has_axes = (block.words() & kAxisWords) != 0;
  if (!has_axes || owner) return {};

  const Span span = block.span_of(first_letter(block.words() & kAxisWords));
  if (block.has(Step::motion) || modal.motion == kG80) {
    return refuse(ErrorCode::axis_words_not_allowed, span,
                  "These axis words belong to no motion: G80 is active.",
                  "A motion code, for example G0 or G1.");
  }
  block.put_code(*find_g_code(modal.motion), span);
  return {};
}

/// S of "M104 S200" is a temperature: the code takes it, and it is no spindle speed any more. Which
/// words were taken so.
WordSet take_free_words(Block& block) {
  if ((block.words() & kFreeWords) == 0) return kNoWords;
  WordSet taken = kNoWords;
  for (StepSet steps = block.steps(); steps != 0; steps &= steps - 1) {
    taken |= block.code(Step{static_cast<std::uint8_t>(std::countr_zero(steps))}).uses;
  }
  taken &= kFreeWords & block.words();
  if ((taken & word_bit('F')) != 0) block.drop_step(Step::feed);
  if ((taken & word_bit('S')) != 0) block.drop_step(Step::speed);
  if ((taken & word_bit('T')) != 0) block.drop_step(Step::tool);
  return taken;
}

/// Every word belongs to a code of the line, and to one only.
Accepted check_words(Block& block) {
  WordSet used = kFreeWords & ~take_free_words(block);
  for (StepSet steps = block.steps(); steps != 0; steps &= steps - 1) {
    const Step step{static_cast<std::uint8_t>(std::countr_zero(steps))};
    const Code& code = block.code(step);
    if (const WordSet twice = used & code.uses & block.words(); twice != 0) {
      const char letter = first_letter(twice);
      return refuse(ErrorCode::word_claimed_twice, block.span_of(letter),
                    fmt::format("More than one code of this line uses the word {}.", letter),
                    "Two lines.");
    }
    if (const WordSet missing = code.needs & ~block.words(); missing != 0) {
      return refuse(ErrorCode::word_missing, block.span_of(step),
                    fmt::format("{} needs the word {}.", code.name, first_letter(missing)));
    }
    if (Accepted axes = check_axes_of(block, step); !axes) return axes;
    used |= code.uses;
    if (takes_axes(code)) used |= kAxisWords;
  }
  const WordSet unused = block.words() & ~used;
  if (unused == 0) return {};
  const char letter = first_letter(unused);
  const std::string users = codes_with_word(letter);
  return refuse(ErrorCode::word_unused, block.span_of(letter),
                fmt::format("The word {} belongs to no code of this line.", letter),
                users.empty() ? "No code uses it." : "Codes with this word: " + users);
}

}  // namespace

Accepted check_block(Block& block, const ModalState& modal) {
  if (Accepted g53 = check_machine_coordinates(block, modal); !g53) return g53;
  if (Accepted axes = assign_axes(block, modal); !axes) return axes;
  return check_words(block);
}

}  // namespace cnc::interp
