// The state of the machine, as every client sees it. Units: mm, degrees, s, mm/s, rpm.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/axis.h"

namespace cnc::api {

enum class MachineState : std::uint8_t {
  unknown,      ///< a state that this library is too old to know; show `state_text`
  off,          ///< no controller
  needs_reset,  ///< drives are off
  needs_homing,
  ready,
  jogging,
  homing,
  mdi,  ///< a single line is executed
  running,
  pausing,       ///< slowing down along the path
  paused,        ///< stands still; resume or stop
  program_stop,  ///< M0 or M1: waits for resume
  tool_change,   ///< M6: waits for resume
  stopping,      ///< slowing down, the job ends then
  estop,
  error,
  question,  ///< a program asks for values (dlgmsg): Client::answer()
};
inline constexpr std::size_t kMachineStateCount = 17;

enum class Command : std::uint8_t {
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
  override_rates,
  set_work_zero,
  answer,
  accept_position,
};
inline constexpr std::size_t kCommandCount = 14;

/// The names of the enumerators: "needs_reset", "set_work_zero". Stable; JSON uses them.
[[nodiscard]] std::string_view name_of(MachineState state);
[[nodiscard]] std::string_view name_of(Command command);

/// Whether the server would accept a command now. A screen greys its buttons from this and has no
/// rules of its own.
struct CommandAvailability {
  bool allowed = false;
  std::string reason;  ///< why not, and what would be needed; empty when allowed

  friend bool operator==(const CommandAvailability&, const CommandAvailability&) = default;
};

enum class SpindleDirection : std::uint8_t { off, clockwise, counterclockwise };
[[nodiscard]] std::string_view name_of(SpindleDirection direction);

/// What is known of where an axis really stands, apart from where it was sent. In the order from
/// good to bad.
enum class PositionTrust : std::uint8_t {
  trusted,   ///< homed, or accepted by the operator, and stopped with ramps since
  doubtful,  ///< stopped without a ramp, or its drive was off: it may have moved
  unknown,   ///< not homed, or the board has lost its step counts
};
[[nodiscard]] std::string_view name_of(PositionTrust trust);

struct JobStatus {
  std::string path;  ///< on the server's computer; empty = no job
  std::uint64_t lines = 0;
  std::uint64_t line = 0;         ///< in execution, from 1; 0 = not started
  double progress = 0.0;          ///< 0 … 1, by predicted time where known, else by lines
  double elapsed = 0.0;           ///< s of running, without pauses
  bool prediction_ready = false;  ///< the next two and the extents are known
  double predicted_time = 0.0;    ///< s for the whole job at 100 % override
  double time_left = 0.0;         ///< s at the present override
  std::uint64_t runs = 0;         ///< how often a run has ended since the job was loaded
  bool ended_well = false;        ///< the last run reached its end
  std::uint64_t problems = 0;     ///< errors found in the file, see Client::problems
  AxisValues extents_min;         ///< machine coordinates of the whole job
  AxisValues extents_max;

  friend bool operator==(const JobStatus&, const JobStatus&) = default;
};

/// What a program asks the operator.
struct Question {
  struct Field {
    std::string label;
    int parameter = 0;   ///< that the value goes to
    double value = 0.0;  ///< proposed

    friend bool operator==(const Field&, const Field&) = default;
  };
  std::uint64_t number = 0;   ///< for Client::answer()
  std::string title;          ///< may also name a picture
  std::vector<Field> fields;  ///< none: only OK or Cancel

  friend bool operator==(const Question&, const Question&) = default;
};

struct MachineStatus {
  std::uint64_t sequence = 0;  ///< ascending; a gap means missed states
  double time = 0.0;           ///< server's monotonic clock, s
  MachineState state = MachineState::unknown;
  std::string state_text;  ///< what the machine waits for, in words
  AxisValues machine_position;
  AxisValues work_position;
  AxisFlags homed;  ///< whose position is trusted
  AxisArray<PositionTrust> trust{{PositionTrust::unknown, PositionTrust::unknown,
                                  PositionTrust::unknown, PositionTrust::unknown,
                                  PositionTrust::unknown, PositionTrust::unknown}};
  AxisValues velocity;           ///< per axis
  double feed = 0.0;             ///< along the path, mm/s
  double programmed_feed = 0.0;  ///< mm/s; 0 = rapid or none
  double feed_override = 1.0;    ///< 1 = 100 %
  double rapid_override = 1.0;
  double speed_override = 1.0;
  bool overrides_enabled = true;  ///< M48/M49
  SpindleDirection spindle = SpindleDirection::off;
  double spindle_speed = 0.0;  ///< programmed, rpm
  bool mist = false;
  bool flood = false;
  int tool = 0;              ///< in the spindle
  int selected_tool = 0;     ///< T word
  int work_system = 1;       ///< 1 … 9 for G54 … G59.3
  std::string active_codes;  ///< "G1 G17 G21 … M5 M9"
  JobStatus job;
  std::array<CommandAvailability, kCommandCount> commands;  ///< read with availability()
  bool estop_input = false;
  AxisFlags home_switches;           ///< active now
  double fifo_time = 0.0;            ///< s of motion in the controller board
  std::uint64_t newest_message = 0;  ///< sequence number, see Client::messages
  /// What a program asks, until it is answered; also while the operator jogs meanwhile.
  std::optional<Question> question;
  bool probe_input = false;  ///< the probe touches

  [[nodiscard]] const CommandAvailability& availability(Command command) const {
    return commands[static_cast<std::size_t>(command)];
  }

  friend bool operator==(const MachineStatus&, const MachineStatus&) = default;
};

}  // namespace cnc::api
