// The commands of cncsim and what they have in common.
#pragma once

#include <expected>
#include <filesystem>
#include <string>
#include <vector>

#include "config/ini_file.h"
#include "interpreter/check.h"
#include "server/machine/machine.h"

namespace cnc::server {

struct SimInput {
  std::filesystem::path file;
  std::filesystem::path config;               ///< empty: the shipped cnc.ini
  std::filesystem::path parameters;           ///< empty: the shipped parameters (G54 …)
  std::filesystem::path tools;                ///< empty: the shipped tools
  std::vector<std::filesystem::path> macros;  ///< empty: the shipped macro.cnc
  std::vector<std::string> settings;
  bool json = false;
};

/// The machine to simulate, checked; all errors at once.
[[nodiscard]] std::expected<MachineData, config::Errors> load_machine(const SimInput& input);

struct RunOptions : SimInput {
  std::filesystem::path record;    ///< CSV file, one row per millisecond
  std::filesystem::path scenario;  ///< how the machine is built and what happens to it
  std::filesystem::path trace;     ///< of the link, for replay
};
struct CheckOptions : SimInput {
  std::filesystem::path canon;  ///< text file of canonical commands
  std::size_t max_errors = 100;
  std::uint64_t max_loop_lines = interp::kMaxLoopLines;
  bool progress = false;  ///< also where stderr is no terminal
};

struct ReplayOptions {
  std::filesystem::path file;
  double last = 0.0;          ///< s of the trace whose exchanges are listed
  std::filesystem::path csv;  ///< every field of every exchange
  bool json = false;
};

enum ExitCode : int { kGood = 0, kProgramFailed = 1, kBadInput = 2 };

/// Prints the errors and answers kBadInput.
ExitCode refuse(const config::Errors& errors);
ExitCode refuse(const Error& error);

/// All print their report.
ExitCode run_command(const RunOptions& options);
ExitCode check_command(const CheckOptions& options);
ExitCode replay_command(const ReplayOptions& options);

}  // namespace cnc::server
