// cnc.ini: from text to a checked MachineConfig and back.
//
// Reading checks everything and reports every error at once, each with its line, what was read and
// what is allowed; a configuration comes out only when there is none. First each value is checked
// by itself, and only when all are right, the rules that tie them together: a rule that is checked
// against a value that was not understood would accuse the wrong line.
//
// Settings from elsewhere (the command line, the API) are texts "SECTION.key=value" in the machine
// unit, checked like the file.
#pragma once

#include <expected>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.h"
#include "config/machine_config.h"

namespace cnc::config {

using Errors = std::vector<Error>;

/// The file, with each of `overrides` in the place of the file's value (or as if it stood there).
[[nodiscard]] std::expected<MachineConfig, Errors> load_machine_config(
    const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// The same from a text; `name` is the file's name for errors.
[[nodiscard]] std::expected<MachineConfig, Errors> parse_machine_config(
    std::string_view text, std::string_view name, std::span<const std::string> overrides = {});

/// `config` with the settings changed, all or none. Changing the machine unit changes no value.
[[nodiscard]] std::expected<MachineConfig, Errors> apply_settings(
    const MachineConfig& config, std::span<const std::string> changes);

/// The text of a file that reads back as `config`. Of `old_text` only the values that differ are
/// replaced, and what is missing is added to the end of its section; without an old text every
/// setting is written with its help.
[[nodiscard]] std::string machine_config_text(const MachineConfig& config,
                                              std::string_view old_text = {});

/// Saves into the file, atomically and with the version before as "<name>.bak". Refused when what
/// would be written could not be loaded again.
[[nodiscard]] std::expected<void, Errors> save_machine_config(const std::filesystem::path& path,
                                                              const MachineConfig& config);

}  // namespace cnc::config
