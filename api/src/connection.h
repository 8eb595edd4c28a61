// The channel to one server, its stubs, and how a call is made and its failure explained. Shared by
// a Client and by the sessions and subscriptions that came from it.
#pragma once

#include <chrono>
#include <grpcpp/grpcpp.h>
#include <memory>
#include <stop_token>
#include <string>

#include "api/client.h"
#include "cnc/v1/job.grpc.pb.h"
#include "cnc/v1/jog.grpc.pb.h"
#include "cnc/v1/messages.grpc.pb.h"
#include "cnc/v1/motion.grpc.pb.h"
#include "cnc/v1/status.grpc.pb.h"
#include "cnc/v1/system.grpc.pb.h"

namespace cnc::api {

/// A server that has been silent for so long is taken for lost. Statuses come at least once per
/// second and jog requests are answered at once; a lost server is to be reported within 2 s.
inline constexpr std::chrono::milliseconds kSilenceLimit{1'500};

class Client::Impl {
 public:
  Impl(std::string address, ClientOptions options);

  /// One call with one answer. `stop` cancels it.
  template <typename Stub, typename Request, typename Response>
  [[nodiscard]] Result<Response> call(
      Stub& stub, grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
      const Request& request, std::chrono::milliseconds timeout, std::stop_token stop = {}) const {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + timeout);
    Response response;
    grpc::Status outcome;
    {
      const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
      outcome = (stub.*method)(&context, request, &response);
    }
    if (outcome.ok()) return response;
    return std::unexpected(explain(outcome, stop.stop_requested()));
  }

  /// Asks for the version; an error if its major number is not ours.
  [[nodiscard]] Result<ServerVersion> check_version(std::chrono::milliseconds timeout,
                                                    std::stop_token stop = {}) const;

  /// The error behind a status that is not OK. `cancelled_here`: the caller wanted the call to end.
  [[nodiscard]] Error explain(const grpc::Status& status, bool cancelled_here) const;

  const std::string address;
  const ClientOptions options;
  const std::shared_ptr<grpc::Channel> channel;
  const std::unique_ptr<v1::System::Stub> system;
  const std::unique_ptr<v1::Status::Stub> status;
  const std::unique_ptr<v1::Motion::Stub> motion;
  const std::unique_ptr<v1::Homing::Stub> homing;
  const std::unique_ptr<v1::Jog::Stub> jog;
  const std::unique_ptr<v1::Job::Stub> job;
  const std::unique_ptr<v1::Mdi::Stub> mdi;
  const std::unique_ptr<v1::Messages::Stub> messages;
};

using Connection = Client::Impl;

}  // namespace cnc::api
