// Between the messages on the wire and the plain types of the public headers.
#pragma once

#include <optional>

#include "api/client.h"
#include "cnc/v1/common.pb.h"
#include "cnc/v1/job.pb.h"
#include "cnc/v1/messages.pb.h"
#include "cnc/v1/status.pb.h"
#include "cnc/v1/system.pb.h"

namespace cnc::api {

[[nodiscard]] v1::Axis to_wire(Axis axis);

/// Nothing for an axis that this library is too old to know.
[[nodiscard]] std::optional<Axis> from_wire(v1::Axis axis);
[[nodiscard]] Error from_wire(const v1::ErrorDetail& detail, ErrorKind kind);
[[nodiscard]] MachineStatus from_wire(const v1::MachineStatus& wire);
[[nodiscard]] ServerVersion from_wire(const v1::GetVersionResponse& wire);
[[nodiscard]] Machine from_wire(const v1::GetMachineResponse& wire);
[[nodiscard]] LinkStatistics from_wire(const v1::GetLinkStatisticsResponse& wire);
[[nodiscard]] ProblemList from_wire(const v1::GetProblemsResponse& wire);
[[nodiscard]] Message from_wire(const v1::Message& wire);

}  // namespace cnc::api
