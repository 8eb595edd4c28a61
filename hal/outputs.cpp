#include "hal/outputs.h"

namespace cnc::hal {
namespace {

template <typename T>
std::optional<T> if_changed(const T& before, const T& after) {
  return before == after ? std::nullopt : std::optional<T>(after);
}

/// Of what outputs and a change have both.
template <typename To, typename Visit>
void for_each_member(To& to, const OutputChange& change, Visit visit) {
  visit(to.spindle_on, change.spindle_on);
  visit(to.tool_direction, change.tool_direction);
  visit(to.spindle_pwm, change.spindle_pwm);
  visit(to.mist, change.mist);
  visit(to.flood, change.flood);
}

}  // namespace

bool OutputChange::can_add(const OutputChange& later) const {
  const auto agrees = [](const auto& mine, const auto& its) {
    return !mine || !its || *mine == *its;
  };
  const bool same_channel = !pwm || !later.pwm || pwm->channel == later.pwm->channel;
  return agrees(spindle_on, later.spindle_on) && agrees(tool_direction, later.tool_direction) &&
         agrees(mist, later.mist) && agrees(flood, later.flood) && agrees(port, later.port) &&
         same_channel;
}

void OutputChange::add(const OutputChange& later) {
  for_each_member(*this, later, [](auto& mine, const auto& its) {
    if (its) mine = its;
  });
  if (later.port) port = later.port;
  if (later.pwm) pwm = later.pwm;
}

void OutputChange::apply_to(Outputs& outputs) const {
  for_each_member(outputs, *this, [](auto& output, const auto& changed) {
    if (changed) output = *changed;
  });
  if (port) outputs.ports.set(port->bit, port->on);
  if (pwm) outputs.pwm.at(pwm->channel) = pwm->value;
}

std::optional<OutputChange> change_between(const Outputs& before, const Outputs& after) {
  OutputChange change{.spindle_on = if_changed(before.spindle_on, after.spindle_on),
                      .tool_direction = if_changed(before.tool_direction, after.tool_direction),
                      .spindle_pwm = if_changed(before.spindle_pwm, after.spindle_pwm),
                      .mist = if_changed(before.mist, after.mist),
                      .flood = if_changed(before.flood, after.flood)};
  std::size_t ports = 0;
  for (std::uint8_t bit = 0; bit < before.ports.size(); ++bit) {
    if (before.ports[bit] == after.ports[bit]) continue;
    change.port = {bit, after.ports[bit]};
    ++ports;
  }
  std::size_t channels = 0;
  for (std::uint8_t channel = 0; channel < kPwmCount; ++channel) {
    if (before.pwm[channel] == after.pwm[channel]) continue;
    change.pwm = {channel, after.pwm[channel]};
    ++channels;
  }
  const bool fits = ports <= 1 && channels <= 1 && before.drives_enabled == after.drives_enabled;
  return fits ? std::optional(change) : std::nullopt;
}

}  // namespace cnc::hal
