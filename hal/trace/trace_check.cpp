#include "hal/trace/trace_check.h"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

#include "hal/trace/field_walkers.h"

namespace cnc::hal::trace {
namespace {

constexpr double kLongestUptime = 1e9;  // s, 30 years
constexpr double kFarthest = 1e9;       // mm or degrees, and that per second

/// Finds the first field that is not finite.
class FiniteCheck : public FieldWalker<FiniteCheck> {
 public:
  void enter(std::string_view name) { path_.push_back(name); }
  void leave() { path_.pop_back(); }
  template <typename T>
  void leaf(std::string_view name, const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (std::isfinite(value) || !found_.empty()) return;
      path_.push_back(name);
      found_ = fmt::format("{}", fmt::join(path_, "."));
      path_.pop_back();
    }
  }
  /// Its full name; empty: all are.
  [[nodiscard]] const std::string& found() const { return found_; }

 private:
  std::vector<std::string_view> path_;
  std::string found_;
};

std::optional<std::string> first_not_finite(const Trace& trace) {
  FiniteCheck check;
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    for (const Request& request : trace.steps[i].requests)
      std::visit([&](const auto& fields) { visit_fields(check, fields); }, request);
    if (!check.found().empty())
      return fmt::format("has, in a request before exchange {}, a {} that is not a finite number",
                         i, check.found());
    visit_fields(check, trace.steps[i].exchange);
    if (!check.found().empty())
      return fmt::format("has, in exchange {}, a {} that is not a finite number", i, check.found());
  }
  return std::nullopt;
}

/// Settings that make no machine.
std::optional<std::string> bad_setting(const cpu5::DriverSettings& driver) {
  struct Row {
    std::string_view name;
    double value;
    double least;
    double most;
  };
  for (const Row& row : {Row{"max_step_frequency", driver.max_step_frequency, 1.0, 495e3},
                         Row{"host_timeout", driver.host_timeout, 0.0, 3600.0},
                         Row{"index_timeout", driver.index_timeout, 0.0, 3600.0}})
    if (!(row.value >= row.least && row.value <= row.most))
      return fmt::format("has a {} of {}, which has to be {} to {}", row.name, row.value, row.least,
                         row.most);
  return std::nullopt;
}

std::optional<std::string> bad_clock(const Trace& trace) {
  const double first = trace.steps.front().exchange.now;
  double before = first;
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    const double now = trace.steps[i].exchange.now;
    if (std::abs(now) > kLongestUptime)
      return fmt::format("has its exchange {} at {} s, which no computer's clock shows", i, now);
    if (now < before)
      return fmt::format("has its exchange {} {} s before the one before it", i, before - now);
    if (now - first > kLongestTrace) return fmt::format("covers more than {} s", kLongestTrace);
    before = now;
  }
  return std::nullopt;
}

// --- what a board says ---------------------------------------------------------------------------

/// Of the board since it was last reset.
class BoardClock {
 public:
  /// What is wrong with the next status.
  [[nodiscard]] std::optional<std::string> follow(const ControllerStatus& status) {
    const double before = std::exchange(before_, status.time);
    const bool was_reset = started_ && status.sessions != sessions_ && status.counts_lost;
    if (!started_ || was_reset) first_ = status.time;
    const bool went_back = started_ && !was_reset && status.time < before;
    sessions_ = status.sessions;
    started_ = true;
    if (went_back) return fmt::format("goes back from {} to {} s", before, status.time);
    if (status.time < 0.0 || status.time > kLongestUptime)
      return fmt::format("is {} s", status.time);
    if (status.time - first_ > 2.0 * kLongestTrace)
      return fmt::format("has gone from {} to {} s within a trace", first_, status.time);
    return std::nullopt;
  }

 private:
  bool started_ = false;
  std::uint32_t sessions_ = 0;
  double first_ = 0.0;
  double before_ = 0.0;
};

[[nodiscard]] bool too_far(const Position& position) {
  for (const Axis axis : kAllAxes)
    if (std::abs(position[axis]) > kFarthest) return true;
  return false;
}

std::optional<std::string> absurdity_of(const ControllerStatus& status) {
  if (status.executing_phase < 0.0 || status.executing_phase > 1.0)
    return fmt::format("{} of the segment in execution has passed", status.executing_phase);
  if (too_far(status.position)) return "a position is farther than any machine goes";
  return std::nullopt;
}

std::optional<std::string> absurdity_of(const Request& request) {
  if (const auto* segment = std::get_if<Segment>(&request)) {
    if (too_far(segment->position) || too_far(segment->velocity))
      return "a segment goes farther or faster than any machine";
    if (std::abs(segment->duration) > kLongestTrace)
      return fmt::format("a segment takes {} s", segment->duration);
  }
  if (const auto* set = std::get_if<SetPosition>(&request))
    if (std::abs(set->position) > kFarthest)
      return "an axis is put farther away than any machine goes";
  return std::nullopt;
}

}  // namespace

std::optional<std::string> what_no_server_writes(const Trace& trace) {
  if (auto bad = bad_setting(trace.about.driver)) return bad;
  if (auto bad = first_not_finite(trace)) return bad;
  return bad_clock(trace);
}

std::optional<std::string> what_no_board_says(const Trace& trace) {
  BoardClock clock;
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    const auto at = [i](const std::string& what) {
      return fmt::format("In exchange {} {}.", i, what);
    };
    for (const Request& request : trace.steps[i].requests)
      if (const auto what = absurdity_of(request)) return at(*what);
    const ControllerStatus& status = trace.steps[i].exchange.status;
    if (!status.connected) continue;
    if (const auto what = clock.follow(status)) return at("the board's time " + *what);
    if (const auto what = absurdity_of(status)) return at(*what);
  }
  return std::nullopt;
}

}  // namespace cnc::hal::trace
