// Rules that tie settings to one another, for values that are each within their own range.
#pragma once

#include <vector>

#include "config/error.h"
#include "config/machine_config.h"
#include "config/schema.h"

namespace cnc::config {

struct ConfigConflict {
  Error error;             ///< names every setting that takes part, with its value
  const Setting* setting;  ///< the one to look at first
};

/// Every rule that the configuration breaks. Axes that are not connected are not looked at.
[[nodiscard]] std::vector<ConfigConflict> find_conflicts(const MachineConfig& config);

/// What a machine with a real board can live with, but its operator should be told. Axes that are
/// not connected are not looked at.
[[nodiscard]] std::vector<Error> find_cautions(const MachineConfig& config);

}  // namespace cnc::config
