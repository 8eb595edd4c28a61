#include "api/src/connection.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>

#include "api/src/convert.h"
#include "api/src/local_error.h"

namespace cnc::api {
namespace {

/// 1000 lines of 4096 characters, as U+FFFD where need be, and room for the frame.
constexpr int kMaxMessageBytes = 16 * 1024 * 1024;

std::shared_ptr<grpc::Channel> make_channel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  // A connection of its own, so that no other client in this process decides when to try again.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1'500);  // bounds one attempt, not the wait
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1'000);
  // A machine is never reached through a web proxy, whatever the environment says.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

struct KindOfStatus {
  grpc::StatusCode status;
  ErrorKind kind;
};
constexpr std::array kKindsOfStatus{
    KindOfStatus{grpc::StatusCode::FAILED_PRECONDITION, ErrorKind::refused},
    KindOfStatus{grpc::StatusCode::RESOURCE_EXHAUSTED, ErrorKind::refused},
    KindOfStatus{grpc::StatusCode::ALREADY_EXISTS, ErrorKind::refused},
    KindOfStatus{grpc::StatusCode::INVALID_ARGUMENT, ErrorKind::invalid},
    KindOfStatus{grpc::StatusCode::OUT_OF_RANGE, ErrorKind::invalid},
    KindOfStatus{grpc::StatusCode::NOT_FOUND, ErrorKind::invalid},
    KindOfStatus{grpc::StatusCode::UNAVAILABLE, ErrorKind::unavailable},
    KindOfStatus{grpc::StatusCode::DEADLINE_EXCEEDED, ErrorKind::timed_out},
    KindOfStatus{grpc::StatusCode::CANCELLED, ErrorKind::cancelled},
    KindOfStatus{grpc::StatusCode::UNIMPLEMENTED, ErrorKind::unsupported},
    KindOfStatus{grpc::StatusCode::PERMISSION_DENIED, ErrorKind::denied},
    KindOfStatus{grpc::StatusCode::UNAUTHENTICATED, ErrorKind::denied},
};

ErrorKind kind_of(grpc::StatusCode status) {
  const auto row = std::ranges::find(kKindsOfStatus, status, &KindOfStatus::status);
  return row == kKindsOfStatus.end() ? ErrorKind::failed : row->kind;
}

/// For a status without an ErrorDetail, which gRPC made and not the server.
std::string sentence(ErrorKind kind, const std::string& address, const std::string& cause) {
  switch (kind) {
    case ErrorKind::unavailable:
      return fmt::format("No server answers at {} ({}).", address, cause);
    case ErrorKind::timed_out:
      return fmt::format("The server at {} did not answer in time.", address);
    case ErrorKind::cancelled:
      return "The call was cancelled.";
    case ErrorKind::unsupported:
      return fmt::format("The server at {} does not know this call ({}).", address, cause);
    case ErrorKind::refused:
    case ErrorKind::invalid:
    case ErrorKind::failed:
    case ErrorKind::incompatible:
    case ErrorKind::denied:
      return fmt::format("The server at {} answered: {}", address, cause);
  }
  return cause;
}

}  // namespace

Client::Impl::Impl(std::string address_, ClientOptions options_)
    : address(std::move(address_)),
      options(options_),
      channel(make_channel(address)),
      system(v1::System::NewStub(channel)),
      status(v1::Status::NewStub(channel)),
      motion(v1::Motion::NewStub(channel)),
      homing(v1::Homing::NewStub(channel)),
      jog(v1::Jog::NewStub(channel)),
      job(v1::Job::NewStub(channel)),
      mdi(v1::Mdi::NewStub(channel)),
      messages(v1::Messages::NewStub(channel)) {}

Result<ServerVersion> Client::Impl::check_version(std::chrono::milliseconds timeout,
                                                  std::stop_token stop) const {
  const auto response = call(*system, &v1::System::Stub::GetVersion, v1::GetVersionRequest(),
                             timeout, std::move(stop));
  if (!response) return std::unexpected(response.error());
  const ServerVersion version = from_wire(*response);
  if (version.api_major == kApiMajor) return version;
  return std::unexpected(make_local_error(
      ErrorKind::incompatible,
      fmt::format(
          "This client speaks API version {}.{}, but the server at {} (cncserver {}) speaks "
          "version {}.{}.",
          kApiMajor, kApiMinor, address, version.server, version.api_major, version.api_minor)));
}

Error Client::Impl::explain(const grpc::Status& failure, bool cancelled_here) const {
  ErrorKind kind = kind_of(failure.error_code());
  v1::ErrorDetail detail;
  const std::string bytes = failure.error_details();
  if (!bytes.empty() && detail.ParseFromString(bytes)) return from_wire(detail, kind);
  // A server that goes down cancels its calls: to the caller that is a lost connection.
  if (kind == ErrorKind::cancelled && !cancelled_here) kind = ErrorKind::unavailable;
  return make_local_error(kind, sentence(kind, address, failure.error_message()));
}

}  // namespace cnc::api
