#include "hal/trace/replay_judge.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "hal/counting_round.h"
#include "hal/fault_names.h"

namespace cnc::hal::trace {
namespace {

/// Statuses before and after, among which a recorded one has its like: delays of the line that
/// nobody knows.
constexpr std::size_t kSlack = 2;
constexpr double kTolerance = 2.0;  // steps

std::string_view text_of(PathStop stop) {
  constexpr std::array<std::string_view, 3> kTexts{"none", "stopping", "stopped"};
  return kTexts.at(static_cast<std::size_t>(stop));
}

struct NamedOutput {
  std::string_view name;
  bool Outputs::*value;
};
constexpr NamedOutput kNamedOutputs[] = {
    {"the output for the drives", &Outputs::drives_enabled},
    {"the spindle's relay", &Outputs::spindle_on},
    {"the tool direction", &Outputs::tool_direction},
    {"mist", &Outputs::mist},
    {"flood", &Outputs::flood},
};

class Judge {
 public:
  Judge(const Trace& trace, std::span<const Seen> seen, const config::MachineConfig& config,
        std::size_t begin)
      : trace_(trace), seen_(seen), config_(config) {
    guards_.begin(trace.steps[begin].exchange.status);
    for (const Step& step : trace.steps)
      for (const Request& request : step.requests)
        if (const auto* segment = std::get_if<Segment>(&request))
          if (follows_spindle(*segment)) spindle_ids_.push_back(segment->id);
    std::ranges::sort(spindle_ids_);
  }

  void judge(ReplayReport& report) {
    bool following = false;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const ControllerStatus& recorded = status(i);
      note_fault(report, i);
      note_late_cut(report, i);
      note_armed(i);
      following = std::ranges::binary_search(spindle_ids_, recorded.executing_id) ||
                  (following && !both_at_rest(i));
      if (following) {
        ++report.following_spindle;
        continue;
      }
      ++report.compared;
      if (auto what = difference(i)) {
        report.difference = Difference{seen_[i].step, std::move(*what)};
        return;
      }
      for (const Axis axis : kAllAxes)
        report.largest_deviation = std::max(
            report.largest_deviation, std::abs(recorded.position[axis] - seen_[i].position[axis]));
    }
  }

 private:
  [[nodiscard]] const ControllerStatus& status(std::size_t i) const {
    return trace_.steps[seen_[i].step].exchange.status;
  }
  [[nodiscard]] bool both_at_rest(std::size_t i) const {
    return !status(i).moving && !seen_[i].moving && status(i).executing_id == seen_[i].executing_id;
  }
  void note_fault(ReplayReport& report, std::size_t i) const {
    const Faults before = report.faults.empty() ? Faults{0} : report.faults.back().faults;
    if (status(i).faults != before) report.faults.push_back({seen_[i].step, status(i).faults});
  }
  void note_late_cut(ReplayReport& report, std::size_t i) const {
    if (status(i).cut_late && (i == 0 || !status(i - 1).cut_late)) ++report.late_cuts;
  }
  /// What a latch shows that has not been armed since the beginning is of before.
  void note_armed(std::size_t i) {
    for (const Axis axis : kAllAxes)
      home_armed_[axis] = home_armed_[axis] || status(i).home_latch[axis].armed;
    probe_armed_ = probe_armed_ || status(i).probe_latch.armed;
  }
  [[nodiscard]] std::span<const Seen> around(std::size_t i) const {
    const std::size_t first = i - std::min(i, kSlack);
    return seen_.subspan(first, std::min(seen_.size(), i + kSlack + 1) - first);
  }

  /// Of the recorded status from everything that was replayed around its moment. A fault explains
  /// whatever else differs.
  [[nodiscard]] std::optional<std::string> difference(std::size_t i) const {
    const Faults faults = status(i).faults;
    const Seen& seen = seen_[i];
    const bool no_such_fault = none_has(i, &Seen::faults, faults);
    std::optional<std::string> other = state_difference(i);
    if (!other) other = place_difference(i);
    if (!other) other = latch_difference(i);
    if (!other) other = output_difference(i);
    if (!other) other = guard_difference(i);
    if (no_such_fault || (other && faults != seen.faults))
      return fmt::format("faults are {}, replayed {}", fault_names(faults),
                         fault_names(seen.faults));
    return other;
  }

  [[nodiscard]] std::optional<std::string> state_difference(std::size_t i) const {
    const ControllerStatus& recorded = status(i);
    if (none_has(i, &Seen::path_stop, recorded.path_stop))
      return fmt::format("the stop along the path is {}, replayed {}", text_of(recorded.path_stop),
                         text_of(seen_[i].path_stop));
    if (none_has(i, &Seen::cut_late, recorded.cut_late))
      return fmt::format("the last cut was {}, replayed {}", recorded.cut_late ? "late" : "in time",
                         seen_[i].cut_late ? "late" : "in time");
    const auto is_passed = [&](const Seen& seen) {
      return !is_newer(recorded.executing_id, seen.executing_id);
    };
    const auto is_reached = [&](const Seen& seen) {
      return !is_newer(seen.executing_id, recorded.executing_id);
    };
    if (std::ranges::none_of(around(i), is_passed) || std::ranges::none_of(around(i), is_reached))
      return fmt::format("segment {} is in execution, replayed {}", recorded.executing_id,
                         seen_[i].executing_id);
    return std::nullopt;
  }

