// What stands on one line of a program, as values: words, codes, parameter settings and the
// comment.
//
// Filled by the parser (constants) and by the expression code (everything else), checked as a whole
// by check_block(), then executed in the order of its steps. Clearing and copying a block touches
// little of it: the bit sets say which array elements mean anything.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "config/axis.h"
#include "interpreter/canonical.h"
#include "interpreter/code_table.h"
#include "interpreter/dialect.h"
#include "interpreter/habit.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

/// "#3 = 15": takes effect after everything else of the line.
struct ParameterSetting {
  std::int32_t number = 0;
  double value = 0.0;
  Span span;
};

class Block {
 public:
  void clear();
  /// Becomes `other`, copying only what that holds: a loop does this for every line.
  void take_over(const Block& other);

  /// Each refuses what cannot stand on the line together with what is already there.
  Accepted add_word(char upper_letter, double value, Span span);
  /// `from` stands on the line.
  Accepted rename_word(char from, char to);
  void add_setting(const ParameterSetting& setting) { settings_.push_back(setting); }
  /// Remembers the first thing on the line that the manual does not allow.
  void note(Habit habit, Span span) {
    if (head_.habit == Habit::none) {
      head_.habit = habit;
      head_.habit_span = span;
    }
  }
  [[nodiscard]] Habit habit() const { return head_.habit; }
  [[nodiscard]] Span habit_span() const { return head_.habit_span; }
  /// The codes that words are looked up in.
  void set_dialect(const Dialect& dialect) { dialect_ = &dialect; }

  /// Only the last comment of a line counts (manual 3.2.5).
  void set_comment(const Message& message);

  [[nodiscard]] std::unexpected<Refusal> refuse_m_code(double number, Span span) const;

  /// The code that is executed at its step; replaces what was there. For implied motion.
  void put_code(const Code& code, Span span);
  void drop_step(Step step) { head_.steps &= ~step_bit(step); }

  [[nodiscard]] WordSet words() const { return head_.words; }
  [[nodiscard]] bool has(char upper_letter) const {
    return (head_.words & word_bit(upper_letter)) != 0;
  }
  [[nodiscard]] double value(char upper_letter) const { return values_[index(upper_letter)]; }
  [[nodiscard]] std::optional<double> find(char upper_letter) const;
  [[nodiscard]] Span span_of(char upper_letter) const { return word_spans_[index(upper_letter)]; }

  [[nodiscard]] bool has(Axis axis) const { return has(axis_name(axis)[0]); }
  [[nodiscard]] double value(Axis axis) const { return value(axis_name(axis)[0]); }

  /// Set of steps as bits, in the order of execution from bit 0 on.
  [[nodiscard]] StepSet steps() const { return head_.steps; }
  [[nodiscard]] bool has(Step step) const { return (head_.steps & step_bit(step)) != 0; }
  [[nodiscard]] const Code& code(Step step) const { return *codes_[index(step)]; }
  [[nodiscard]] Span span_of(Step step) const { return code_spans_[index(step)]; }

  [[nodiscard]] const std::vector<ParameterSetting>& settings() const { return settings_; }
  [[nodiscard]] const Message& comment() const { return comment_; }
  /// M1 … M999, those without a code for subs.
  static constexpr std::int32_t kMaxMCode = 999;
  /// M numbers in the order of the line; one of them may be unknown.
  [[nodiscard]] std::span<const std::int32_t> m_numbers() const {
    return {head_.m_numbers.data(), head_.m_codes};
  }
  [[nodiscard]] Span m_span() const { return head_.m_span; }
  [[nodiscard]] bool has_g_code() const { return head_.has_g_code; }
  /// The M number that is no code of the dialect, if any: only a sub can carry it out.
  [[nodiscard]] std::optional<std::int32_t> unknown_m() const { return head_.unknown_m; }
  [[nodiscard]] bool empty() const {
    return head_.steps == 0 && head_.words == 0 && settings_.empty() && head_.m_codes == 0;
  }

  [[nodiscard]] static constexpr StepSet step_bit(Step step) {
    return StepSet{1} << static_cast<unsigned>(step);
  }

 private:
  static constexpr std::size_t kLetters = 26;
  static constexpr std::uint8_t kMaxMCodes = 4;  // manual 3.2.5; a dialect may allow fewer

  static constexpr std::size_t index(char letter) { return static_cast<std::size_t>(letter - 'A'); }
  static constexpr std::size_t index(Step step) { return static_cast<std::size_t>(step); }

  Accepted add_g_code(double value, Span span);
  Accepted add_m_code(double value, Span span);
  Accepted add_code(const Code& code, Span span);
  Accepted settle_conflict(const Code& code, Span span);
  [[nodiscard]] const Code& holder_of(Group group) const;

  /// Everything but the large arrays.
  struct Head {
    WordSet words = 0;
    StepSet steps = 0;
    GroupSet groups = 0;
    std::uint8_t m_codes = 0;
    bool has_g_code = false;
    Habit habit = Habit::none;
    Span habit_span;
    Span m_span;  ///< of the last M
    std::array<std::int32_t, kMaxMCodes> m_numbers{};
    std::optional<std::int32_t> unknown_m;
  };

  Head head_;
  const Dialect* dialect_ = &dialect(DialectId::eding);
  std::array<double, kLetters> values_{};
  std::array<Span, kLetters> word_spans_{};
  std::array<const Code*, kStepCount> codes_{};
  std::array<Span, kStepCount> code_spans_{};
  std::vector<ParameterSetting> settings_;
  Message comment_;
};

/// No machine has a word or a stored length as large as this; sums of such values stay finite.
inline constexpr double kMaxWordValue = 1e9;

/// `value` as the whole number that it is meant to be: within 0.0001 of one (manual 3.2.2.1).
[[nodiscard]] std::optional<std::int32_t> whole_number(double value);

}  // namespace cnc::interp
