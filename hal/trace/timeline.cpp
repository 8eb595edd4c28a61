#include "hal/trace/timeline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "hal/counting_round.h"

namespace cnc::hal::trace {
namespace {

/// Part of the board's time-out for its host: shorter silence than that changes nothing there, and
/// when what was sent meanwhile arrived is known.
constexpr double kShortSilence = 0.8;
/// Within it a host gives a silent board up; WireSettings::silence.
constexpr double kPatience = 0.25;
/// Between the greetings of a host that looks for its board.
constexpr double kGreetingInterval = 0.1;
/// Between a request and the status that knows of it, in exchanges.
constexpr std::size_t kLongestWait = 200;
/// Segments that a board can make between two answers: what it has, and what is on its way.
constexpr std::uint32_t kMostBetween = 2 * cpu5::firmware::kFifoCapacity;
/// From an input that a board sees to the motion that shows it (core.h).
constexpr double kPlannedAhead =
    2.5 * cpu5::firmware::kSliceTicks / cpu5::firmware::kTicksPerSecond;  // s

class Timeline {
 public:
  explicit Timeline(const Trace& trace)
      : steps_(trace.steps), short_silence_(short_silence(trace.about.driver)) {
    for (const Step& step : steps_)
      for (const Request& request : step.requests)
        if (const auto* segment = std::get_if<Segment>(&request))
          durations_[segment->id] = segment->duration;
    place_board_clocks();
  }

  [[nodiscard]] std::vector<Event> events() {
    place_arrivals();
    std::optional<std::size_t> heard;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const bool fresh = is_fresh(i);
      if (arrivals_[i]) {
        add(*arrivals_[i], Event::Kind::requests, i);
      } else if (!fresh) {
        add(steps_[i].exchange.now, Event::Kind::silence, i);
      }
      if (!fresh) continue;
      add(board_time(i), Event::Kind::compare, i);
      if (heard) note_between(*heard, i);
      heard = i;
    }
    if (heard) note_silence_at_end(*heard);
    std::ranges::stable_sort(events_, [](const Event& a, const Event& b) {
      return a.time != b.time ? a.time < b.time : a.kind < b.kind;
    });
    return std::move(events_);
  }

 private:
  [[nodiscard]] static double short_silence(const cpu5::DriverSettings& driver) {
    const double timeout = driver.host_timeout > 0.0 ? driver.host_timeout : kPatience;
    return kShortSilence * std::min(timeout, kPatience);
  }
  [[nodiscard]] const ControllerStatus& status(std::size_t i) const {
    return steps_[i].exchange.status;
  }
  [[nodiscard]] bool begins_session(std::size_t i) const {
    return i > 0 && status(i).sessions != status(i - 1).sessions;
  }
  /// Its status is news.
  [[nodiscard]] bool is_fresh(std::size_t i) const {
    return status(i).connected &&
           (i == 0 || status(i).time != status(i - 1).time || begins_session(i));
  }
  void add(double time, Event::Kind kind, std::size_t step) {
    events_.push_back({time, kind, step});
  }

  /// The board's time 0 on the host's clock, anew after each reset.
  void place_board_clocks() {
    power_ups_.assign(1, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (begins_session(i) && status(i).counts_lost)
        power_ups_.push_back(std::numeric_limits<double>::infinity());
      boots_.push_back(power_ups_.size() - 1);
      if (is_fresh(i))
        power_ups_.back() = std::min(power_ups_.back(), steps_[i].exchange.now - status(i).time);
    }
  }
  [[nodiscard]] double board_time(std::size_t i) const {
    return power_ups_[boots_[i]] + status(i).time;
  }

