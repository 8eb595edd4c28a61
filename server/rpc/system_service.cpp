#include <algorithm>
#include <array>

#include "cnc/v1/system.grpc.pb.h"
#include "server/rpc/host.h"
#include "server/version.h"

namespace cnc::server::rpc {
namespace {

constexpr std::uint32_t kApiMajor = 1;
constexpr std::uint32_t kApiMinor = 0;

template <typename Edges>
void fill(const Histogram<Edges>& histogram,
          google::protobuf::RepeatedPtrField<v1::HistogramBin>* out) {
  for (std::size_t bin = 0; bin < Histogram<Edges>::kBins; ++bin) {
    v1::HistogramBin* row = out->Add();
    row->set_upper(Histogram<Edges>::upper_edge(bin));
    row->set_count(histogram.count(bin));
  }
}

void fill(const LinkStatistics& statistics, v1::GetLinkStatisticsResponse& out) {
  out.set_cycles(statistics.cycles.load(std::memory_order_relaxed));
  out.set_max_lateness(statistics.lateness.max());
  out.set_max_work(statistics.work.max());
  fill(statistics.lateness, out.mutable_lateness());
  fill(statistics.work, out.mutable_work());
  out.set_lowest_fifo_time(statistics.lowest_fifo_time.load(std::memory_order_relaxed));
  fill(statistics.fifo_time, out.mutable_fifo_time());
  out.set_last_round_trip(statistics.last_round_trip.load(std::memory_order_relaxed));
  out.set_mean_round_trip(statistics.round_trip.mean());
  out.set_max_round_trip(statistics.round_trip.max());
  fill(statistics.round_trip, out.mutable_round_trip());
  const hal::PacketCounts packets = statistics.packets();
  out.mutable_packets()->set_sent(packets.sent);
  out.mutable_packets()->set_resent(packets.resent);
  out.mutable_packets()->set_answered(packets.answered);
  out.mutable_packets()->set_passed_over(packets.passed_over);
  out.mutable_packets()->set_corrupted(packets.corrupted);
}

using Latches = google::protobuf::RepeatedPtrField<v1::LatchCatch>;

v1::LatchCatch& add(Latches* out, v1::LatchSource source, double age) {
  v1::LatchCatch& row = *out->Add();
  row.set_source(source);
  row.set_age(age);
  return row;
}

void fill(const LatchSnapshot& latches, Latches* out) {
  const auto age = [&](double time) { return latches.board_time - time; };
  for (const Axis axis : kAllAxes) {
    const hal::Latch& latch = latches.home[axis];
    if (!latch.caught) continue;
    v1::LatchCatch& row = add(out, v1::LATCH_SOURCE_HOME, age(latch.time));
    row.set_axis(to_proto(axis));
    Position position;
    position[axis] = latch.position;
    *row.mutable_position() = to_proto(position);
  }
  if (latches.probe.caught) {
    v1::LatchCatch& row = add(out, v1::LATCH_SOURCE_PROBE, age(latches.probe.time));
    *row.mutable_position() = to_proto(latches.probe.position);
  }
  const auto fill_event = [&](v1::LatchSource source, const hal::EventLatch& latch) {
    if (latch.count == 0) return;
    v1::LatchCatch& row = add(out, source, age(latch.time));
    row.set_count(latch.count);
    *row.mutable_position() = to_proto(latch.position);
  };
  fill_event(v1::LATCH_SOURCE_SPINDLE_INDEX, latches.spindle_index);
  fill_event(v1::LATCH_SOURCE_ESTOP, latches.estop);
}

/// Up to the first 0; what is no ASCII, which only a mad board would send, is a question mark.
std::string text_of(const std::array<char, 16>& name) {
  std::string text(name.begin(), std::ranges::find(name, '\0'));
  std::ranges::replace_if(
      text, [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
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
    fill(statistics, *response);
    const auto shown = host_.machine.snapshots().newest();
    response->set_connected(shown->board_connected);
    response->set_sessions(shown->board_sessions);
    response->set_board_name(text_of(shown->board.name));
    response->set_board_serial(shown->board.serial);
    fill(shown->latches, response->mutable_latches());
    if (request->reset()) statistics.ask_for_reset();
    return answer(grpc::Status::OK);
  }

  grpc::ServerUnaryReactor* SaveLinkTrace(grpc::CallbackServerContext*,
                                          const v1::SaveLinkTraceRequest*,
                                          v1::SaveLinkTraceResponse* response) override {
    auto* call = new UnaryCall;
    host_.save_trace([call, response](const Result<std::filesystem::path>& saved) {
      if (saved) response->set_path(saved->string());
      call->Finish(saved ? grpc::Status::OK : to_status(std::unexpected(saved.error())));
    });
    return call;
  }

 private:
  Host& host_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_system_service(Host& host) {
  return std::make_unique<SystemService>(host);
}

}  // namespace cnc::server::rpc
