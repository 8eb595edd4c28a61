#include "server/machine/state_table.h"

#include <algorithm>
#include <fmt/format.h>
#include <initializer_list>

namespace cnc::server {
namespace {

constexpr std::uint32_t bit(State state) { return 1U << static_cast<unsigned>(state); }
constexpr std::uint32_t states(std::initializer_list<State> list) {
  std::uint32_t bits = 0;
  for (const State state : list) bits |= bit(state);
  return bits;
}

constexpr std::uint32_t kAll = (1U << kStateCount) - 1;
using enum State;

constexpr std::array<StateInfo, kStateCount> kStates{{
    {off, "off", "No controller is connected: check the connection settings and the cable."},
    {needs_reset, "needs reset", "Drives are off: reset to switch them on."},
    {needs_homing, "needs homing",
     "Where the machine stands is not certain: home the axes, or check and accept the position."},
    {ready, "ready", "Nothing runs: the machine is ready."},
    {jogging, "jogging", "The machine is jogged: release the key."},
    {homing, "homing", "Axes are homed: wait for the end or stop."},
    {mdi, "single line", "A single line is executed: wait for the end or stop."},
    {running, "running", "A job runs: pause or stop it."},
    {pausing, "pausing", "The machine slows down for a pause."},
    {paused, "paused", "The job is paused: resume or stop it."},
    {program_stop, "program stop", "The program waits (M0/M1): resume or stop it."},
    {tool_change, "tool change", "The program waits for a tool: change it and resume, or stop."},
    {question, "question", "The program asks for values: answer its dialog, or stop."},
    {stopping, "stopping", "The machine slows down to end the job."},
    {estop, "estop", "Emergency stop: release the button, then reset."},
    {error, "error", "Stopped by an error: read the message, then reset."},
}};

constexpr std::uint32_t kAtRest = states({needs_reset, needs_homing, ready, estop, error, off});

constexpr std::array<CommandRule, kCommandCount> kCommands{{
    {CommandKind::reset, "reset", kAll & ~bit(off)},
    {CommandKind::home, "home", states({needs_homing, ready})},
    {CommandKind::jog, "jog",
     states({needs_homing, ready, jogging, program_stop, tool_change, question})},
    {CommandKind::mdi, "mdi", states({ready})},
    {CommandKind::load, "load", kAtRest | bit(jogging) | bit(homing)},
    {CommandKind::run, "run", states({ready})},
    {CommandKind::pause, "pause", states({running, mdi})},
    {CommandKind::resume, "resume", states({paused, program_stop, tool_change})},
    {CommandKind::stop, "stop",
     states({jogging, homing, mdi, running, pausing, paused, program_stop, tool_change, question})},
    {CommandKind::rewind, "rewind", kAtRest},
    {CommandKind::set_override, "override", kAll},
    {CommandKind::set_work_zero, "zero", states({needs_homing, ready})},
    {CommandKind::answer, "answer", states({question})},
    {CommandKind::accept_position, "accept position", states({needs_homing, ready})},
}};

static_assert(
    [] {
      for (std::size_t i = 0; i < kStateCount; ++i)
        if (static_cast<std::size_t>(kStates[i].state) != i) return false;
      for (std::size_t i = 0; i < kCommandCount; ++i)
        if (static_cast<std::size_t>(kCommands[i].command) != i) return false;
      return true;
    }(),
    "rows stand in the order of their enumeration");

}  // namespace

std::span<const StateInfo, kStateCount> state_table() { return kStates; }
std::span<const CommandRule, kCommandCount> command_table() { return kCommands; }

const StateInfo& state_info(State state) { return kStates[static_cast<std::size_t>(state)]; }

bool is_allowed(CommandKind command, State state) {
  return (kCommands[static_cast<std::size_t>(command)].allowed & bit(state)) != 0;
}

std::optional<std::string> refusal(CommandKind command, State state) {
  if (is_allowed(command, state)) return std::nullopt;
  const StateInfo& now = state_info(state);
  return fmt::format("{} is not possible in state \"{}\". {}",
                     kCommands[static_cast<std::size_t>(command)].name, now.name, now.waits);
}

}  // namespace cnc::server
