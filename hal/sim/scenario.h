// A scenario: how a virtual machine is built, and what happens to it. Written in TOML; every key
// stands in docs/scenarios.md.
#pragma once

#include <filesystem>
#include <vector>

#include "config/error.h"
#include "hal/sim/link_trouble.h"
#include "hal/sim/machine_options.h"
#include "hal/sim/scenario_event.h"

namespace cnc::hal::sim {

struct Scenario {
  MachineOptions machine{};
  LinkTrouble link{};  ///< from power-up on
  std::vector<ScenarioEvent> events{};
};

/// Read and checked whole: an unknown key, a wrong type or a value out of its range is an error
/// that names its line and what would be right.
[[nodiscard]] Result<Scenario> load_scenario(const std::filesystem::path& path);
/// `name` is the file's name for errors.
[[nodiscard]] Result<Scenario> parse_scenario(std::string_view text, std::string_view name);

}  // namespace cnc::hal::sim
