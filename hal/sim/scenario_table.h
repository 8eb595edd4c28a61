// A table of a scenario file, read key by key: each value by its type and range, and at the end the
// keys that nobody asked for. The first thing that is wrong is kept with its line; what is read
// after it keeps its default, so that reading code does not have to ask after each value.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#define TOML_HEADER_ONLY 0
#define TOML_EXCEPTIONS 0
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include "config/axis.h"
#include "config/error.h"

namespace cnc::hal::sim {

/// The first error of a file.
struct ScenarioErrors {
  std::string file;
  std::optional<Error> first{};

  void add(ErrorCode code, std::string message, const toml::node& where);
};

struct Range {
  double min;
  double max;
  std::string_view unit = "";
};

class ScenarioTable {
 public:
  /// `name` as messages call it, empty for the whole file. Both references outlive this.
  ScenarioTable(const toml::table& table, std::string name, ScenarioErrors& errors);

  [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }
  /// The key may be there though nothing reads it this time.
  void know(std::string_view key) {
    if (std::ranges::find(asked_, key) == asked_.end()) asked_.push_back(key);
  }

  // The value of a key that may be missing; the target then stays as it is.
  void read(std::string_view key, double& target, Range range);
  void read(std::string_view key, std::optional<double>& target, Range range);
  void read(std::string_view key, bool& target);
  void read(std::string_view key, std::vector<double>& target, Range range);
  template <typename Integer>
  void read_whole(std::string_view key, Integer& target, Range range) {
    if (const std::optional<double> value = whole(key, range))
      target = static_cast<Integer>(*value);
  }
  /// A value for each axis that is named.
  void read(std::string_view key, Position& target, Range range);
  /// hal::port_bit() of a port's number.
  void read_port(std::string_view key, std::optional<std::size_t>& target);
  [[nodiscard]] std::vector<std::size_t> ports(std::string_view key);

  // The value of a key that must be there; any value where it is not.
  [[nodiscard]] double number(std::string_view key, Range range);
  [[nodiscard]] double whole_number(std::string_view key, Range range);
  [[nodiscard]] bool flag(std::string_view key);
  [[nodiscard]] Axis axis(std::string_view key);
  [[nodiscard]] std::size_t port(std::string_view key);
  /// The place of the value in `words`, which are not empty.
  [[nodiscard]] std::size_t choice(std::string_view key, std::span<const std::string_view> words);

  [[nodiscard]] std::optional<ScenarioTable> table(std::string_view key);
  /// [[key]]
  [[nodiscard]] std::vector<ScenarioTable> tables(std::string_view key);
  /// key = [[...], [...]]; rows of the same length.
  [[nodiscard]] std::vector<std::vector<double>> rows(std::string_view key, Range range);

  /// Something about several keys is wrong.
  void refuse(ErrorCode code, const std::string& message);
  /// Keys that nobody has asked for are an error.
  void finish();

 private:
  [[nodiscard]] const toml::node* find(std::string_view key);
  [[nodiscard]] const toml::node* need(std::string_view key);
  [[nodiscard]] std::optional<double> whole(std::string_view key, Range range);
  [[nodiscard]] std::optional<double> number_of(const toml::node& node, std::string_view key,
                                                Range range);
  [[nodiscard]] std::optional<double> whole_of(const toml::node& node, std::string_view key,
                                               Range range);
  [[nodiscard]] std::optional<std::size_t> port_of(const toml::node& node, std::string_view key);
  [[nodiscard]] std::string label(std::string_view key) const;
  void wrong_type(const toml::node& node, std::string_view key, std::string_view wanted);

  const toml::table* table_;
  std::string name_;
  ScenarioErrors* errors_;
  std::vector<std::string_view> asked_;
};

}  // namespace cnc::hal::sim
