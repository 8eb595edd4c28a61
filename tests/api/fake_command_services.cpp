// What the fake server is told to do: motion, homing, single lines, the job.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cnc/v1/job.grpc.pb.h"
#include "cnc/v1/motion.grpc.pb.h"
#include "tests/api/fake_services.h"

namespace cnc::test {
namespace {

using grpc::ServerContext;
using grpc::Status;

/// For Home, Execute and RunSub: lasts for as long as the test wants, or until it is cancelled.
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
  Status AcceptPosition(ServerContext*, const v1::AcceptPositionRequest* request,
                        v1::AcceptPositionResponse*) override {
    std::string axes;
    for (const int axis : request->axes()) axes += v1::Axis_Name(static_cast<v1::Axis>(axis)) + ' ';
    return note_call(machine, "AcceptPosition", axes);
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
  Status Answer(ServerContext*, const v1::AnswerRequest* request, v1::AnswerResponse*) override {
    const Status status =
        note_call(machine, "Answer",
                  fmt::format("{} {} {}", request->number(), request->confirmed() ? "OK" : "Cancel",
                              fmt::join(request->values(), " ")));
    const std::lock_guard lock(machine.mutex);
    if (status.ok() && machine.when_answered) machine.when_answered(machine);
    return status;
  }
  Status RunSub(ServerContext* context, const v1::RunSubRequest* request,
                v1::RunSubResponse*) override {
    if (const Status status = note_call(machine, "RunSub", request->name()); !status.ok())
      return status;
    return move(machine, *context);
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

}  // namespace

FakeService make_fake_motion_service(FakeMachine& machine) {
  return std::make_unique<MotionService>(machine);
}
FakeService make_fake_homing_service(FakeMachine& machine) {
  return std::make_unique<HomingService>(machine);
}
FakeService make_fake_mdi_service(FakeMachine& machine) {
  return std::make_unique<MdiService>(machine);
}
FakeService make_fake_job_service(FakeMachine& machine) {
  return std::make_unique<JobService>(machine);
}

}  // namespace cnc::test
