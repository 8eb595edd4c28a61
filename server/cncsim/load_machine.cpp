#include <cstdio>
#include <fmt/format.h>

#include "config/pitch_table.h"
#include "server/cncsim/options.h"
#include "server/daemon/shipped_files.h"

namespace cnc::server {
namespace {

template <typename Store>
Result<Store> load_or_parse(const std::filesystem::path& path, std::string_view shipped) {
  if (path.empty()) return Store::parse(shipped, "shipped file");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return fail(ErrorCode::file_not_found, "The file " + path.string() + " does not exist.");
  return Store::load(path);
}

}  // namespace

std::expected<MachineData, config::Errors> load_machine(const SimInput& input) {
  config::Errors errors;
  MachineData data;
  auto config = input.config.empty() ? config::parse_machine_config(
                                           shipped_cnc_ini(), "shipped cnc.ini", input.settings)
                                     : config::load_machine_config(input.config, input.settings);
  if (config) {
    data.config = std::move(*config);
    const auto tables = config::load_pitch_tables(data.config, input.config.parent_path());
    if (!tables) errors.push_back(tables.error());
  } else {
    errors = config.error();
  }

  auto parameters = load_or_parse<config::ParameterStore>(input.parameters, shipped_parameters());
  if (parameters)
    data.parameters = std::move(*parameters);
  else
    errors.push_back(parameters.error());

  auto tools = load_or_parse<config::ToolTable>(input.tools, shipped_tools());
  if (tools)
    data.tools = std::move(*tools);
  else
    errors.push_back(tools.error());

  if (input.macros.empty()) {
    data.macros.push_back(
        interp::Program::from_text(std::string(shipped_macros()), "macro.cnc").value());
  }
  for (const auto& path : input.macros) {
    auto macros = interp::Program::open(path);
    if (macros)
      data.macros.push_back(std::move(*macros));
    else
      errors.push_back(macros.error());
  }

  if (!errors.empty()) return std::unexpected(std::move(errors));
  return data;
}

ExitCode refuse(const config::Errors& errors) {
  for (const Error& error : errors)
    fmt::print(stderr, "cncsim: {}\n  {}\n", error.to_string(), error_info(error.code).check);
  return kBadInput;
}

ExitCode refuse(const Error& error) { return refuse(config::Errors{error}); }

}  // namespace cnc::server
