#include "api/cncctl/question.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <strings.h>

#include "api/cncctl/words.h"

namespace cnc::ctl {
namespace {

using Field = api::Question::Field;

std::string labels_of(const api::Question& question) {
  if (question.fields.empty()) return "It has no fields: only OK or Cancel.";
  std::vector<std::string> labels;
  for (const Field& field : question.fields) labels.push_back('"' + field.label + '"');
  return fmt::format("Its fields are: {}.", fmt::join(labels, ", "));
}

std::unexpected<api::Error> wrong_answer(const api::Question& question, std::string message) {
  return std::unexpected(api::Error{.kind = api::ErrorKind::invalid,
                                    .name = "wrong_answer",
                                    .message = std::move(message),
                                    .check = labels_of(question)});
}

bool is_called(const Field& field, const std::string& label) {
  return strcasecmp(field.label.c_str(), label.c_str()) == 0;
}

api::Result<std::vector<double>> values_in_order(const api::Question& question,
                                                 const std::vector<GivenValue>& given) {
  if (given.size() != question.fields.size()) {
    return wrong_answer(question,
                        fmt::format("The question has {} fields, but {} values are given.",
                                    question.fields.size(), given.size()));
  }
  std::vector<double> values;
  for (const GivenValue& each : given) values.push_back(each.value);
  return values;
}

api::Result<std::vector<double>> values_by_label(const api::Question& question,
                                                 const std::vector<GivenValue>& given) {
  std::vector<double> values;
  for (const Field& field : question.fields) values.push_back(field.value);
  for (const GivenValue& each : given) {
    const auto has_label = [&](const Field& field) { return is_called(field, *each.label); };
    const auto found = std::ranges::find_if(question.fields, has_label);
    if (found == question.fields.end()) {
      return wrong_answer(question, fmt::format("The question has no field \"{}\".", *each.label));
    }
    if (std::ranges::count_if(question.fields, has_label) > 1) {
      return wrong_answer(question,
                          fmt::format("Several fields are called \"{}\": give the values of all "
                                      "fields in their order.",
                                      *each.label));
    }
    values.at(static_cast<std::size_t>(found - question.fields.begin())) = each.value;
  }
  return values;
}

}  // namespace

std::string format_field_value(double value) { return fmt::format("{:.10g}", value); }

std::string format_question(const api::Question& question, int indent) {
  std::string text = question.title + '\n';
  for (const Field& field : question.fields)
    text += fmt::format("{:{}}{} = {}\n", "", indent, field.label, format_field_value(field.value));
  return text;
}

std::string how_to_answer(const api::Question& question) {
  std::string text = "cncctl answer";
  for (const Field& field : question.fields) text += ' ' + format_field_value(field.value);
  return text + ", or cncctl answer --cancel";
}

std::vector<GivenValue> parse_given(const std::vector<std::string>& words) {
  std::vector<GivenValue> given;
  for (const std::string& word : words) {
    const std::size_t equals = word.rfind('=');
    if (equals == std::string::npos) {
      given.push_back({std::nullopt, parse_number(word)});
    } else {
      given.push_back({word.substr(0, equals), parse_number(word.substr(equals + 1))});
    }
    if (given.back().label.has_value() != given.front().label.has_value()) {
      throw CLI::ValidationError(
          "either all values have a label (LABEL=VALUE) or none has: then they are in the order of "
          "the fields");
    }
  }
  return given;
}

api::Result<std::vector<double>> values_for(const api::Question& question,
                                            const std::vector<GivenValue>& given) {
  if (given.empty()) return std::vector<double>{};
  return given.front().label ? values_by_label(question, given) : values_in_order(question, given);
}

}  // namespace cnc::ctl
