#include <algorithm>
#include <cmath>

#include "cnc/v1/jog.grpc.pb.h"
#include "server/rpc/host.h"

namespace cnc::server::rpc {
namespace {

constexpr double kDefaultLease = 0.25;
constexpr double kMinLease = 0.05;
constexpr double kMaxLease = 1.0;
constexpr double kDefaultStepRate = 0.5;

Result<Position> rates_of(const v1::JogRequest& request) {
  Position rates;
  for (const v1::JogVelocity& velocity : request.velocities()) {
    const auto axis = axis_from(velocity.axis());
    if (!axis) return fail(ErrorCode::value_out_of_range, "A jog velocity names no axis.");
    if (!std::isfinite(velocity.rate()) || std::abs(velocity.rate()) > 1.0)
      return fail(ErrorCode::value_out_of_range, "A jog rate is a number from -1 to 1.");
    rates[*axis] = velocity.rate();
  }
  return rates;
}

class JogStream;

/// Whose jog it is: the stream that asked last. Executor thread only.
struct JogOwner {
  const JogStream* stream = nullptr;
};

/// One continuous jog: read a request, jog, answer, read the next. When the stream ends, for
/// whatever reason, the machine is told to stop, unless somebody else has taken over.
class JogStream final : public grpc::ServerBidiReactor<v1::JogRequest, v1::JogResponse> {
 public:
  JogStream(Host& host, JogOwner& owner) : host_(host), owner_(owner) { StartRead(&request_); }

  void OnReadDone(bool ok) override {
    if (!ok) return end(grpc::Status::OK);
    host_.executor.post([this] { serve(); });
  }
  void OnWriteDone(bool ok) override {
    if (!ok) return end(grpc::Status::CANCELLED);
    StartRead(&request_);
  }
  void OnDone() override { delete this; }

 private:
  void serve() {
    const double asked = request_.lease() > 0.0 ? request_.lease() : kDefaultLease;
    const auto rates = rates_of(request_);
    const auto done = rates ? host_.machine.jog(*rates, std::clamp(asked, kMinLease, kMaxLease))
                            : Result<void>(std::unexpected(rates.error()));
    if (!done) return end(to_status(done.error()));
    owner_.stream = this;
    response_.set_moving(host_.machine.state() == State::jogging);
    StartWrite(&response_);
  }

  void end(const grpc::Status& status) {
    host_.executor.post([this, status] {
      if (owner_.stream == this) {
        owner_.stream = nullptr;
        host_.machine.jog_stop();
      }
      Finish(status);
    });
  }

  Host& host_;
  JogOwner& owner_;
  v1::JogRequest request_;
  v1::JogResponse response_;
};

class JogService final : public v1::Jog::CallbackService {
 public:
  explicit JogService(Host& host) : host_(host) {}

  grpc::ServerBidiReactor<v1::JogRequest, v1::JogResponse>* Jog(
      grpc::CallbackServerContext*) override {
    return new JogStream(host_, owner_);
  }

  grpc::ServerUnaryReactor* Step(grpc::CallbackServerContext*, const v1::JogStepRequest* request,
                                 v1::JogStepResponse*) override {
    const auto axis = axis_from(request->axis());
    if (!axis) return answer(invalid_argument("The step names no axis; axes are X … C."));
    const double distance = request->distance();
    const double rate = request->rate() != 0.0 ? request->rate() : kDefaultStepRate;
    if (!std::isfinite(distance))
      return answer(invalid_argument("The distance of a step is a number."));
    if (!(rate > 0.0 && rate <= 1.0))
      return answer(invalid_argument("The rate of a step is above 0 and at most 1."));
    return on_executor(host_, [axis = *axis, distance, rate](Machine& machine) {
      return machine.jog_step(axis, distance, rate);
    });
  }

  grpc::ServerUnaryReactor* Stop(grpc::CallbackServerContext*, const v1::JogStopRequest*,
                                 v1::JogStopResponse*) override {
    return on_executor(host_, [](Machine& machine) -> Result<void> {
      machine.jog_stop();
      return {};
    });
  }

 private:
  Host& host_;
  JogOwner owner_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_jog_service(Host& host) {
  return std::make_unique<JogService>(host);
}

}  // namespace cnc::server::rpc
