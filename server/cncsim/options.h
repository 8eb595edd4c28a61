// What cncsim's two commands have in common.
#pragma once

#include <expected>
#include <filesystem>
#include <string>
#include <vector>

#include "config/ini_file.h"
#include "server/machine/machine.h"

namespace cnc::server {

struct SimInput {
  std::filesystem::path file;
  std::filesystem::path config;      ///< empty: the shipped cnc.ini
  std::filesystem::path parameters;  ///< empty: the shipped parameters (G54 …)
  std::filesystem::path tools;       ///< empty: the shipped tools
  std::vector<std::string> settings;
  bool json = false;
};

/// The machine to simulate, checked; all errors at once.
[[nodiscard]] std::expected<MachineData, config::Errors> load_machine(const SimInput& input);

struct RunOptions : SimInput {
  std::filesystem::path record;  ///< CSV file, one row per millisecond
};
struct CheckOptions : SimInput {
  std::filesystem::path canon;  ///< text file of canonical commands
  std::size_t max_errors = 100;
};

/// Both print their report and return the exit code: 0 good, 1 the program has errors or the machine
/// stopped, 2 the input could not be read.
int run_command(const RunOptions& options);
int check_command(const CheckOptions& options);

}  // namespace cnc::server
