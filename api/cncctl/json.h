// Results as JSON. The field names are those of the structs in the public headers and of docs/
// cncctl.md; they are as stable as the API. Positions, velocities and factors are rounded to 4
// decimals; what is not a number there (the upper end of a histogram's last bin) is null.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "api/client.h"

namespace cnc::ctl {

[[nodiscard]] nlohmann::json to_json(const api::Error& error);
[[nodiscard]] nlohmann::json to_json(const api::Question& question);
[[nodiscard]] nlohmann::json to_json(const api::MachineStatus& status);
[[nodiscard]] nlohmann::json to_json(const api::ServerVersion& version);
[[nodiscard]] nlohmann::json to_json(const api::LinkStatistics& statistics);
[[nodiscard]] nlohmann::json to_json(const api::LoadedJob& job);
[[nodiscard]] nlohmann::json to_json(const api::ProblemList& list);
[[nodiscard]] nlohmann::json to_json(const api::Message& message);
[[nodiscard]] nlohmann::json to_json(const api::Overrides& overrides);

}  // namespace cnc::ctl
