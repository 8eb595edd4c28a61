// Any bytes as cnc.ini, parameter file, tool table and override: no crash, every error bounded and
// with its place, and whatever is accepted comes back the same from its own text.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "config/config_checks.h"
#include "config/ini_document.h"
#include "config/ini_file.h"
#include "config/parameter_store.h"
#include "config/schema.h"
#include "config/tool_table.h"

namespace {

using namespace cnc;
using namespace cnc::config;

void require(bool condition) {
  if (!condition) std::abort();
}

// In inches a value in mm may move by one rounding when it is written and read.
bool is_same(const SettingValue& one, const SettingValue& other, MachineUnit unit) {
  const auto* a = std::get_if<double>(&one);
  if (a == nullptr || unit == MachineUnit::millimetre) return one == other;
  return std::abs(*a - std::get<double>(other)) <= 1e-15 * std::abs(*a);
}

void check_config(std::string_view text, const MachineConfig& config) {
  require(find_conflicts(config).empty());
  // A save without a change replaces no byte; at most it closes the last line.
  const std::string saved = machine_config_text(config, text);
  require(text.empty() || saved.starts_with(text));
  const auto fresh = parse_machine_config(machine_config_text(config), "fresh");
  if (!fresh) {
    // Only a rule that holds by a hair's breadth may break by the rounding of inches.
    require(config.unit == MachineUnit::inch);
    return;
  }
  for (const Setting& setting : settings()) {
    require(is_same(setting.value(config), setting.value(*fresh), config.unit));
  }
}

void fuzz_settings(std::string_view text) {
  const auto config = parse_machine_config(text, "cnc.ini");
  if (config) return check_config(text, *config);
  require(!config.error().empty() && config.error().size() <= kMaxIniErrors);
  for (const Error& error : config.error()) require(error.to_string().size() < 1000);
}

void fuzz_override(std::string_view text) {
  const std::vector<std::string> changes{std::string(text)};
  const auto config = apply_settings(MachineConfig{}, changes);
  if (config) require(find_conflicts(*config).empty());
}

void fuzz_parameters(std::string_view text) {
  const auto store = ParameterStore::parse(text, "parameters");
  if (!store) return require(store.error().to_string().size() < 1000);
  require(ParameterStore::parse(store->to_text(), "again").value() == *store);
}

void fuzz_tools(std::string_view text) {
  const auto table = ToolTable::parse(text, "tools");
  if (!table) return require(table.error().to_string().size() < 1000);
  require(ToolTable::parse(table->to_text(), "again").value() == *table);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  fuzz_settings(text);
  fuzz_override(text);
  fuzz_parameters(text);
  fuzz_tools(text);
  return 0;
}
