// A program's question as text, and the words of a shell as its answer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "api/error.h"
#include "api/status.h"

namespace cnc::ctl {

/// The title, and below it, indented, each field with the value that it proposes.
[[nodiscard]] std::string format_question(const api::Question& question, int indent = 2);

/// "cncctl answer 20 5, or cncctl answer --cancel": a command that can be pasted.
[[nodiscard]] std::string how_to_answer(const api::Question& question);

/// A value of a field: "20", as the question shows it.
[[nodiscard]] std::string format_field_value(double value);

/// One word of `cncctl answer`: "20", or "Height of the plate=20".
struct GivenValue {
  std::optional<std::string> label;
  double value = 0.0;
};

/// Throws CLI::ValidationError for a word without a number, or when only some have a label.
[[nodiscard]] std::vector<GivenValue> parse_given(const std::vector<std::string>& words);

/// The values of all fields: those with a label go to their field, the others keep what is
/// proposed; those without go to the fields in their order. Nothing given: nothing to be sent.
[[nodiscard]] api::Result<std::vector<double>> values_for(const api::Question& question,
                                                          const std::vector<GivenValue>& given);

}  // namespace cnc::ctl
