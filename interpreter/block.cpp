#include "interpreter/block.h"

#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace cnc::interp {
namespace {

constexpr double kWholeTolerance = 0.0001;
constexpr double kMaxWhole = 1e9;

/// Words that are executed by themselves, with or without a code beside them.
[[nodiscard]] const Code* item_of_word(char letter) {
  switch (letter) {
    case 'F':
      return &feed_word();
    case 'S':
      return &speed_word();
    case 'T':
      return &tool_word();
    default:
      return nullptr;  // every other letter waits for a code to use it
  }
}

}  // namespace

std::optional<std::int32_t> whole_number(double value) {
  const double nearest = std::nearbyint(value);
  // Also false for NaN.
  if (!(std::abs(value - nearest) <= kWholeTolerance) || std::abs(nearest) > kMaxWhole) {
    return std::nullopt;
  }
  return static_cast<std::int32_t>(nearest);
}

void Block::clear() {
  head_ = {};
  settings_.clear();
}

void Block::take_over(const Block& other) {
  head_ = other.head_;
  dialect_ = other.dialect_;
  for (WordSet left = head_.words; left != 0; left &= left - 1) {
    const auto letter = static_cast<std::size_t>(std::countr_zero(left));
    values_[letter] = other.values_[letter];
    word_spans_[letter] = other.word_spans_[letter];
  }
  for (StepSet left = head_.steps; left != 0; left &= left - 1) {
    const auto step = static_cast<std::size_t>(std::countr_zero(left));
    codes_[step] = other.codes_[step];
    code_spans_[step] = other.code_spans_[step];
  }
  settings_ = other.settings_;
  comment_ = other.comment_;
}

Accepted Block::add_word(char letter, double value, Span span) {
  if (letter == 'G') return add_g_code(value, span);
  if (letter == 'M') return add_m_code(value, span);
  if (!(std::abs(value) <= kMaxWordValue)) {  // NaN too
    return refuse(ErrorCode::word_out_of_range, span,
                  fmt::format("{} cannot be {:.6g}.", letter, value),
                  fmt::format("Values up to {:.0e}.", kMaxWordValue));
  }
  if (has(letter)) {
    return refuse(ErrorCode::word_repeated, span,
                  fmt::format("The word {} stands twice on this line.", letter),
                  "Each letter but G and M once per line.");
  }
  head_.words |= word_bit(letter);
  values_[index(letter)] = value;
  word_spans_[index(letter)] = span;
  if (const Code* item = item_of_word(letter)) put_code(*item, span);
  return {};
}

Accepted Block::rename_word(char from, char to) {
  head_.words &= ~word_bit(from);
  return add_word(to, value(from), span_of(from));
}

Accepted Block::add_g_code(double value, Span span) {
  head_.has_g_code = true;
  const auto number = whole_number(value * 10.0);
  const Code* code = number ? dialect_->find_g_code(*number) : nullptr;
  if (code != nullptr) return add_code(*code, span);
  if (dialect_->ignores_unknown_g) {
    note(Habit::ignored_code, span);
    return {};
  }
  return refuse(ErrorCode::unknown_g_code, span,
                fmt::format("G{:.10g} is not a code that this interpreter knows.", value),
                names_of(dialect_->g_codes));
}

Accepted Block::add_m_code(double value, Span span) {
  const auto number = whole_number(value);
  if (!number || *number < 0 || *number > kMaxMCode) return refuse_m_code(value, span);
  if (head_.m_codes == dialect_->max_m_codes) {
    return refuse(ErrorCode::too_many_m_codes, span,
                  fmt::format("M{} is one M code too many on this line.", *number),
                  fmt::format("At most {} per line.", dialect_->max_m_codes));
  }
  head_.m_numbers[head_.m_codes++] = *number;
  head_.m_span = span;
  if (const Code* code = dialect_->find_m_code(*number)) return add_code(*code, span);
  head_.unknown_m = number;
  return {};
}

std::unexpected<Refusal> Block::refuse_m_code(double number, Span span) const {
  return refuse(ErrorCode::unknown_m_code, span,
                fmt::format("M{:.10g} is not a code that this interpreter knows.", number),
                names_of(dialect_->m_codes));
}

Accepted Block::add_code(const Code& code, Span span) {
  const GroupSet group = GroupSet{1} << static_cast<unsigned>(code.group);
  if ((head_.groups & group) != 0) return settle_conflict(code, span);
  head_.groups |= group;
  put_code(code, span);
  return {};
}

// Two codes of one group are an error, but for one pair that many CAM systems begin with: G80
// beside another motion ("G00 G17 G40 G49 G80"). There G80 counts, which moves nothing and lets no
// axis word stand on the line.
Accepted Block::settle_conflict(const Code& code, Span span) {
  constexpr std::int32_t kG80 = 800;
  const Code& there = holder_of(code.group);
  if (code.group == Group::motion && (code.number == kG80) != (there.number == kG80)) {
    note(Habit::cancel_beside_motion, span);
    if (code.number == kG80) put_code(code, span);
    return {};
  }
  return refuse(ErrorCode::modal_group_conflict, span,
                fmt::format("{} cannot stand on one line with {}: they belong to the same group.",
                            code.name, there.name),
                "One code of a modal group per line.");
}

const Code& Block::holder_of(Group group) const {
  StepSet steps = head_.steps;
  while (codes_[static_cast<std::size_t>(std::countr_zero(steps))]->group != group) {
    steps &= steps - 1;  // the group's bit is set, so a code of it is there
  }
  return *codes_[static_cast<std::size_t>(std::countr_zero(steps))];
}

void Block::put_code(const Code& code, Span span) {
  head_.steps |= step_bit(code.step);
  codes_[index(code.step)] = &code;
  code_spans_[index(code.step)] = span;
}

void Block::set_comment(const Message& message) {
  comment_ = message;
  put_code(comment_item(), {});
}

std::optional<double> Block::find(char letter) const {
  if (!has(letter)) return std::nullopt;
  return value(letter);
}

}  // namespace cnc::interp
