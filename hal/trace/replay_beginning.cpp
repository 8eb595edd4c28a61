#include "hal/trace/replay_beginning.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "hal/counting_round.h"
#include "hal/trace/replay_judge.h"

namespace cnc::hal::trace {
namespace {

constexpr double kShortestRunUp = 0.01;  // s
constexpr double kLongestRunUp = 10.0;   // s
constexpr double kLongestPiece = 0.1;    // s, of a run-up

/// That a virtual board has in its FIFO with the one in execution.
constexpr std::size_t kMostSegments = cpu5::firmware::kFifoCapacity + 1;

// --- where to begin ------------------------------------------------------------------------------

/// What the board has in its FIFO, as far as it was recorded.
class FifoModel {
 public:
  void apply(const Request& request) {
    if (const auto* segment = std::get_if<Segment>(&request)) segments_.push_back(*segment);
    if (const auto* cut = std::get_if<CutBehind>(&request))
      while (!segments_.empty() && is_newer(segments_.back().id, cut->id)) segments_.pop_back();
    if (std::holds_alternative<QuickStop>(request) ||
        std::holds_alternative<ClearFaults>(request) ||
        std::holds_alternative<ReleaseStop>(request))
      segments_.clear();
  }
  /// The one in execution and all behind it; empty if they are not all known.
  [[nodiscard]] std::span<const Segment> from(const ControllerStatus& status) {
    while (!segments_.empty() && segments_.front().id != status.executing_id &&
           segments_.size() > status.fifo_count)
      segments_.pop_front();
    const bool known = segments_.size() <= kMostSegments &&
                       segments_.size() == std::size_t{status.fifo_count} + 1 &&
                       segments_.front().id == status.executing_id;
    if (!known) return {};
    contiguous_.assign(segments_.begin(), segments_.end());
    return contiguous_;
  }

 private:
  std::deque<Segment> segments_;
  std::vector<Segment> contiguous_;
};

bool is_quiet(const ControllerStatus& status) {
  const bool latched =
      status.probe_latch.armed || std::ranges::any_of(status.home_latch.values, &Latch::armed);
  const bool faulty = status.faults != 0 && (status.faults != static_cast<Faults>(Fault::estop) ||
                                             !status.inputs.estop());
  return !latched && !faulty && !status.cut_late && status.path_stop == PathStop::none;
}

/// To the end of `segment`, of which `rest` is left.
double run_up_to(const Segment& segment, double rest, const config::MachineConfig& config) {
  double time = std::max(kShortestRunUp, rest + kReplayCycle);
  for (const Axis axis : kAllAxes)
    if (const double limit = config.axes[axis].acceleration; limit > 0.0)
      time = std::max(time, std::abs(segment.velocity[axis]) / limit);
  return time;
}

}  // namespace

std::optional<Beginning> find_beginning(const Trace& trace, std::span<const Event> events,
                                        const config::MachineConfig& config) {
  FifoModel fifo;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Step& step = trace.steps[events[i].step];
    if (events[i].kind == Event::Kind::requests)
      for (const Request& request : step.requests) fifo.apply(request);
    const ControllerStatus& status = step.exchange.status;
    if (events[i].kind != Event::Kind::compare || !is_quiet(status)) continue;
    if (!status.moving && status.fifo_count == 0) return Beginning{.event = i};
    const auto path = fifo.from(status);
    if (path.empty() || status.time_scale != 1.0 || status.faults != 0) continue;
    if (std::ranges::any_of(path, follows_spindle)) continue;
    const double rest = (1.0 - status.executing_phase) * path.front().duration;
    const double run_up = run_up_to(path.front(), rest, config);
    if (run_up > kLongestRunUp) continue;
    const auto pieces = static_cast<std::uint32_t>(std::ceil(run_up / kLongestPiece));
    // They are numbered up to the first's number, and no segment has the number 0.
    if (pieces > path.front().id) continue;
    return Beginning{i, {path.begin(), path.end()}, rest, run_up, pieces};
  }
  return std::nullopt;
}

}  // namespace cnc::hal::trace
