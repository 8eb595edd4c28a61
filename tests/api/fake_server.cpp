#include "tests/api/fake_server.h"

#include <algorithm>
#include <array>

#include "tests/api/fake_services.h"

namespace cnc::test {
namespace {

constexpr std::array kMakers{make_fake_system_service,   make_fake_status_service,
                             make_fake_messages_service, make_fake_motion_service,
                             make_fake_homing_service,   make_fake_mdi_service,
                             make_fake_job_service,      make_fake_jog_service};

}  // namespace

grpc::Status note_call(FakeMachine& machine, const std::string& name,
                       const std::string& arguments) {
  const std::lock_guard lock(machine.mutex);
  machine.calls.push_back(arguments.empty() ? name : name + ' ' + arguments);
  machine.changed.notify_all();
  const auto failure = machine.failures.find(name);
  return failure == machine.failures.end() ? grpc::Status::OK : failure->second;
}

bool FakeMachine::has_seen(const std::string& call) {
  const std::lock_guard lock(mutex);
  return saw(call);
}

bool FakeMachine::saw(const std::string& call) const {
  return std::ranges::find(calls, call) != calls.end();
}

grpc::Status failure(grpc::StatusCode code, const v1::ErrorDetail& detail) {
  return {code, detail.message(), detail.SerializeAsString()};
}

v1::ErrorDetail error_detail(std::uint32_t code, const std::string& name,
                             const std::string& message, const std::string& check) {
  v1::ErrorDetail detail;
  detail.set_code(code);
  detail.set_name(name);
  detail.set_message(message);
  detail.set_check(check);
  return detail;
}

FakeServer::FakeServer(FakeMachine& machine, const std::string& address) : address_(address) {
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port);
  for (const auto make : kMakers) {
    services_.push_back(make(machine));
    builder.RegisterService(services_.back().get());
  }
  server_ = builder.BuildAndStart();
  if (address.ends_with(":0")) {
    address_ = address.substr(0, address.size() - 1) + std::to_string(port);
  }
}

FakeServer::~FakeServer() { server_->Shutdown(std::chrono::system_clock::now()); }

}  // namespace cnc::test
