// Puts the services on a unix socket and on TCP, with health and reflection services beside them.
#pragma once

#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/service_type.h>
#include <memory>
#include <string>
#include <vector>

#include "server/rpc/host.h"

namespace cnc::server::rpc {

class GrpcServer {
 public:
  /// `addresses` as gRPC spells them: "unix:///run/…", "127.0.0.1:port" (port 0 = any free one).
  [[nodiscard]] static Result<std::unique_ptr<GrpcServer>> start(
      Host& host, const std::vector<std::string>& addresses);
  /// Calls under way are cancelled after a short while.
  ~GrpcServer();

  /// The port that each address got; 1 for a unix socket.
  [[nodiscard]] const std::vector<int>& ports() const { return ports_; }

 private:
  GrpcServer() = default;

  std::vector<std::unique_ptr<grpc::Service>> services_;
  std::vector<int> ports_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace cnc::server::rpc
