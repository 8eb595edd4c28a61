#include "cnc/v1/system.grpc.pb.h"
#include "server/rpc/host.h"
#include "server/version.h"

namespace cnc::server::rpc {
namespace {

constexpr std::uint32_t kApiMajor = 1;
constexpr std::uint32_t kApiMinor = 0;

void fill(const TimeHistogram& histogram,
          google::protobuf::RepeatedPtrField<v1::HistogramBin>* out) {
  for (std::size_t bin = 0; bin < TimeHistogram::kBins; ++bin) {
    v1::HistogramBin* row = out->Add();
    row->set_upper(TimeHistogram::upper_edge(bin));
    row->set_count(histogram.count(bin));
  }
}

class SystemService final : public v1::System::CallbackService {
 public:
  explicit SystemService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* GetVersion(grpc::CallbackServerContext*, const v1::GetVersionRequest*,
                                       v1::GetVersionResponse* response) override {
    response->set_server_version(kServerVersion);
    response->set_api_major(kApiMajor);
    response->set_api_minor(kApiMinor);
    response->set_controller(host_.controller_name);
    return answer(grpc::Status::OK);
  }

  grpc::ServerUnaryReactor* GetMachine(grpc::CallbackServerContext*, const v1::GetMachineRequest*,
                                       v1::GetMachineResponse* response) override {
    // The configuration does not change while the server runs: no need to ask the executor.
    const config::MachineConfig& config = host_.machine.config();
    response->set_inch(config.unit == config::MachineUnit::inch);
    response->set_homing_mandatory(config.safety.homing_mandatory);
    response->set_picture_folder(host_.picture_folder);
    for (const Axis axis : kAllAxes) {
      const config::AxisConfig& from = config.axes[axis];
      if (!from.visible) continue;
      v1::AxisDescription* row = response->add_axes();
      row->set_axis(to_proto(axis));
      row->set_negative_limit(from.negative_limit);
      row->set_positive_limit(from.positive_limit);
      row->set_max_velocity(from.velocity);
      row->set_max_acceleration(from.acceleration);
      row->set_max_jerk(from.jerk);
      row->set_home_position(from.home_position);
    }
    return answer(grpc::Status::OK);
  }

  grpc::ServerUnaryReactor* GetLinkStatistics(grpc::CallbackServerContext*,
                                              const v1::GetLinkStatisticsRequest* request,
                                              v1::GetLinkStatisticsResponse* response) override {
    LinkStatistics& statistics = host_.link.statistics();
    response->set_real_time(host_.real_time);
    response->set_cycle_time(host_.link_period);
    response->set_cycles(statistics.cycles.load(std::memory_order_relaxed));
    response->set_max_lateness(statistics.lateness.max());
    response->set_max_work(statistics.work.max());
    fill(statistics.lateness, response->mutable_lateness());
    fill(statistics.work, response->mutable_work());
    response->set_lowest_fifo_time(statistics.lowest_fifo_time.load(std::memory_order_relaxed));
    if (request->reset()) statistics.reset();
    return answer(grpc::Status::OK);
  }

 private:
  Host& host_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_system_service(Host& host) {
  return std::make_unique<SystemService>(host);
}

}  // namespace cnc::server::rpc
