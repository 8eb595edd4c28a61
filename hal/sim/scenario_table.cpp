#define TOML_IMPLEMENTATION
#include "hal/sim/scenario_table.h"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/nearest_name.h"
#include "config/text_lines.h"
#include "hal/ports.h"

namespace cnc::hal::sim {
namespace {

using config::in_quotes;
using config::number_text;

std::string range_text(const Range& range) {
  const std::string unit = range.unit.empty() ? "" : fmt::format(" {}", range.unit);
  return fmt::format("{} to {}{}", number_text(range.min), number_text(range.max), unit);
}

}  // namespace

void ScenarioErrors::add(ErrorCode code, std::string message, const toml::node& where) {
  if (first) return;
  const toml::source_position begin = where.source().begin;
  first = Error{code, std::move(message), TextPlace{file, begin.line, begin.column}};
}

ScenarioTable::ScenarioTable(const toml::table& table, std::string name, ScenarioErrors& errors)
    : table_(&table), name_(std::move(name)), errors_(&errors) {}

std::string ScenarioTable::label(std::string_view key) const {
  return name_.empty() ? std::string(key) : fmt::format("{} of {}", key, name_);
}

const toml::node* ScenarioTable::find(std::string_view key) {
  know(key);
  return table_->get(key);
}

const toml::node* ScenarioTable::need(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    refuse(ErrorCode::scenario_key_missing, fmt::format("{} needs a value for {}.", name_, key));
  }
  return node;
}

void ScenarioTable::refuse(ErrorCode code, const std::string& message) {
  errors_->add(code, message, *table_);
}

void ScenarioTable::wrong_type(const toml::node& node, std::string_view key,
                               std::string_view wanted) {
  errors_->add(ErrorCode::scenario_wrong_type, fmt::format("{} has to be {}.", label(key), wanted),
               node);
}

// --- numbers -------------------------------------------------------------------------------------

std::optional<double> ScenarioTable::number_of(const toml::node& node, std::string_view key,
                                               Range range) {
  const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) {
    wrong_type(node, key, fmt::format("a number, {}", range_text(range)));
    return std::nullopt;
  }
  if (*value >= range.min && *value <= range.max) return value;
  errors_->add(
      ErrorCode::scenario_out_of_range,
      fmt::format("{} is {}; it has to be {}.", label(key), number_text(*value), range_text(range)),
      node);
  return std::nullopt;
}

std::optional<double> ScenarioTable::whole_of(const toml::node& node, std::string_view key,
                                              Range range) {
  if (node.is_integer()) return number_of(node, key, range);
  wrong_type(node, key, fmt::format("a whole number, {}", range_text(range)));
  return std::nullopt;
}

std::optional<double> ScenarioTable::whole(std::string_view key, Range range) {
  const toml::node* node = find(key);
  return node == nullptr ? std::nullopt : whole_of(*node, key, range);
}

void ScenarioTable::read(std::string_view key, double& target, Range range) {
  const toml::node* node = find(key);
  if (node != nullptr) target = number_of(*node, key, range).value_or(target);
}

void ScenarioTable::read(std::string_view key, std::optional<double>& target, Range range) {
  const toml::node* node = find(key);
  if (node != nullptr) target = number_of(*node, key, range);
}

double ScenarioTable::number(std::string_view key, Range range) {
  const toml::node* node = need(key);
  return node == nullptr ? range.min : number_of(*node, key, range).value_or(range.min);
}

double ScenarioTable::whole_number(std::string_view key, Range range) {
  const toml::node* node = need(key);
  return node == nullptr ? range.min : whole_of(*node, key, range).value_or(range.min);
}

void ScenarioTable::read(std::string_view key, std::vector<double>& target, Range range) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr) return wrong_type(*node, key, "a list of numbers in [ ]");
  target.clear();
  for (const toml::node& element : *array) {
    target.push_back(number_of(element, key, range).value_or(range.min));
  }
}

void ScenarioTable::read(std::string_view key, Position& target, Range range) {
  std::optional<ScenarioTable> values = table(key);
  if (!values) return;
  for (const Axis axis : kAllAxes) values->read(axis_name(axis), target[axis], range);
  values->finish();
}

std::vector<std::vector<double>> ScenarioTable::rows(std::string_view key, Range range) {
  constexpr std::string_view kWanted =
      "two or more rows of numbers of the same length, two or more: [[1, 2], [1, 3]]";
  std::vector<std::vector<double>> rows;
  const toml::node* node = need(key);
  if (node == nullptr) return rows;
  const toml::array* array = node->as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    const toml::array* row = array->get_as<toml::array>(i);
    if (row == nullptr) return wrong_type(*node, key, kWanted), rows;
    rows.emplace_back();
    for (const toml::node& element : *row) {
      rows.back().push_back(number_of(element, key, range).value_or(range.min));
    }
  }
  const auto fits = [&rows](const std::vector<double>& row) {
    return row.size() >= 2 && row.size() == rows.front().size();
  };
  if (rows.size() < 2 || !std::ranges::all_of(rows, fits)) wrong_type(*node, key, kWanted);
  return rows;
}

