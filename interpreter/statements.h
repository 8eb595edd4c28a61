// Statements of the language's own with arguments (manual 4.2.4, 2.2.5.5, 2.10, 2.1.9): a table of
// what each is followed by and what carries it out.
#pragma once

#include <span>
#include <string_view>

#include "interpreter/refusal.h"

namespace cnc::interp {

class Execution;

/// A word or quoted text, or a value.
struct Argument {
  bool is_text = false;
  std::string_view text;  ///< in the program's text
  double value = 0.0;
  Span span{};
};
using Arguments = std::span<const Argument>;

struct SpecialStatement {
  std::string_view name;  ///< lower case
  /// What may follow: w a word or text, n a value; alternatives behind "|"; "(wn)*" any number of
  /// pairs.
  std::string_view shapes;
  std::string_view usage;
  Accepted (*handler)(Execution& x, Arguments arguments);
};

[[nodiscard]] std::span<const SpecialStatement> special_statements();
/// Whether `arguments` have one of the shapes.
[[nodiscard]] bool fits(const SpecialStatement& statement, Arguments arguments);

}  // namespace cnc::interp
