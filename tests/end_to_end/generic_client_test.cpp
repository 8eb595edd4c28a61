// What every gRPC tool expects of a server: the health service and reflection, asked for with raw
// bytes, as a client without our proto files would.
#include <catch2/catch.hpp>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::test;

namespace {

grpc::ByteBuffer buffer_of(std::string_view bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size());
  return {&slice, 1};
}

std::string bytes_of(const grpc::ByteBuffer& buffer) {
  grpc::Slice slice;
  if (!buffer.DumpToSingleSlice(&slice).ok()) return {};
  return {reinterpret_cast<const char*>(slice.begin()), slice.size()};
}

/// Sends one message and reads one, whether or not the method streams.
class RawCall {
 public:
  RawCall(const std::string& address, const std::string& method)
      : stub_(grpc::CreateChannel(address, grpc::InsecureChannelCredentials())) {
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
    call_ = stub_.PrepareCall(&context_, method, &queue_);
  }

  /// The answer's bytes; empty when there is none, `status` says why.
  std::string exchange(std::string_view request) {
    grpc::ByteBuffer answer;
    call_->StartCall(nullptr);
    const bool answered = step() && write(request) && read(answer);
    call_->Finish(&status, nullptr);
    step();
    return answered ? bytes_of(answer) : std::string{};
  }

  grpc::Status status;

 private:
  bool write(std::string_view request) {
    call_->WriteLast(buffer_of(request), grpc::WriteOptions(), nullptr);
    return step();
  }
  bool read(grpc::ByteBuffer& answer) {
    call_->Read(&answer, nullptr);
    return step();
  }
  bool step() {
    void* tag = nullptr;
    bool good = false;
    return queue_.Next(&tag, &good) && good;
  }

  grpc::GenericStub stub_;
  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

}  // namespace

TEST_CASE("The health service says that the server serves", "[ARC-3][e2e]") {
  const ServerFolder folder;
  const RunningServer server(folder);
  RawCall call(folder.address(), "/grpc.health.v1.Health/Check");
  // HealthCheckRequest{} is empty; HealthCheckResponse{status: SERVING} is field 1, varint 1.
  CHECK(call.exchange("") == std::string("\x08\x01"));
  CHECK(call.status.ok());
}

TEST_CASE("Reflection lists the services", "[ARC-3][e2e]") {
  const ServerFolder folder;
  const RunningServer server(folder);
  RawCall call(folder.address(), "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo");
  // ServerReflectionRequest{list_services: "*"}: field 7, length 1.
  const std::string answer = call.exchange("\x3a\x01*");
  for (const char* service :
       {"System", "Status", "Motion", "Homing", "Jog", "Job", "Mdi", "Messages"})
    CHECK_THAT(answer, Catch::Contains("cnc.v1." + std::string(service)));
}

TEST_CASE("A method that does not exist is answered as unimplemented", "[ARC-3][e2e]") {
  const ServerFolder folder;
  const RunningServer server(folder);
  RawCall call(folder.address(), "/cnc.v1.Motion/Explode");
  static_cast<void>(call.exchange(""));
  CHECK(call.status.error_code() == grpc::StatusCode::UNIMPLEMENTED);
}

TEST_CASE("A request that is no message of the API is refused and harms nothing", "[ARC-3][e2e]") {
  const ServerFolder folder;
  const RunningServer server(folder);
  RawCall broken(folder.address(), "/cnc.v1.Job/Load");
  static_cast<void>(broken.exchange("\x0a\xff\xff\xff\xff\x0f not a protobuf"));
  CHECK_FALSE(broken.status.ok());
  RawCall huge(folder.address(), "/cnc.v1.Mdi/Execute");
  static_cast<void>(huge.exchange(std::string(2 << 20, 'x')));  // 1 MiB is the most
  CHECK_FALSE(huge.status.ok());
  CHECK(server.client.version());
}
