#include "interpreter/words.h"

#include <fmt/format.h>

namespace cnc::interp {
namespace {

std::unexpected<Refusal> refuse_value(const Execution& x, char letter, std::string allowed) {
  return refuse(
      ErrorCode::word_out_of_range, x.block().span_of(letter),
      fmt::format("{} cannot be {}{:.10g}.", x.code_name(), letter, x.block().value(letter)),
      std::move(allowed));
}

}  // namespace

Parsed<std::int32_t> whole_word(const Execution& x, char letter, std::int32_t lowest,
                                std::int32_t highest) {
  const auto number = whole_number(x.block().value(letter));
  if (number && *number >= lowest && *number <= highest) return *number;
  return refuse_value(x, letter, fmt::format("{} from {} to {}.", letter, lowest, highest));
}

Parsed<double> word_within(const Execution& x, char letter, double lowest, double highest) {
  const double value = x.block().value(letter);
  if (value >= lowest && value <= highest) return value;
  return refuse_value(x, letter, fmt::format("{} from {} to {}.", letter, lowest, highest));
}

Parsed<bool> switch_word(const Execution& x, char letter, bool if_missing) {
  if (!x.block().has(letter)) return if_missing;
  const auto number = whole_number(x.block().value(letter));
  if (number == 0 || number == 1) return number == 1;
  return refuse_value(x, letter, fmt::format("{}1 or {}0.", letter, letter));
}

Accepted check_not_both(const Execution& x, char one, char other) {
  if (!x.block().has(one) || !x.block().has(other)) return {};
  return refuse(ErrorCode::words_exclude_each_other, x.block().span_of(other),
                fmt::format("{} takes {} or {}, not both.", x.code_name(), one, other),
                fmt::format("{} alone, or {} alone.", one, other));
}

}  // namespace cnc::interp