  [[nodiscard]] std::optional<std::string> place_difference(std::size_t i) const {
    for (const Axis axis : kAllAxes) {
      const double recorded = status(i).position[axis];
      const auto [low, high] = std::ranges::minmax(
          around(i), {}, [axis](const Seen& seen) { return seen.position[axis]; });
      const double tolerance = tolerance_of(axis);
      if (recorded >= low.position[axis] - tolerance && recorded <= high.position[axis] + tolerance)
        continue;
      return fmt::format("{} is at {:.4f}, replayed {:.4f}", axis_name(axis), recorded,
                         seen_[i].position[axis]);
    }
    return std::nullopt;
  }

  [[nodiscard]] double tolerance_of(Axis axis) const {
    const double steps = std::abs(config_.axes[axis].steps_per_unit);
    return steps > 0.0 ? kTolerance / steps : 0.0;
  }

  [[nodiscard]] std::optional<std::string> latch_difference(std::size_t i) const {
    for (const Axis axis : kAllAxes) {
      if (!home_armed_[axis]) continue;
      const auto latch_in = [axis](const auto& of) { return of.home_latch[axis]; };
      const auto place_in = [axis](const auto& of) { return of.home_latch[axis].position; };
      const std::string name = fmt::format("the home latch of {}", axis_name(axis));
      if (auto what = caught_difference(i, name, latch_in)) return what;
      if (auto what = catch_difference(i, name, axis, latch_in, place_in)) return what;
    }
    if (!probe_armed_) return std::nullopt;
    const auto latch_in = [](const auto& of) { return of.probe_latch; };
    if (auto what = caught_difference(i, "the probe latch", latch_in)) return what;
    for (const Axis axis : kAllAxes) {
      const auto place_in = [axis](const auto& of) { return of.probe_latch.position[axis]; };
      if (auto what = catch_difference(i, "the probe latch", axis, latch_in, place_in)) return what;
    }
    return std::nullopt;
  }

  template <typename LatchIn>
  [[nodiscard]] std::optional<std::string> caught_difference(std::size_t i, std::string_view name,
                                                             LatchIn latch_in) const {
    const bool caught = latch_in(status(i)).caught;
    if (std::ranges::any_of(around(i),
                            [&](const Seen& seen) { return latch_in(seen).caught == caught; }))
      return std::nullopt;
    return fmt::format("{} has caught {}, replayed {}", name, caught ? "something" : "nothing",
                       caught ? "nothing" : "something");
  }

  /// Where: to the way between the two statuses between which it was.
  template <typename LatchIn, typename PlaceIn>
  [[nodiscard]] std::optional<std::string> catch_difference(std::size_t i, std::string_view name,
                                                            Axis axis, LatchIn latch_in,
                                                            PlaceIn place_in) const {
    if (i == 0 || !latch_in(status(i)).caught || latch_in(status(i - 1)).caught)
      return std::nullopt;
    const double recorded = place_in(status(i));
    const double way = std::abs(status(i).position[axis] - status(i - 1).position[axis]);
    const bool has_like = std::ranges::any_of(around(i), [&](const Seen& seen) {
      return latch_in(seen).caught &&
             std::abs(place_in(seen) - recorded) <= way + tolerance_of(axis);
    });
    if (has_like) return std::nullopt;
    return fmt::format("{} has caught {} at {:.4f}, replayed {:.4f}", name, axis_name(axis),
                       recorded, place_in(seen_[i]));
  }

  /// Digital ones.
  [[nodiscard]] std::optional<std::string> output_difference(std::size_t i) const {
    const auto differs = [&](auto value_of) {
      return std::ranges::none_of(around(i), [&](const Seen& seen) {
        return value_of(seen.outputs) == value_of(status(i).outputs);
      });
    };
    const auto text = [](const auto& name, bool on) {
      return fmt::format("{} is {}, replayed {}", name, on ? "on" : "off", on ? "off" : "on");
    };
    for (const NamedOutput& output : kNamedOutputs)
      if (differs([&](const Outputs& outputs) { return outputs.*output.value; }))
        return text(output.name, status(i).outputs.*output.value);
    for (std::size_t bit = 0; bit < Ports{}.size(); ++bit)
      if (differs([&](const Outputs& outputs) { return bool{outputs.ports[bit]}; }))
        return text(fmt::format("output {}", port_number(bit)), status(i).outputs.ports[bit]);
    return std::nullopt;
  }

  [[nodiscard]] std::optional<std::string> guard_difference(std::size_t i) const {
    const GuardCounts recorded = guards_.since_beginning(status(i));
    for (std::size_t rule = 0; rule < recorded.size(); ++rule) {
      if (std::ranges::any_of(around(i), [&](const Seen& seen) {
            return seen.guard_counts[rule] == recorded[rule];
          }))
        continue;
      return fmt::format(
          "guard rule {} of card {} has acted {} times since the beginning, "
          "replayed {}",
          rule % config::kRulesPerCard + 1, rule / config::kRulesPerCard + 1, recorded[rule],
          seen_[i].guard_counts[rule]);
    }
    return std::nullopt;
  }

  template <typename Member, typename Value>
  [[nodiscard]] bool none_has(std::size_t i, Member member, Value value) const {
    return std::ranges::none_of(around(i), [&](const Seen& seen) { return seen.*member == value; });
  }

  const Trace& trace_;
  std::span<const Seen> seen_;
  const config::MachineConfig& config_;
  std::vector<std::uint32_t> spindle_ids_;
  AxisArray<bool> home_armed_{};
  bool probe_armed_ = false;
  GuardTally guards_;
};

}  // namespace

void judge(const Trace& trace, std::span<const Seen> seen, const config::MachineConfig& config,
           ReplayReport& report) {
  Judge(trace, seen, config, report.begin).judge(report);
}

}  // namespace cnc::hal::trace
