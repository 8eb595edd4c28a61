// Between the machine's values and cnc.v1: the one place where enumerations and units are mapped.
#pragma once

#include <grpcpp/support/status.h>
#include <optional>

#include "cnc/v1/common.pb.h"
#include "cnc/v1/messages.pb.h"
#include "cnc/v1/status.pb.h"
#include "config/error.h"
#include "server/machine/message_log.h"
#include "server/machine/snapshot.h"

namespace cnc::server::rpc {

[[nodiscard]] v1::Axis to_proto(Axis axis);
/// Nothing for AXIS_UNSPECIFIED and for numbers that this version does not know.
[[nodiscard]] std::optional<Axis> axis_from(v1::Axis axis);
[[nodiscard]] v1::AxisValues to_proto(const Position& position);
[[nodiscard]] v1::ErrorDetail to_proto(const Error& error);
[[nodiscard]] v1::Message to_proto(const LogMessage& message);
[[nodiscard]] v1::MachineStatus to_proto(const MachineSnapshot& snapshot);

/// The status with the error's detail; OK for a result that is good.
[[nodiscard]] grpc::Status to_status(const Error& error);
[[nodiscard]] grpc::Status to_status(const Result<void>& result);
[[nodiscard]] grpc::Status invalid_argument(std::string message);

}  // namespace cnc::server::rpc
