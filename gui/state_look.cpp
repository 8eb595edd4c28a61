#include "gui/state_look.h"

#include <algorithm>
#include <array>

namespace cnc::gui {
namespace {

using api::Command;
using enum api::MachineState;
constexpr std::nullopt_t kNone = std::nullopt;

// In the order of the enumeration.
constexpr std::array<StateLook, api::kMachineStateCount> kLooks{{
    {unknown, "Unknown", "?", "grey", kNone},
    {off, "Off", "○", "grey", kNone},
    {needs_reset, "Drives off", "▲", "yellow", Command::reset},
    {needs_homing, "Not homed", "▲", "yellow", Command::home},
    {ready, "Ready", "■", "green", kNone},
    {jogging, "Jogging", "●", "green", kNone},
    {homing, "Homing", "●", "green", kNone},
    {mdi, "Single line", "●", "green", kNone},
    {running, "Running", "●", "green", kNone},
    {pausing, "Pausing", "●", "yellow", kNone},
    {paused, "Paused", "▮▮", "yellow", Command::resume},
    {program_stop, "Program stop", "▮▮", "blue", Command::resume},
    {tool_change, "Tool change", "◆", "blue", Command::resume},
    {stopping, "Stopping", "●", "yellow", kNone},
    {estop, "Emergency stop", "✖", "red", Command::reset},
    {error, "Error", "✖", "red", Command::reset},
    {question, "Question", "?", "blue", Command::answer},
}};

static_assert(std::ranges::is_sorted(kLooks, {}, &StateLook::state) &&
              kLooks.back().state == question);

}  // namespace

const StateLook& look_of(api::MachineState state) {
  return kLooks.at(static_cast<std::size_t>(state));
}

}  // namespace cnc::gui
