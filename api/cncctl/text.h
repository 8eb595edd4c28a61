// Results as text for people.
#pragma once

#include <string>
#include <vector>

#include "api/client.h"

namespace cnc::ctl {

/// "1:02:03", "2:03"; whole seconds.
[[nodiscard]] std::string format_duration(double seconds);

/// Those that people see.
[[nodiscard]] std::vector<api::Axis> axes_of(const api::Machine& machine);

/// "X1.000 Y-2.000 Z0.000".
[[nodiscard]] std::string format_position(const api::AxisValues& position,
                                          const std::vector<api::Axis>& axes);

/// The whole status, several lines.
[[nodiscard]] std::string format_status(const api::MachineStatus& status,
                                        const std::vector<api::Axis>& axes);
/// The essentials in one line, for --watch.
[[nodiscard]] std::string format_status_line(const api::MachineStatus& status,
                                             const std::vector<api::Axis>& axes);

[[nodiscard]] std::string format_overrides(const api::Overrides& overrides);
[[nodiscard]] std::string format_link(const api::LinkStatistics& statistics,
                                      const std::vector<api::Axis>& axes);
[[nodiscard]] std::string format_problem(const api::Problem& problem);
[[nodiscard]] std::string format_message(const api::Message& message);

}  // namespace cnc::ctl
