// What the gRPC services need of the server, and how they reach the machine.
//
// gRPC calls come on gRPC's threads. A service never touches the machine there: it posts to the
// executor and finishes the call from there, so that the machine has one owner.
#pragma once

#include <filesystem>
#include <functional>
#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/service_type.h>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/daemon/task_thread.h"
#include "server/machine/machine.h"
#include "server/rpc/convert.h"

namespace cnc::server::rpc {

struct Host {
  Machine& machine;  // executor thread only
  TaskThread& executor;
  Link& link;  // statistics() only
  MessageLog& log;
  TaskThread& fanout;                    ///< streams look for something new here
  TaskThread& files;                     ///< opens and indexes job files
  std::filesystem::path job_folder;      ///< relative job paths start here
  std::filesystem::path picture_folder;  ///< absolute; pictures of questions, for clients
  std::string controller_name;
  bool real_time = false;
  double link_period = 0.0;  ///< s
  /// Any thread; the answer comes from a thread of its own.
  std::function<void(std::function<void(const Result<std::filesystem::path>&)>)> save_trace;
  std::function<void(bool)> simulate_estop;  ///< any thread; empty on a real board
};

/// A unary call that the executor answers. gRPC deletes nothing: the object ends itself in OnDone.
class UnaryCall final : public grpc::ServerUnaryReactor {
 public:
  UnaryCall() = default;
  /// `on_cancel` runs on a gRPC thread when the client gives the call up before it is answered.
  explicit UnaryCall(std::function<void()> on_cancel) : on_cancel_(std::move(on_cancel)) {}

  void OnCancel() override {
    if (on_cancel_) on_cancel_();
  }
  void OnDone() override { delete this; }

 private:
  std::function<void()> on_cancel_;
};

/// Runs `task(machine)` on the executor; its Result answers the call.
template <typename Task>
grpc::ServerUnaryReactor* on_executor(Host& host, Task task) {
  auto* call = new UnaryCall;
  host.executor.post([&host, call, task = std::move(task)]() mutable {
    call->Finish(to_status(task(host.machine)));
  });
  return call;
}

enum class OnCancel : std::uint8_t { nothing, stop_machine };

/// Runs `task(machine, completion)` on the executor; the completion answers the call. The machine
/// may be stopped if the client gives the call up before that.
template <typename Task>
grpc::ServerUnaryReactor* when_completed(Host& host, Task task,
                                         OnCancel on_cancel = OnCancel::nothing) {
  const auto pending = std::make_shared<bool>(true);  // executor thread only
  auto* call = new UnaryCall([&host, pending, on_cancel] {
    if (on_cancel == OnCancel::nothing) return;
    host.executor.post([&host, pending] {
      if (*pending) host.machine.stop([](const Result<void>&) {});
    });
  });
  host.executor.post([&host, call, pending, task = std::move(task)]() mutable {
    task(host.machine, Completion([call, pending](const Result<void>& result) {
           *pending = false;
           call->Finish(to_status(result));
         }));
  });
  return call;
}

/// An answer that needs no machine, or one that is refused before it gets there.
[[nodiscard]] inline grpc::ServerUnaryReactor* answer(const grpc::Status& status) {
  auto* call = new UnaryCall;
  call->Finish(status);
  return call;
}

[[nodiscard]] std::vector<std::unique_ptr<grpc::Service>> make_services(Host& host);

// One maker per domain; each in the file of its name.
[[nodiscard]] std::unique_ptr<grpc::Service> make_system_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_status_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_motion_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_homing_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_jog_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_job_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_mdi_service(Host& host);
[[nodiscard]] std::unique_ptr<grpc::Service> make_messages_service(Host& host);

}  // namespace cnc::server::rpc
