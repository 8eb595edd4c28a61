#include "tests/api/fake_server.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <stdlib.h>
#include <stop_token>
#include <thread>

#include "cnc/v1/job.grpc.pb.h"
#include "cnc/v1/jog.grpc.pb.h"
#include "cnc/v1/messages.grpc.pb.h"
#include "cnc/v1/motion.grpc.pb.h"
#include "cnc/v1/status.grpc.pb.h"
#include "cnc/v1/system.grpc.pb.h"

namespace cnc::test {
namespace {

using grpc::ServerContext;
using grpc::Status;
using namespace std::chrono_literals;

/// gRPC's synchronous services tell a cancellation only to those who ask.
constexpr auto kAskAgain = 5ms;

Status note_call(FakeMachine& machine, const std::string& name, const std::string& arguments = "") {
  const std::lock_guard lock(machine.mutex);
  machine.calls.push_back(arguments.empty() ? name : name + ' ' + arguments);
  machine.changed.notify_all();
  const auto failure = machine.failures.find(name);
  return failure == machine.failures.end() ? Status::OK : failure->second;
}

/// For Home and Execute: lasts for as long as the test wants, or until it is cancelled.
Status move(FakeMachine& machine, ServerContext& context) {
  std::unique_lock lock(machine.mutex);
  while (machine.hold_motion) {
    if (context.IsCancelled()) {
      ++machine.cancelled_calls;
      machine.changed.notify_all();
      return Status::CANCELLED;
    }
    machine.changed.wait_for(lock, kAskAgain);
  }
  return Status::OK;
}

struct SystemService final : v1::System::Service {
  explicit SystemService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status GetVersion(ServerContext*, const v1::GetVersionRequest*,
                    v1::GetVersionResponse* response) override {
    const Status status = note_call(machine, "GetVersion");
    const std::lock_guard lock(machine.mutex);
    response->set_server_version("9.8.7");
    response->set_api_major(machine.api_major);
    response->set_api_minor(4);
    response->set_controller("a fake board");
    return status;
  }
  Status GetMachine(ServerContext*, const v1::GetMachineRequest*,
                    v1::GetMachineResponse* response) override {
    response->set_homing_mandatory(true);
    for (const v1::Axis axis : {v1::AXIS_X, v1::AXIS_Y, v1::AXIS_Z}) {
      v1::AxisDescription& description = *response->add_axes();
      description.set_axis(axis);
      description.set_negative_limit(-1.5);
      description.set_positive_limit(300.0 + static_cast<int>(axis));
      description.set_max_velocity(50.0);
      description.set_max_acceleration(400.0);
      description.set_home_position(2.0);
    }
    return note_call(machine, "GetMachine");
  }
  Status GetLinkStatistics(ServerContext*, const v1::GetLinkStatisticsRequest* request,
                           v1::GetLinkStatisticsResponse* response) override {
    response->set_cycles(1000);
    response->set_cycle_time(0.001);
    response->set_max_lateness(0.00025);
    v1::HistogramBin& bin = *response->add_lateness();
    bin.set_upper(std::numeric_limits<double>::infinity());
    bin.set_count(7);
    return note_call(machine, "GetLinkStatistics", request->reset() ? "reset" : "");
  }
};

struct StatusService final : v1::Status::Service {
  explicit StatusService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status Get(ServerContext*, const v1::GetStatusRequest*, v1::MachineStatus* response) override {
    const Status status = note_call(machine, "Get");
    const std::lock_guard lock(machine.mutex);
    *response = machine.status;
    return status;
  }
  Status Watch(ServerContext* context, const v1::WatchStatusRequest* request,
               grpc::ServerWriter<v1::MachineStatus>* writer) override {
    if (const Status status = note_call(machine, "Watch"); !status.ok()) return status;
    const double rate = request->max_rate() > 0.0 ? request->max_rate() : 20.0;
    const std::chrono::duration<double> period(1.0 / rate);
    std::unique_lock lock(machine.mutex);
    auto next = std::chrono::steady_clock::now();
    while (!context->IsCancelled()) {
      if (!machine.silent && std::chrono::steady_clock::now() >= next) {
        next += std::chrono::duration_cast<std::chrono::steady_clock::duration>(period);
        machine.status.set_sequence(machine.status.sequence() + 1);
        if (!writer->Write(machine.status)) break;
        machine.changed.notify_all();
      }
      machine.changed.wait_for(lock, kAskAgain);
    }
    return Status::OK;
  }
};

struct MotionService final : v1::Motion::Service {
  explicit MotionService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status Reset(ServerContext*, const v1::ResetRequest*, v1::ResetResponse*) override {
    return note_call(machine, "Reset");
  }
  Status SetOverrides(ServerContext*, const v1::SetOverridesRequest* request,
                      v1::SetOverridesResponse* response) override {
    std::string given;
    if (request->has_feed()) given += fmt::format("feed={} ", request->feed());
    if (request->has_rapid()) given += fmt::format("rapid={} ", request->rapid());
    if (request->has_speed()) given += fmt::format("speed={} ", request->speed());
    response->set_feed(request->has_feed() ? request->feed() : 1.0);
    response->set_rapid(request->has_rapid() ? request->rapid() : 1.0);
    response->set_speed(request->has_speed() ? request->speed() : 1.0);
    return note_call(machine, "SetOverrides", given);
  }
  Status SetWorkZero(ServerContext*, const v1::SetWorkZeroRequest* request,
                     v1::SetWorkZeroResponse*) override {
    std::string coordinates;
    for (const v1::WorkCoordinate& each : request->coordinates()) {
      coordinates += fmt::format("{}={} ", v1::Axis_Name(each.axis()), each.value());
    }
    return note_call(machine, "SetWorkZero", coordinates);
  }
  Status SimulateEstop(ServerContext*, const v1::SimulateEstopRequest* request,
                       v1::SimulateEstopResponse*) override {
    return note_call(machine, "SimulateEstop", request->pressed() ? "pressed" : "released");
  }
};

struct HomingService final : v1::Homing::Service {
  explicit HomingService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status Home(ServerContext* context, const v1::HomeRequest* request, v1::HomeResponse*) override {
    std::string axes;
    for (const int axis : request->axes()) axes += v1::Axis_Name(static_cast<v1::Axis>(axis)) + ' ';
    if (const Status status = note_call(machine, "Home", axes); !status.ok()) return status;
    return move(machine, *context);
  }
};

struct MdiService final : v1::Mdi::Service {
  explicit MdiService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status Execute(ServerContext* context, const v1::ExecuteRequest* request,
                 v1::ExecuteResponse*) override {
    if (const Status status = note_call(machine, "Execute", request->line()); !status.ok()) {
      return status;
    }
    return move(machine, *context);
  }
};

struct JobService final : v1::Job::Service {
  explicit JobService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status Load(ServerContext*, const v1::LoadRequest* request, v1::LoadResponse* response) override {
    response->set_path(request->path());
    response->set_lines(12);
    response->set_bytes(345);
    return note_call(machine, "Load", request->path());
  }
  Status Run(ServerContext*, const v1::RunRequest*, v1::RunResponse*) override {
    const Status status = note_call(machine, "Run");
    const std::lock_guard lock(machine.mutex);
    if (status.ok() && machine.when_run) machine.when_run(machine);
    return status;
  }
  Status Pause(ServerContext*, const v1::PauseRequest*, v1::PauseResponse*) override {
    return note_call(machine, "Pause");
  }
  Status Resume(ServerContext*, const v1::ResumeRequest*, v1::ResumeResponse*) override {
    return note_call(machine, "Resume");
  }
  Status Stop(ServerContext*, const v1::StopRequest*, v1::StopResponse*) override {
    return note_call(machine, "Stop");
  }
  Status Rewind(ServerContext*, const v1::RewindRequest*, v1::RewindResponse*) override {
    return note_call(machine, "Rewind");
  }
  Status ReadLines(ServerContext*, const v1::ReadLinesRequest* request,
                   v1::ReadLinesResponse* response) override {
    response->set_first(request->first());
    for (std::uint32_t i = 0; i < request->count(); ++i) {
      response->add_lines(fmt::format("N{}", request->first() + i));
    }
    return note_call(machine, "ReadLines");
  }
  Status GetProblems(ServerContext*, const v1::GetProblemsRequest*,
                     v1::GetProblemsResponse* response) override {
    const Status status = note_call(machine, "GetProblems");
    const std::lock_guard lock(machine.mutex);
    for (const v1::Problem& problem : machine.problems) *response->add_problems() = problem;
    response->set_complete(true);
    return status;
  }
};

struct MessagesService final : v1::Messages::Service {
  explicit MessagesService(FakeMachine& m) : machine(m) {}
  FakeMachine& machine;

