#include "server/rpc/grpc_server.h"

#include <chrono>
#include <fmt/format.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>

namespace cnc::server::rpc {

namespace {

/// A client that has vanished without a word (cable, power) is noticed by unanswered pings: its
/// calls are cancelled, and with them the motion that it asked for. Clients may ping, too.
void keep_alive(grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 2000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 2000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 500);
}

}  // namespace

std::vector<std::unique_ptr<grpc::Service>> make_services(Host& host) {
  std::vector<std::unique_ptr<grpc::Service>> services;
  for (auto* make :
       {make_system_service, make_status_service, make_motion_service, make_homing_service,
        make_jog_service, make_job_service, make_mdi_service, make_messages_service})
    services.push_back(make(host));
  return services;
}

Result<std::unique_ptr<GrpcServer>> GrpcServer::start(Host& host,
                                                      const std::vector<std::string>& addresses) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();

  std::unique_ptr<GrpcServer> server(new GrpcServer);
  server->services_ = make_services(host);
  server->ports_.resize(addresses.size(), 0);

  grpc::ServerBuilder builder;
  // A request of this API is small; anything larger is a mistake or an attack.
  builder.SetMaxReceiveMessageSize(1 << 20);
  // Without this a second server would silently share the port of the first.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  keep_alive(builder);
  for (std::size_t i = 0; i < addresses.size(); ++i)
    builder.AddListeningPort(addresses[i], grpc::InsecureServerCredentials(), &server->ports_[i]);
  for (auto& service : server->services_) builder.RegisterService(service.get());
  server->server_ = builder.BuildAndStart();

  for (std::size_t i = 0; i < addresses.size(); ++i)
    if (!server->server_ || server->ports_[i] == 0)
      return fail(
          ErrorCode::address_not_available,
          fmt::format("Cannot listen on {}: is another server running there?", addresses[i]));
  return server;
}

GrpcServer::~GrpcServer() {
  if (server_) server_->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(1));
}

}  // namespace cnc::server::rpc
