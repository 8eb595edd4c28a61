// The state machine of the whole controller as a table: which command is allowed in which state.
//
// The table is the only place that decides. Services refuse by it, the status tells every client
// what it says, so that a screen greys its buttons without rules of its own (STA-1).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace cnc::server {

enum class State : std::uint8_t {
  off,           ///< no controller
  needs_reset,   ///< drives are off
  needs_homing,  ///< drives are on, homing is mandatory and an axis is not trusted
  ready,
  jogging,
  homing,
  mdi,  ///< a single line is executed
  running,
  pausing,  ///< slowing down along the path
  paused,
  program_stop,  ///< M0, M1
  tool_change,   ///< M6
  question,      ///< dlgmsg
  stopping,      ///< slowing down, the job ends then
  estop,
  error,
};
inline constexpr std::size_t kStateCount = 16;

enum class CommandKind : std::uint8_t {
  reset,
  home,
  jog,
  mdi,
  load,
  run,
  pause,
  resume,
  stop,
  rewind,
  set_override,
  set_work_zero,
  answer,
  accept_position,
};
inline constexpr std::size_t kCommandCount = 14;

struct StateInfo {
  State state;
  std::string_view name;   ///< "needs homing"
  std::string_view waits;  ///< what the machine does or waits for, a sentence for the operator
};

struct CommandRule {
  CommandKind command;
  std::string_view name;  ///< "run"
  std::uint32_t allowed;  ///< bit per State
};

[[nodiscard]] std::span<const StateInfo, kStateCount> state_table();
[[nodiscard]] std::span<const CommandRule, kCommandCount> command_table();

[[nodiscard]] const StateInfo& state_info(State state);
[[nodiscard]] bool is_allowed(CommandKind command, State state);

/// Why the command is refused in this state and what is needed; nothing when it is allowed.
[[nodiscard]] std::optional<std::string> refusal(CommandKind command, State state);

}  // namespace cnc::server