  /// When the requests of each step came to the board, in their order; none: no status ever knew of
  /// them, nor of those behind them.
  void place_arrivals() {
    arrivals_.resize(steps_.size());
    std::optional<std::size_t> heard;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (!steps_[i].requests.empty()) arrivals_[i] = arrival(i, heard);
      if (is_fresh(i)) heard = i;
    }
    double next = std::numeric_limits<double>::infinity();
    for (std::size_t i = steps_.size(); i-- > 0;) {
      if (arrivals_[i]) next = std::min(*arrivals_[i], next);
      if (arrivals_[i]) arrivals_[i] = next;
      if (begins_session(i)) next = std::numeric_limits<double>::infinity();
    }
  }

  [[nodiscard]] std::optional<double> arrival(std::size_t i,
                                              std::optional<std::size_t> heard) const {
    const std::size_t end = std::min(steps_.size(), i + kLongestWait);
    for (std::size_t k = i; k < end && status(k).sessions == status(i).sessions; ++k) {
      if (!is_fresh(k) || status(k).frames_done < steps_[i].exchange.frame) continue;
      const bool was_at_rest = heard && !status(*heard).moving;
      const auto began = was_at_rest ? beginning_of_motion(i, k) : std::nullopt;
      return began ? std::min(std::max(*began, board_time(*heard)), board_time(k)) : board_time(k);
    }
    return std::nullopt;
  }

  /// A board at rest moves as soon as a segment arrives: how far it has come tells when that was,
  /// also if the first status to tell was late.
  [[nodiscard]] std::optional<double> beginning_of_motion(std::size_t i, std::size_t k) const {
    const auto& requests = steps_[i].requests;
    const auto first = std::ranges::find_if(
        requests, [](const Request& request) { return std::holds_alternative<Segment>(request); });
    if (first == requests.end() || !status(k).moving) return std::nullopt;
    ControllerStatus start;
    start.executing_id = std::get<Segment>(*first).id;
    const auto passed = path_time_between(start, status(k));
    return passed ? std::optional(board_time(k) - *passed) : std::nullopt;
  }

  void note_between(std::size_t before, std::size_t after) {
    const double silence = board_time(after) - board_time(before);
    const bool was_reset = boots_[after] != boots_[before];
    if (was_reset)
      add(std::max(power_ups_[boots_[after]], board_time(before)), Event::Kind::reset, after);
    const bool was_cut = after - before > 1 && silence > (was_reset ? kPatience : short_silence_);
    if (was_cut) {
      add(board_time(before), Event::Kind::cable_out, before);
      const bool new_session = status(after).sessions != status(before).sessions;
      add(board_time(after) - (new_session ? kGreetingInterval : 0.0), Event::Kind::cable_in,
          after);
    }
    if (!was_reset && have_changed(status(before).inputs, status(after).inputs))
      add(moment_of_change(before, after), Event::Kind::inputs, after);
    if (was_reset) add(board_time(after), Event::Kind::inputs, after);
    if (cause_is_gone(status(before), status(after)))
      add(moment_of_change(before, after), Event::Kind::pulse, after);
    if (status(after).sessions == status(before).sessions &&
        status(after).guard_counts != status(before).guard_counts)
      add(moment_of_change(before, after), Event::Kind::card_pulse, after);
  }

  void note_silence_at_end(std::size_t heard) {
    const double silence = steps_.back().exchange.now - steps_[heard].exchange.now;
    if (silence > short_silence_) add(board_time(heard), Event::Kind::cable_out, heard);
  }

  /// Of those that a replay drives; the spindle's index is the virtual spindle's.
  [[nodiscard]] static bool have_changed(Inputs a, Inputs b) {
    a.sync = b.sync;
    return a.home != b.home || a.probe != b.probe || a.estop1 != b.estop1 || a.estop2 != b.estop2 ||
           a.drive_alarm != b.drive_alarm || a.external_error != b.external_error ||
           a.ports != b.ports || a.analog != b.analog || a.hand_wheel_count != b.hand_wheel_count;
  }

  /// A drive's alarm is shown until faults are cleared.
  [[nodiscard]] static bool cause_is_gone(const ControllerStatus& before,
                                          const ControllerStatus& after) {
    const int raised = after.faults & ~before.faults;
    return (raised & static_cast<Faults>(Fault::estop)) != 0 && !after.inputs.estop();
  }

