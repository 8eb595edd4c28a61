// The parts of a scenario file, each read from its table. Ranges catch a slip of the hand (a
// missing point, a wrong unit), not a bold experiment.
#pragma once

#include "hal/sim/scenario.h"
#include "hal/sim/scenario_table.h"

namespace cnc::hal::sim {

inline constexpr double kFarthest = 1e6;  // mm or degrees
inline constexpr Range kPlaceRange{-kFarthest, kFarthest, "mm or degrees"};
inline constexpr Range kProbabilityRange{0.0, 1.0};
inline constexpr Range kLinkTimeRange{0.0, 10.0, "s"};
inline constexpr Range kToolRange{1, 99};

/// Every table that builds the machine; not [link] and [[event]].
void read_machine(ScenarioTable& file, MachineOptions& options);
void read_link(ScenarioTable& file, LinkTrouble& link);
void read_events(ScenarioTable& file, std::vector<ScenarioEvent>& events);

}  // namespace cnc::hal::sim
