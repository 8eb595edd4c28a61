#include <algorithm>

#include "cnc/v1/status.grpc.pb.h"
#include "server/rpc/host.h"
#include "server/rpc/stream.h"

namespace cnc::server::rpc {
namespace {

constexpr double kDefaultRate = 20.0;
constexpr double kMaxRate = 100.0;

class StatusService final : public v1::Status::CallbackService {
 public:
  explicit StatusService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* Get(grpc::CallbackServerContext*, const v1::GetStatusRequest*,
                                v1::MachineStatus* response) override {
    *response = to_proto(*host_.machine.snapshots().newest());
    return answer(grpc::Status::OK);
  }

  grpc::ServerWriteReactor<v1::MachineStatus>* Watch(
      grpc::CallbackServerContext*, const v1::WatchStatusRequest* request) override {
    const double wanted = request->max_rate() > 0.0 ? request->max_rate() : kDefaultRate;
    const std::chrono::duration<double> period(1.0 / std::clamp(wanted, 1.0, kMaxRate));
    auto fill = [&board = host_.machine.snapshots(),
                 last = std::uint64_t{0}](v1::MachineStatus& message) mutable {
      const auto newest = board.newest();
      if (newest->sequence == last) return false;
      last = newest->sequence;
      message = to_proto(*newest);
      return true;
    };
    return PolledStream<v1::MachineStatus>::start(
        host_.fanout, std::chrono::duration_cast<std::chrono::microseconds>(period), fill);
  }

 private:
  Host& host_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_status_service(Host& host) {
  return std::make_unique<StatusService>(host);
}

}  // namespace cnc::server::rpc
