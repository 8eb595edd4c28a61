#include "cnc/v1/motion.grpc.pb.h"
#include "server/rpc/host.h"

namespace cnc::server::rpc {
namespace {

/// Nothing when one of them is not named.
std::optional<std::vector<Axis>> axes_from(const google::protobuf::RepeatedField<int>& numbers) {
  std::vector<Axis> axes;
  for (const int number : numbers) {
    const auto axis = axis_from(static_cast<v1::Axis>(number));
    if (!axis) return std::nullopt;
    axes.push_back(*axis);
  }
  return axes;
}

class MotionService final : public v1::Motion::CallbackService {
 public:
  explicit MotionService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* Reset(grpc::CallbackServerContext*, const v1::ResetRequest*,
                                  v1::ResetResponse*) override {
    return when_completed(
        host_, [](Machine& machine, Completion done) { machine.reset(std::move(done)); });
  }

  grpc::ServerUnaryReactor* SetOverrides(grpc::CallbackServerContext*,
                                         const v1::SetOverridesRequest* request,
                                         v1::SetOverridesResponse* response) override {
    return on_executor(host_, [request, response](Machine& machine) -> Result<void> {
      Overrides wanted = machine.overrides();
      if (request->has_feed()) wanted.feed = request->feed();
      if (request->has_rapid()) wanted.rapid = request->rapid();
      if (request->has_speed()) wanted.speed = request->speed();
      const auto set = machine.set_overrides(wanted);
      if (!set) return std::unexpected(set.error());
      response->set_feed(set->feed);
      response->set_rapid(set->rapid);
      response->set_speed(set->speed);
      return {};
    });
  }

  grpc::ServerUnaryReactor* SetWorkZero(grpc::CallbackServerContext*,
                                        const v1::SetWorkZeroRequest* request,
                                        v1::SetWorkZeroResponse*) override {
    std::vector<WorkCoordinate> coordinates;
    for (const v1::WorkCoordinate& coordinate : request->coordinates()) {
      const auto axis = axis_from(coordinate.axis());
      if (!axis) return answer(invalid_argument("A coordinate names no axis; axes are X … C."));
      coordinates.push_back({*axis, coordinate.value()});
    }
    return when_completed(
        host_, [coordinates = std::move(coordinates)](Machine& machine, Completion done) {
          if (auto set = machine.set_work_zero(coordinates); !set) return done(set);
          machine.when_saved(std::move(done));
        });
  }

  grpc::ServerUnaryReactor* AcceptPosition(grpc::CallbackServerContext*,
                                           const v1::AcceptPositionRequest* request,
                                           v1::AcceptPositionResponse*) override {
    auto axes = axes_from(request->axes());
    if (!axes) return answer(invalid_argument("An axis to accept is not named; axes are X … C."));
    return on_executor(host_, [axes = std::move(*axes)](Machine& machine) {
      return machine.accept_position(axes);
    });
  }

  grpc::ServerUnaryReactor* SimulateEstop(grpc::CallbackServerContext*,
                                          const v1::SimulateEstopRequest* request,
                                          v1::SimulateEstopResponse*) override {
    if (!host_.simulate_estop)
      return answer({grpc::StatusCode::UNIMPLEMENTED, "The controller is a real board."});
    host_.simulate_estop(request->pressed());
    return answer(grpc::Status::OK);
  }

 private:
  Host& host_;
};

class HomingService final : public v1::Homing::CallbackService {
 public:
  explicit HomingService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* Home(grpc::CallbackServerContext*, const v1::HomeRequest* request,
                                 v1::HomeResponse*) override {
    auto axes = axes_from(request->axes());
    if (!axes) return answer(invalid_argument("An axis to home is not named; axes are X … C."));
    return when_completed(
        host_,
        [axes = std::move(*axes)](Machine& machine, Completion done) {
          machine.home(axes, std::move(done));
        },
        OnCancel::stop_machine);
  }

 private:
  Host& host_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_motion_service(Host& host) {
  return std::make_unique<MotionService>(host);
}
std::unique_ptr<grpc::Service> make_homing_service(Host& host) {
  return std::make_unique<HomingService>(host);
}

}  // namespace cnc::server::rpc
