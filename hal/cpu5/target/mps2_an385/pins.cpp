#include "hal/cpu5/target/mps2_an385/pins.h"

#include "hal/cpu5/target/mps2_an385/registers.h"

namespace cnc::hal::cpu5::target {
namespace {

using firmware::Inputs;
using firmware::Outputs;
using firmware::Ticks;

constexpr unsigned kDirectionPins = 8;  // of kPulsePins, from there on
constexpr std::uint32_t kAllPulsePins = 0x3F3F;

// The inputs' pins. Each is active high; an input that may fail has to be wired so that a broken
// wire reads as active.
constexpr std::uint32_t kHomePins = 0x3F;
struct InputPin {
  unsigned pin;
  bool Inputs::*input;
};
constexpr InputPin kInputs[] = {
    {.pin = 6, .input = &Inputs::estop1},         {.pin = 7, .input = &Inputs::estop2},
    {.pin = 8, .input = &Inputs::external_error}, {.pin = 9, .input = &Inputs::probe},
    {.pin = 10, .input = &Inputs::sync},          {.pin = 11, .input = &Inputs::hand_wheel_a},
    {.pin = 12, .input = &Inputs::hand_wheel_b},
};

struct OutputPin {
  unsigned pin;
  bool Outputs::*output;
};
constexpr OutputPin kOutputs[] = {
    {.pin = 0, .output = &Outputs::drives_enabled}, {.pin = 1, .output = &Outputs::spindle_on},
    {.pin = 2, .output = &Outputs::tool_direction}, {.pin = 3, .output = &Outputs::mist},
    {.pin = 4, .output = &Outputs::flood},
};
constexpr std::uint32_t kAllOutputPins = 0xFFFF;
constexpr unsigned kPortPins = 8;  // AUX1 … AUX8 from there on

}  // namespace

void Pins::start() {
  make_edges(0);
  kPulsePins.write(kPinsDrive, kAllPulsePins);
  kOutputPins.write(kPinsDrive, kAllOutputPins);
}

void Pins::set_up(const firmware::Setup& setup) {
  asm volatile("cpsid i" ::: "memory");
  shaper_.set_up(setup);
  asm volatile("cpsie i" ::: "memory");
}

void Pins::step(std::size_t axis, int direction, Ticks when) {
  lost_ = !shaper_.add_step(axis, direction, when) || lost_;
}

bool Pins::take_loss() {
  const bool lost = lost_;
  lost_ = false;
  return lost;
}

void Pins::make_edges(Ticks now) {
  const firmware::PulseShaper::Pins pins = shaper_.make_edges(now);
  kPulsePins.write(kPinsOut, pins.step | std::uint32_t{pins.direction} << kDirectionPins);
}

Inputs Pins::inputs(Ticks) {
  const std::uint32_t pins = kInputPins.read(kPinsIn);
  Inputs result{.home = static_cast<std::uint8_t>(pins & kHomePins)};
  for (const InputPin& row : kInputs) result.*row.input = ((pins >> row.pin) & 1U) != 0;
  return result;
}

void Pins::set_outputs(const Outputs& outputs) {
  auto pins = static_cast<std::uint32_t>(outputs.ports & 0xFF) << kPortPins;
  for (const OutputPin& row : kOutputs) {
    if (outputs.*row.output) pins |= 1U << row.pin;
  }
  kOutputPins.write(kPinsOut, pins);
}

}  // namespace cnc::hal::cpu5::target
