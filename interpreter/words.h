// Reading a word as what its code needs: a whole number, a number of a range, a switch.
#pragma once

#include "interpreter/execution.h"

namespace cnc::interp {

/// The word `letter` as a whole number from `lowest` to `highest`.
[[nodiscard]] Parsed<std::int32_t> whole_word(const Execution& x, char letter, std::int32_t lowest,
                                              std::int32_t highest);
/// The word `letter` as a number from `lowest` to `highest`.
[[nodiscard]] Parsed<double> word_within(const Execution& x, char letter, double lowest,
                                         double highest);
/// "P1" and "P0"; `if_missing` without the word.
[[nodiscard]] Parsed<bool> switch_word(const Execution& x, char letter, bool if_missing);

/// Refuses two words of which a code takes one.
[[nodiscard]] Accepted check_not_both(const Execution& x, char one, char other);

}  // namespace cnc::interp