// --- words, flags, axes and ports ----------------------------------------------------------------

void ScenarioTable::read(std::string_view key, bool& target) {
  if (has(key)) target = flag(key);
  know(key);
}

bool ScenarioTable::flag(std::string_view key) {
  const toml::node* node = need(key);
  if (node == nullptr) return false;
  if (const std::optional<bool> value = node->value_exact<bool>()) return *value;
  wrong_type(*node, key, "true or false");
  return false;
}

std::size_t ScenarioTable::choice(std::string_view key, std::span<const std::string_view> words) {
  const toml::node* node = need(key);
  if (node == nullptr) return 0;
  const auto word = node->value_exact<std::string_view>();
  const std::string wanted = fmt::format("one of \"{}\"", fmt::join(words, "\", \""));
  if (!word) return wrong_type(*node, key, wanted), 0;
  const auto found = std::ranges::find(words, *word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  errors_->add(ErrorCode::scenario_unknown_word,
               fmt::format("{} is {}; it has to be {}. Is {} meant?", label(key), in_quotes(*word),
                           wanted, in_quotes(config::nearest_name(*word, words))),
               *node);
  return 0;
}

Axis ScenarioTable::axis(std::string_view key) {
  static constexpr std::array<std::string_view, kAxisCount> kNames{"X", "Y", "Z", "A", "B", "C"};
  return kAllAxes.at(choice(key, kNames));
}

std::optional<std::size_t> ScenarioTable::port_of(const toml::node& node, std::string_view key) {
  const std::optional<double> number = whole_of(node, key, {1, 308});
  if (!number) return std::nullopt;
  const std::optional<std::size_t> bit = port_bit(static_cast<int>(*number));
  if (!bit) {
    errors_->add(ErrorCode::scenario_out_of_range,
                 fmt::format("{} is {}: there is no such port. 1 to 16 are AUX1 to AUX16, 101 "
                             "to 108, 201 to 208 and 301 to 308 those of the cards.",
                             label(key), number_text(*number)),
                 node);
  }
  return bit;
}

void ScenarioTable::read_port(std::string_view key, std::optional<std::size_t>& target) {
  const toml::node* node = find(key);
  if (node != nullptr) target = port_of(*node, key);
}

std::vector<std::size_t> ScenarioTable::ports(std::string_view key) {
  std::vector<std::size_t> ports;
  const toml::node* node = find(key);
  if (node == nullptr) return ports;
  const toml::array* array = node->as_array();
  if (array == nullptr) return wrong_type(*node, key, "a list of port numbers in [ ]"), ports;
  for (const toml::node& element : *array) ports.push_back(port_of(element, key).value_or(0));
  return ports;
}

std::size_t ScenarioTable::port(std::string_view key) {
  const toml::node* node = need(key);
  return node == nullptr ? 0 : port_of(*node, key).value_or(0);
}

// --- tables within -------------------------------------------------------------------------------

std::optional<ScenarioTable> ScenarioTable::table(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const toml::table* table = node->as_table()) {
    return ScenarioTable(*table, name_.empty() ? fmt::format("[{}]", key) : label(key), *errors_);
  }
  wrong_type(*node, key, fmt::format("a table, [{}] or {{ }}", key));
  return std::nullopt;
}

std::vector<ScenarioTable> ScenarioTable::tables(std::string_view key) {
  std::vector<ScenarioTable> tables;
  const toml::node* node = find(key);
  if (node == nullptr) return tables;
  const toml::array* array = node->as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    if (const toml::table* table = array->get_as<toml::table>(i)) {
      tables.emplace_back(*table, fmt::format("[[{}]] {}", key, i + 1), *errors_);
    }
  }
  if (array == nullptr || tables.size() != array->size()) {
    wrong_type(*node, key, fmt::format("written as [[{}]]", key));
  }
  return tables;
}

void ScenarioTable::finish() {
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(asked_, key.str()) != asked_.end()) continue;
    errors_->add(ErrorCode::scenario_unknown_key,
                 fmt::format("{} has no key {}; is {} meant? It has: {}.",
                             name_.empty() ? "The scenario" : name_, in_quotes(key.str()),
                             config::nearest_name(key.str(), asked_), fmt::join(asked_, ", ")),
                 node);
    return;
  }
}

}  // namespace cnc::hal::sim
