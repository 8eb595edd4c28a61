// A server in the test's process: answers what the test tells it to and remembers what it was
// asked.
//
// Its state lies in FakeMachine, so that a FakeServer can be stopped and started again as a real
// one is. Nothing in here sleeps to let time pass: tests wait for what the machine has seen.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/service_type.h>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "cnc/v1/common.pb.h"
#include "cnc/v1/job.pb.h"
#include "cnc/v1/messages.pb.h"
#include "cnc/v1/status.pb.h"
#include "tests/config/temporary_directory.h"
#include "tests/patience.h"

namespace cnc::test {

struct FakeMachine {
  std::mutex mutex;
  std::condition_variable changed;

  // What it answers.
  std::uint32_t api_major = 1;
  std::map<std::string, grpc::Status> failures;  // by call, "Run"
  v1::MachineStatus status;
  std::vector<v1::Message> messages;
  std::vector<v1::Problem> problems;
  bool silent = false;       // accepts status streams and sends nothing
  bool hold_motion = false;  // Home, Execute and RunSub do not come to their end
  // With the mutex held.
  std::function<void(FakeMachine&)> when_run;
  std::function<void(FakeMachine&)> when_answered;

  // What it has seen.
  std::vector<std::string> calls;  // "Home X Z", "Execute G0 X1", …
  int cancelled_calls = 0;
  std::vector<std::vector<double>> jog_rates;  // of every jog request
  double jog_lease = 0.0;
  bool jogging = false;
  int leases_run_out = 0;
  int jog_streams_ended = 0;

  /// Changes it under its lock and wakes everybody.
  template <typename Change>
  void change(Change apply) {
    const std::lock_guard lock(mutex);
    apply(*this);
    changed.notify_all();
  }

  /// Whether the condition becomes true within kPatience.
  template <typename Condition>
  [[nodiscard]] bool becomes(Condition condition) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, kPatience, [&] { return condition(*this); });
  }

  [[nodiscard]] bool has_seen(const std::string& call);
  /// The same, with the mutex held.
  [[nodiscard]] bool saw(const std::string& call) const;
};

/// A status that carries an ErrorDetail as the real server's do.
[[nodiscard]] grpc::Status failure(grpc::StatusCode code, const v1::ErrorDetail& detail);
[[nodiscard]] v1::ErrorDetail error_detail(std::uint32_t code, const std::string& name,
                                           const std::string& message, const std::string& check);

class FakeServer {
 public:
  /// Listens at "unix:///…" or "127.0.0.1:0".
  FakeServer(FakeMachine& machine, const std::string& address);
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;
  ~FakeServer();

  /// With the port that it got.
  [[nodiscard]] const std::string& address() const { return address_; }

 private:
  std::vector<std::unique_ptr<grpc::Service>> services_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

/// A folder that disappears with this object, for sockets.
struct TemporaryFolder : config::test::TemporaryDirectory {
  [[nodiscard]] std::string socket() const { return "unix://" + file("server.sock").string(); }
};

}  // namespace cnc::test
