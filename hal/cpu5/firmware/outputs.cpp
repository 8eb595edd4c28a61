#include "hal/cpu5/firmware/outputs.h"

namespace cnc::hal::cpu5::firmware {
namespace {

struct Relay {
  std::uint8_t bit;
  bool Outputs::*output;
};

constexpr Relay kRelays[] = {
    {.bit = OutputChange::kSpindleOn, .output = &Outputs::spindle_on},
    {.bit = OutputChange::kToolDirection, .output = &Outputs::tool_direction},
    {.bit = OutputChange::kMist, .output = &Outputs::mist},
    {.bit = OutputChange::kFlood, .output = &Outputs::flood},
};

}  // namespace

void apply(const OutputChange& change, Outputs& outputs) {
  for (const auto& [bit, output] : kRelays) {
    if ((change.changed & bit) != 0) outputs.*output = (change.on & bit) != 0;
  }
  if ((change.changed & OutputChange::kSpindlePwm) != 0) outputs.spindle_pwm = change.spindle_pwm;
  if (change.port != 0) {
    const PortBits bit = PortBits{1} << (change.port - 1);
    outputs.ports = change.port_on ? outputs.ports | bit : outputs.ports & ~bit;
  }
  if (change.pwm != 0) outputs.pwm[change.pwm - 1U] = change.pwm_value;
}

}  // namespace cnc::hal::cpu5::firmware