  Status List(ServerContext*, const v1::ListMessagesRequest* request,
              v1::ListMessagesResponse* response) override {
    const Status status = note_call(machine, "List");
    const std::lock_guard lock(machine.mutex);
    for (const v1::Message& message : machine.messages) {
      if (message.sequence() > request->after()) *response->add_messages() = message;
    }
    return status;
  }
  Status Watch(ServerContext* context, const v1::WatchMessagesRequest* request,
               grpc::ServerWriter<v1::Message>* writer) override {
    std::uint64_t after = request->after();
    std::unique_lock lock(machine.mutex);
    while (!context->IsCancelled()) {
      for (const v1::Message& message : machine.messages) {
        if (message.sequence() <= after) continue;
        if (!writer->Write(message)) return Status::OK;
        after = message.sequence();
      }
      machine.changed.wait_for(lock, kAskAgain);
    }
    return Status::OK;
  }
};

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

struct FakeServer::Services {
  explicit Services(FakeMachine& machine)
      : system(machine),
        status(machine),
        motion(machine),
        homing(machine),
        mdi(machine),
        job(machine),
        messages(machine),
        jog(machine) {}

  SystemService system;
  StatusService status;
  MotionService motion;
  HomingService homing;
  MdiService mdi;
  JobService job;
  MessagesService messages;
  JogService jog;
};

FakeServer::FakeServer(FakeMachine& machine, const std::string& address)
    : services_(std::make_unique<Services>(machine)), address_(address) {
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&services_->system);
  builder.RegisterService(&services_->status);
  builder.RegisterService(&services_->motion);
  builder.RegisterService(&services_->homing);
  builder.RegisterService(&services_->mdi);
  builder.RegisterService(&services_->job);
  builder.RegisterService(&services_->messages);
  builder.RegisterService(&services_->jog);
  server_ = builder.BuildAndStart();
  if (address.ends_with(":0")) {
    address_ = address.substr(0, address.size() - 1) + std::to_string(port);
  }
}

FakeServer::~FakeServer() { server_->Shutdown(std::chrono::system_clock::now()); }

TemporaryFolder::TemporaryFolder() {
  path_ = (std::filesystem::temp_directory_path() / "cnc_api_XXXXXX").string();
  if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no temporary folder");
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace cnc::test