  /// Between two statuses: where a fault stopped the path, or a latch caught it; else in the
  /// middle.
  [[nodiscard]] double moment_of_change(std::size_t before, std::size_t after) const {
    const double from = board_time(before);
    const double to = board_time(after);
    if (status(after).faults != 0 && status(before).faults == 0) {
      if (const auto driven = path_time_between(status(before), status(after)))
        return std::min(from + std::max(*driven, 0.0), to);
    }
    if (const auto stopping = time_of_guard_stop(status(before), status(after)))
      return std::min(std::max(to - *stopping, from), to);
    if (const auto part = part_at_latch(status(before), status(after)))
      return from + std::clamp(*part, 0.0, 1.0) * (to - from);
    return 0.5 * (from + to);
  }

  /// How long a guard rule has been stopping the path. Path time that slows down evenly by r falls
  /// behind by A = r d^2 / 2 in the time d; the scale that a status shows is that of a moment
  /// ahead, lower than 1 by B = r (d + ahead). Hence B d^2 - 2 A d - 2 A ahead = 0.
  [[nodiscard]] std::optional<double> time_of_guard_stop(const ControllerStatus& before,
                                                         const ControllerStatus& after) const {
    const bool begun = before.path_stop == PathStop::none && before.time_scale == 1.0 &&
                       after.path_stop == PathStop::stopping && after.time_scale < 1.0 &&
                       before.guard_counts != after.guard_counts;
    const auto driven = begun ? path_time_between(before, after) : std::nullopt;
    if (!driven) return std::nullopt;
    const double a = std::max(after.time - before.time - *driven, 0.0);
    const double b = 1.0 - after.time_scale;
    return (a + std::sqrt(a * a + 2.0 * a * b * kPlannedAhead)) / b + kPlannedAhead;
  }

  [[nodiscard]] std::optional<double> path_time_between(const ControllerStatus& before,
                                                        const ControllerStatus& after) const {
    if (after.executing_id - before.executing_id > kMostBetween) return std::nullopt;
    double sum = 0.0;
    for (std::uint32_t id = before.executing_id;; id = id_after(id)) {
      const auto found = durations_.find(id);
      if (found == durations_.end()) return std::nullopt;
      sum += found->second;
      if (id == before.executing_id) sum -= before.executing_phase * found->second;
      if (id != after.executing_id) continue;
      return sum - (1.0 - after.executing_phase) * found->second;
    }
  }

  [[nodiscard]] static std::optional<double> part_at_latch(const ControllerStatus& before,
                                                           const ControllerStatus& after) {
    for (const Axis axis : kAllAxes) {
      const Latch& latch = after.home_latch[axis];
      const double way = after.position[axis] - before.position[axis];
      if (latch.caught && !before.home_latch[axis].caught && way != 0.0)
        return (latch.position - before.position[axis]) / way;
    }
    if (!after.probe_latch.caught || before.probe_latch.caught) return std::nullopt;
    const Position way = after.position - before.position;
    const Axis fastest =
        *std::ranges::max_element(kAllAxes, {}, [&](Axis axis) { return std::abs(way[axis]); });
    if (way[fastest] == 0.0) return std::nullopt;
    return (after.probe_latch.position[fastest] - before.position[fastest]) / way[fastest];
  }

  const std::vector<Step>& steps_;
  double short_silence_;                                 // s
  std::unordered_map<std::uint32_t, double> durations_;  // by segment
  std::vector<double> power_ups_;                        // by boot
  std::vector<std::size_t> boots_;                       // by step
  std::vector<std::optional<double>> arrivals_;          // by step
  std::vector<Event> events_;
};

}  // namespace

std::vector<Event> timeline_of(const Trace& trace) { return Timeline(trace).events(); }

}  // namespace cnc::hal::trace
