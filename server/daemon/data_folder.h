// The folder that holds a machine's configuration and state: cnc.ini, parameters.txt, tools.txt,
// macro.cnc, the operator's own user_macro.cnc, files/ for what programs write, dialogPictures/ for
// the pictures that clients show with a program's question, and traces/ of the link.
//
// A new folder is filled with the shipped files. One server at a time uses a folder: it holds a
// lock that the system releases when the process ends, however it ends.
#pragma once

#include <expected>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "config/ini_file.h"
#include "server/machine/machine.h"

namespace cnc::server {

/// $XDG_STATE_HOME/cnc, or ~/.local/state/cnc.
[[nodiscard]] std::filesystem::path default_data_folder();

class DataFolder {
 public:
  /// Creates what is missing, then takes the lock.
  [[nodiscard]] static Result<DataFolder> open(const std::filesystem::path& folder);
  DataFolder(DataFolder&& other) noexcept;
  DataFolder& operator=(DataFolder&& other) noexcept;
  ~DataFolder();

  /// Everything, checked; all errors at once. `config_file` empty: the folder's cnc.ini.
  [[nodiscard]] std::expected<MachineData, config::Errors> load(
      const std::filesystem::path& config_file, std::span<const std::string> overrides) const;

 private:
  DataFolder(std::filesystem::path folder, int lock) : folder_(std::move(folder)), lock_(lock) {}

  std::filesystem::path folder_;
  int lock_ = -1;
};

}  // namespace cnc::server
