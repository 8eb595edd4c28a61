// M20-M23 plasma torch height, M100-M190 3D printer (manual 3.5.11, 3.5.12, 2.11).
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/words.h"

namespace cnc::interp {
namespace {

constexpr double kHottest = 500.0;  // degrees Celsius

[[nodiscard]] std::optional<double>& target_of(ModalState& modal, Heater heater) {
  return heater == Heater::bed ? modal.bed_temperature : modal.extruder_temperature;
}

/// S, or the temperature that was asked for before: "M190" alone waits for it.
Parsed<double> temperature(Execution& x, Heater heater) {
  if (x.block().has('S')) return word_within(x, 'S', 0.0, kHottest);
  if (const auto before = target_of(x.state().modal, heater)) return *before;
  return refuse(ErrorCode::word_missing, x.code_span(),
                fmt::format("{} has no temperature to wait for.", x.code_name()),
                "S in degrees Celsius, on this line or with M104 or M140 before it.");
}

}  // namespace

// M20 is on and M21 is off: so say the tables 3-3 and 3-6 and the macros that are delivered with
// the original (thcOn is M20). The text of 3.5.11 has it the other way round.
Accepted switch_torch_height(Execution& x) {
  x.state().modal.torch_height = x.code() == 20;
  x.emit(UseTorchHeight{x.state().modal.torch_height});
  return {};
}

Accepted set_torch_height(Execution& x) {
  constexpr double kHighestSetPoint = 1000.0;  // V
  const auto set_point = word_within(x, 'Q', 0.0, kHighestSetPoint);
  if (!set_point) return std::unexpected(set_point.error());
  x.emit(SetTorchHeight{*set_point});
  return {};
}

Accepted set_temperature(Execution& x) {
  const std::int32_t code = x.code();
  const Heater heater = code == 140 || code == 190 ? Heater::bed : Heater::extruder;
  const auto celsius = temperature(x, heater);
  if (!celsius) return std::unexpected(celsius.error());
  target_of(x.state().modal, heater) = *celsius;
  x.emit(SetTemperature{heater, *celsius, code == 109 || code == 190});
  return {};
}

Accepted set_temperature_limit(Execution& x) {
  const auto celsius = word_within(x, 'S', 0.0, kHottest);
  if (!celsius) return std::unexpected(celsius.error());
  x.emit(SetTemperatureLimit{*celsius});
  return {};
}

// S counts to 255, as table 3-6 says and slicers write; the 0-100 of 3.5.12 would refuse most of
// what they mean.
Accepted set_fan(Execution& x) {
  constexpr double kFull = 255.0;
  double power = x.code() == 106 ? 1.0 : 0.0;
  if (x.block().has('S')) {
    const auto value = word_within(x, 'S', 0.0, kFull);
    if (!value) return std::unexpected(value.error());
    power = *value / kFull;
  }
  x.emit(SetFan{power});
  return {};
}

Accepted switch_heaters_off(Execution& x) {
  x.state().modal.extruder_temperature = x.state().modal.bed_temperature = std::nullopt;
  x.emit(HeatersOff{});
  return {};
}

Accepted scale_axis(Execution& x) {
  const auto factor = word_within(x, 'P', 0.1, 10.0);
  if (!factor) return std::unexpected(factor.error());
  x.emit(ScaleAxis{Axis::A, *factor});
  return {};
}

}  // namespace cnc::interp
