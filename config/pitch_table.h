// The pitch table of a motor (manual 2.3): where the machine is in truth when it believes to be at
// a position, measured along the axis.
//
//   ; Pitch correction table for axis X
//   ; machine position   calibrated position
//     0                  0
//     50                 50.01
//
// A comment begins with a semicolon. Both columns rise; the file lies beside cnc.ini.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.h"
#include "config/machine_config.h"

namespace cnc::config {

/// "Joint-X-pitchCompTable.txt"
[[nodiscard]] std::string pitch_table_name(Axis motor);

[[nodiscard]] Result<std::vector<PitchPoint>> parse_pitch_table(std::string_view text,
                                                                std::string_view name);

/// Reads the tables of the motors that are to be corrected, from the folder of cnc.ini. A table
/// that is missing is written as an example, which corrects nothing.
[[nodiscard]] Result<void> load_pitch_tables(MachineConfig& config,
                                             const std::filesystem::path& folder);

}  // namespace cnc::config
