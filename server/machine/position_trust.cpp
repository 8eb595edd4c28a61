#include "server/machine/position_trust.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace cnc::server {
namespace {

struct Rule {
  TrustEvent event;
  Trust at_best;  ///< of an axis that the event concerns
  std::string_view sentence;
};

constexpr std::array kRules{
    Rule{TrustEvent::stopped_on_the_spot, Trust::doubtful,
         "Axes were stopped without a ramp and may have slipped."},
    Rule{TrustEvent::link_lost, Trust::doubtful,
         "The connection was lost while axes moved: they may have been stopped without a ramp."},
    Rule{TrustEvent::counts_lost, Trust::unknown,
         "The controller board was reset and has lost its step counts: positions are shown where "
         "the axes were last seen."},
    Rule{TrustEvent::steps_lost, Trust::unknown,
         "Drives have raised their alarm: their motors have lost steps."},
    Rule{TrustEvent::homing_begun, Trust::doubtful, "Homing was not finished."},
    Rule{TrustEvent::drives_off, Trust::doubtful,
         "The drives were switched off: nothing held the axes."},
};

static_assert(
    [] {
      for (std::size_t i = 0; i < kRules.size(); ++i)
        if (static_cast<std::size_t>(kRules[i].event) != i) return false;
      return true;
    }(),
    "rows stand in the order of their enumeration");

const Rule& rule_of(TrustEvent event) { return kRules.at(static_cast<std::size_t>(event)); }

}  // namespace

std::string_view sentence_of(TrustEvent event) { return rule_of(event).sentence; }

AxisArray<bool> only(Axis axis) {
  AxisArray<bool> axes;
  axes[axis] = true;
  return axes;
}

std::string names_of(const std::vector<Axis>& axes) {
  std::string text;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (i > 0) text += i + 1 == axes.size() ? " and " : ", ";
    text += axis_name(axes[i]);
  }
  return text;
}

AxisArray<bool> PositionTrust::take(TrustEvent event, const AxisArray<bool>& axes) {
  const Trust at_best = rule_of(event).at_best;
  AxisArray<bool> less;
  for (const Axis axis : kAllAxes) {
    if (!axes[axis] || trust_[axis] >= at_best) continue;
    trust_[axis] = at_best;
    less[axis] = true;
  }
  return less;
}

void PositionTrust::homed(Axis axis) {
  trust_[axis] = Trust::trusted;
  once_homed_[axis] = true;
}

Result<std::vector<Axis>> PositionTrust::accept(std::vector<Axis> axes) {
  if (axes.empty())
    std::ranges::copy_if(kAllAxes, std::back_inserter(axes),
                         [&](Axis axis) { return axes_[axis] && trust_[axis] != Trust::trusted; });
  std::vector<Axis> never;
  std::ranges::copy_if(axes, std::back_inserter(never),
                       [&](Axis axis) { return !once_homed_[axis]; });
  if (!never.empty())
    return fail(ErrorCode::never_homed,
                fmt::format("{} {} not been homed since the server was started: there is no "
                            "position to accept. Home first.",
                            names_of(never), never.size() == 1 ? "has" : "have"));
  for (const Axis axis : axes) trust_[axis] = Trust::trusted;
  return axes;
}

std::vector<Axis> PositionTrust::axes_with(Trust trust) const {
  std::vector<Axis> axes;
  std::ranges::copy_if(kAllAxes, std::back_inserter(axes),
                       [&](Axis axis) { return axes_[axis] && trust_[axis] == trust; });
  return axes;
}

AxisArray<bool> PositionTrust::known() const {
  AxisArray<bool> result;
  for (const Axis axis : kAllAxes) result[axis] = trust_[axis] != Trust::unknown;
  return result;
}

bool PositionTrust::all_trusted() const {
  return std::ranges::all_of(
      kAllAxes, [&](Axis axis) { return !axes_[axis] || trust_[axis] == Trust::trusted; });
}

/// Axes that were never homed can only be homed; the others may also be checked.
std::string PositionTrust::advice() const {
  if (all_trusted()) return {};
  std::string text;
  for (const auto& [trust, word] :
       {std::pair{Trust::doubtful, "doubtful"}, std::pair{Trust::unknown, "not known"}}) {
    const std::vector<Axis> axes = axes_with(trust);
    if (!axes.empty()) text += fmt::format("The position of {} is {}. ", names_of(axes), word);
  }
  std::vector<Axis> wanted;
  bool can_accept = true;
  for (const Axis axis : kAllAxes) {
    if (!axes_[axis] || trust_[axis] == Trust::trusted) continue;
    wanted.push_back(axis);
    can_accept = can_accept && once_homed_[axis];
  }
  return text + fmt::format("Home {}{}.", names_of(wanted),
                            can_accept ? ", or check and accept the position" : "");
}

}  // namespace cnc::server
