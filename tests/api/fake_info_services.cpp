// What the fake server shows: versions, the machine, statuses, messages.
#include <limits>
#include <utility>

#include "cnc/v1/messages.grpc.pb.h"
#include "cnc/v1/status.grpc.pb.h"
#include "cnc/v1/system.grpc.pb.h"
#include "tests/api/fake_services.h"

namespace cnc::test {
namespace {

using grpc::ServerContext;
using grpc::Status;

/// One in four below 100 ms, none below 125 ms, the rest below 150 ms.
void fill_fifo(v1::GetLinkStatisticsResponse& out) {
  for (const auto& [upper, count] : {std::pair{0.1, 1U}, {0.125, 0U}, {0.15, 3U}}) {
    v1::HistogramBin& bin = *out.add_fifo_time();
    bin.set_upper(upper);
    bin.set_count(count);
  }
}

void fill_latches(v1::GetLinkStatisticsResponse& out) {
  v1::LatchCatch& home = *out.add_latches();
  home.set_source(v1::LATCH_SOURCE_HOME);
  home.set_axis(v1::AXIS_Y);
  home.set_age(61.5);
  home.mutable_position()->set_y(-2.5);
  v1::LatchCatch& estop = *out.add_latches();
  estop.set_source(v1::LATCH_SOURCE_ESTOP);
  estop.set_age(0.25);
  estop.set_count(3);
  estop.mutable_position()->set_x(10.25);
  estop.mutable_position()->set_z(-4.0);
  out.add_latches()->set_source(static_cast<v1::LatchSource>(99));  // of a newer server
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
    response->set_picture_folder("/data/dialogPictures");
    for (const v1::Axis axis : {v1::AXIS_X, v1::AXIS_Y, v1::AXIS_Z}) {
      v1::AxisDescription& description = *response->add_axes();
      description.set_axis(axis);
      description.set_negative_limit(-1.5);
      description.set_positive_limit(300.0 + static_cast<int>(axis));
      description.set_max_velocity(50.0);
      description.set_max_acceleration(400.0);
      description.set_max_jerk(20'000.0);
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
    response->set_lowest_fifo_time(1e9);
    fill_fifo(*response);
    response->set_last_round_trip(0.0003);
    response->set_mean_round_trip(0.0004);
    response->set_max_round_trip(0.012);
    response->mutable_packets()->set_sent(2000);
    response->mutable_packets()->set_resent(3);
    response->mutable_packets()->set_answered(1990);
    response->mutable_packets()->set_passed_over(4);
    response->mutable_packets()->set_corrupted(5);
    response->set_connected(true);
    response->set_sessions(2);
    response->set_board_name("a fake board");
    response->set_board_serial(77);
    fill_latches(*response);
    return note_call(machine, "GetLinkStatistics", request->reset() ? "reset" : "");
  }
  Status SaveLinkTrace(ServerContext*, const v1::SaveLinkTraceRequest*,
                       v1::SaveLinkTraceResponse* response) override {
    response->set_path("/data/traces/now.trace");
    return note_call(machine, "SaveLinkTrace");
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

}  // namespace

FakeService make_fake_system_service(FakeMachine& machine) {
  return std::make_unique<SystemService>(machine);
}
FakeService make_fake_status_service(FakeMachine& machine) {
  return std::make_unique<StatusService>(machine);
}
FakeService make_fake_messages_service(FakeMachine& machine) {
  return std::make_unique<MessagesService>(machine);
}

}  // namespace cnc::test
