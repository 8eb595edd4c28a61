#include "hal/cpu5/driver/board_values.h"

#include <algorithm>
#include <cmath>

namespace cnc::hal::cpu5 {
namespace {

static_assert(Ports().size() == firmware::kPortCount);
static_assert(kPwmCount == firmware::kPwmCount);
static_assert(kAnalogCount == firmware::kAnalogCount);

std::uint32_t pwm_to_board(double pwm) {
  const double part = std::isnan(pwm) ? 0.0 : std::clamp(pwm, 0.0, 1.0);
  return static_cast<std::uint32_t>(std::lround(part * firmware::Outputs::kFullPwm));
}

double pwm_from_board(std::uint32_t pwm) {
  return static_cast<double>(pwm) / firmware::Outputs::kFullPwm;
}

double analog_from_board(std::uint32_t analog) {
  return static_cast<double>(analog) / firmware::Inputs::kFullAnalog;
}

}  // namespace

firmware::Outputs to_board(const Outputs& outputs) {
  firmware::Outputs result{.drives_enabled = outputs.drives_enabled,
                           .spindle_on = outputs.spindle_on,
                           .tool_direction = outputs.tool_direction,
                           .spindle_pwm = pwm_to_board(outputs.spindle_pwm),
                           .mist = outputs.mist,
                           .flood = outputs.flood,
                           .ports = outputs.ports.to_ullong()};
  std::ranges::transform(outputs.pwm, result.pwm.begin(), pwm_to_board);
  return result;
}

firmware::OutputChange to_board(const OutputChange& change) {
  firmware::OutputChange result;
  const auto put_relay = [&](std::uint8_t bit, std::optional<bool> on) {
    if (!on) return;
    result.changed |= bit;
    if (*on) result.on |= bit;
  };
  put_relay(firmware::OutputChange::kSpindleOn, change.spindle_on);
  put_relay(firmware::OutputChange::kToolDirection, change.tool_direction);
  put_relay(firmware::OutputChange::kMist, change.mist);
  put_relay(firmware::OutputChange::kFlood, change.flood);
  if (change.spindle_pwm) {
    result.changed |= firmware::OutputChange::kSpindlePwm;
    result.spindle_pwm = pwm_to_board(*change.spindle_pwm);
  }
  if (change.port && change.port->bit < Ports{}.size()) {
    result.port = static_cast<std::uint8_t>(change.port->bit + 1);
    result.port_on = change.port->on;
  }
  if (change.pwm && change.pwm->channel < kPwmCount) {
    result.pwm = static_cast<std::uint8_t>(change.pwm->channel + 1);
    result.pwm_value = pwm_to_board(change.pwm->value);
  }
  return result;
}

firmware::PerGuardRule<firmware::GuardRule> to_board(
    const std::array<config::GuardRule, config::kGuardRules>& rules) {
  static_assert(config::kGuardRules == firmware::kGuardRules);
  static_assert(static_cast<int>(config::GuardAction::quick_stop) ==
                static_cast<int>(firmware::GuardAction::quick_stop));
  firmware::PerGuardRule<firmware::GuardRule> result;
  std::ranges::transform(rules, result.begin(), [](const config::GuardRule& rule) {
    return firmware::GuardRule{.participants = static_cast<std::uint8_t>(rule.participants),
                               .compare = static_cast<std::uint8_t>(rule.compare),
                               .action = static_cast<firmware::GuardAction>(rule.action)};
  });
  return result;
}

Outputs from_board(const firmware::Outputs& outputs) {
  Outputs result{.drives_enabled = outputs.drives_enabled,
                 .spindle_on = outputs.spindle_on,
                 .tool_direction = outputs.tool_direction,
                 .spindle_pwm = pwm_from_board(outputs.spindle_pwm),
                 .mist = outputs.mist,
                 .flood = outputs.flood,
                 .ports = Ports(outputs.ports)};
  std::ranges::transform(outputs.pwm, result.pwm.begin(), pwm_from_board);
  return result;
}

Inputs from_board(const firmware::Inputs& inputs) {
  Inputs result{.probe = inputs.probe,
                .sync = inputs.sync,
                .hand_wheel_a = inputs.hand_wheel_a,
                .hand_wheel_b = inputs.hand_wheel_b,
                .estop1 = inputs.estop1,
                .estop2 = inputs.estop2,
                .external_error = inputs.external_error,
                .ports = Ports(inputs.ports),
                .hand_wheel_count = inputs.hand_wheel_count};
  for (const Axis axis : kAllAxes) {
    result.home[axis] = (inputs.home & firmware::axis_bit(index_of(axis))) != 0;
    result.drive_alarm[axis] = (inputs.alarm & firmware::axis_bit(index_of(axis))) != 0;
  }
  std::ranges::transform(inputs.analog, result.analog.begin(), analog_from_board);
  return result;
}

PathStop from_board(firmware::PathStop stop) {
  switch (stop) {
    case firmware::PathStop::none:
      return PathStop::none;
    case firmware::PathStop::stopping:
      return PathStop::stopping;
    case firmware::PathStop::stopped:
      return PathStop::stopped;
  }
  return PathStop::stopped;  // a value that no board sends: safest is to move nothing
}

}  // namespace cnc::hal::cpu5
