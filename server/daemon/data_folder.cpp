#include "server/daemon/data_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

#include "config/atomic_file.h"
#include "config/pitch_table.h"
#include "server/daemon/shipped_files.h"

namespace cnc::server {
namespace {

constexpr const char* kConfigFile = "cnc.ini";
constexpr const char* kParameterFile = "parameters.txt";
constexpr const char* kToolFile = "tools.txt";
constexpr const char* kMacroFile = "macro.cnc";
constexpr const char* kUserMacroFile = "user_macro.cnc";
constexpr const char* kProgramFolder = "files";

Result<void> write_if_missing(const std::filesystem::path& path, std::string_view text) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return {};
  return config::write_file_atomically(path, text);
}

}  // namespace

std::filesystem::path default_data_folder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0')
    return std::filesystem::path(state) / "cnc";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home != nullptr ? home : "/") / ".local/state/cnc";
}

Result<DataFolder> DataFolder::open(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return fail(ErrorCode::file_not_writable, fmt::format("Cannot create the data folder {}: {}.",
                                                          folder.string(), error.message()));
  const auto lock_path = folder / "lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock < 0)
    return fail(ErrorCode::file_not_writable,
                fmt::format("Cannot open {}: {}.", lock_path.string(), std::strerror(errno)));
  DataFolder data(folder, lock);
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0)
    return fail(ErrorCode::already_running,
                fmt::format("Another server uses {}.", folder.string()));
  for (const auto& [name, text] : {std::pair{kConfigFile, shipped_cnc_ini()},
                                   {kParameterFile, shipped_parameters()},
                                   {kToolFile, shipped_tools()},
                                   {kMacroFile, shipped_macros()}})
    if (auto written = write_if_missing(folder / name, text); !written)
      return std::unexpected(written.error());
  return data;
}

DataFolder::DataFolder(DataFolder&& other) noexcept
    : folder_(std::move(other.folder_)), lock_(std::exchange(other.lock_, -1)) {}

DataFolder& DataFolder::operator=(DataFolder&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(lock_, other.lock_);
  return *this;
}

DataFolder::~DataFolder() {
  if (lock_ >= 0) ::close(lock_);
}

std::expected<MachineData, config::Errors> DataFolder::load(
    const std::filesystem::path& config_file, std::span<const std::string> overrides) const {
  config::Errors errors;
  MachineData data;
  data.parameter_file = folder_ / kParameterFile;
  data.tool_file = folder_ / kToolFile;
  data.config_file = config_file.empty() ? folder_ / kConfigFile : config_file;
  data.program_folder = folder_ / kProgramFolder;
  data.macro_files = {folder_ / kMacroFile, folder_ / kUserMacroFile};
  const auto take = [&](auto loaded, auto& into) {
    if (loaded)
      into = std::move(*loaded);
    else
      errors.push_back(loaded.error());
  };
  auto config = config::load_machine_config(data.config_file, overrides);
  if (config) {
    data.config = std::move(*config);
    const auto tables = config::load_pitch_tables(data.config, data.config_file.parent_path());
    if (!tables) errors.push_back(tables.error());
  } else {
    errors = config.error();
  }
  take(config::ParameterStore::load(data.parameter_file), data.parameters);
  take(config::ToolTable::load(folder_ / kToolFile), data.tools);
  if (!errors.empty()) return std::unexpected(std::move(errors));
  return data;
}

}  // namespace cnc::server
