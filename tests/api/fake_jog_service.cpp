// The jog stream of the fake server, with its lease.
#include <fmt/format.h>
#include <stop_token>
#include <thread>

#include "cnc/v1/jog.grpc.pb.h"
#include "tests/api/fake_services.h"

namespace cnc::test {
namespace {

using grpc::ServerContext;
using grpc::Status;

/// Keeps the machine moving for the length of a lease, as the real server does.
class Lease {
 public:
  explicit Lease(FakeMachine& machine)
      : machine_(machine), thread_([this](const std::stop_token& stop) { watch(stop); }) {}

  /// With the machine's mutex held.
  void renew(double seconds) {
    end_ = std::chrono::steady_clock::now() +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(
               std::chrono::duration<double>(seconds));
  }

 private:
  void watch(const std::stop_token& stop) {
    std::unique_lock lock(machine_.mutex);
    while (!stop.stop_requested()) {
      if (machine_.jogging && std::chrono::steady_clock::now() > end_) {
        machine_.jogging = false;
        ++machine_.leases_run_out;
        machine_.changed.notify_all();
      }
      machine_.changed.wait_for(lock, kAskAgain);
    }
  }

  FakeMachine& machine_;
  std::chrono::steady_clock::time_point end_;
  std::jthread thread_;
};

struct JogService final : v1::Jog::Service {
  explicit JogService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status Jog(ServerContext*,
             grpc::ServerReaderWriter<v1::JogResponse, v1::JogRequest>* stream) override {
    Lease lease(machine);
    v1::JogRequest request;
    Status status = Status::OK;
    while (status.ok() && stream->Read(&request)) {
      status = note_call(machine, "Jog");
      if (!status.ok()) break;
      bool is_silent = false;
      machine.change([&](FakeMachine& m) {
        std::vector<double> rates(7, 0.0);  // indexed by v1::Axis
        for (const v1::JogVelocity& each : request.velocities())
          rates.at(each.axis()) = each.rate();
        m.jog_rates.push_back(rates);
        m.jog_lease = request.lease();
        m.jogging = request.velocities_size() > 0;
        lease.renew(request.lease());
        is_silent = m.silent;
      });
      v1::JogResponse response;
      response.set_moving(request.velocities_size() > 0);
      if (!is_silent && !stream->Write(response)) break;
    }
    machine.change([](FakeMachine& m) {
      m.jogging = false;
      ++m.jog_streams_ended;
    });
    return status;
  }
  Status Step(ServerContext*, const v1::JogStepRequest* request, v1::JogStepResponse*) override {
    return note_call(machine, "Step",
                     fmt::format("{} {} {}", v1::Axis_Name(request->axis()), request->distance(),
                                 request->rate()));
  }
  Status Stop(ServerContext*, const v1::JogStopRequest*, v1::JogStopResponse*) override {
    return note_call(machine, "JogStop");
  }
};

}  // namespace

FakeService make_fake_jog_service(FakeMachine& machine) {
  return std::make_unique<JogService>(machine);
}

}  // namespace cnc::test
