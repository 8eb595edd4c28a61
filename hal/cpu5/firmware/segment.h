// What the host and the board tell each other, as plain structs of fixed-width numbers.
#pragma once

#include "hal/cpu5/firmware/card_guards.h"
#include "hal/cpu5/firmware/fixed_point.h"
#include "hal/cpu5/firmware/outputs.h"

namespace cnc::hal::cpu5::firmware {

/// One piece of motion: a cubic per axis from the end of the segment before it (hermite.h).
struct Segment {
  std::uint32_t id = 0;              ///< one more than the segment before it, never 0
  std::uint32_t duration = 0;        ///< ticks, 1 … kMaxSegmentTicks
  PerAxis<StepPosition> position{};  ///< at the end
  PerAxis<StepVelocity> velocity{};  ///< at the end
  /// Starts at the spindle's next index pulse. The segment before it ends at a standstill.
  bool wait_for_index = false;
  /// Ticks per revolution that it was planned for: it passes as much faster or slower as the
  /// spindle turns. 0 = as written, whatever the spindle does.
  std::uint32_t spindle_period = 0;
  OutputChange change{};  ///< takes effect at the tick at which the segment begins
};

inline constexpr std::size_t kAnalogCount = 8;

struct Inputs {
  static constexpr std::uint32_t kFullAnalog = 1U << 16;

  std::uint8_t home = 0;  ///< one bit per axis, X is bit 0
  bool estop1 = false;
  bool estop2 = false;
  bool external_error = false;
  bool probe = false;
  bool sync = false;
  bool hand_wheel_a = false;
  bool hand_wheel_b = false;
  PortBits ports = 0;
  std::array<std::uint32_t, kAnalogCount> analog{};  ///< 0 … kFullAnalog
  std::int32_t hand_wheel_count = 0;                 ///< of the counting unit; wraps
  std::uint32_t index_count = 0;                     ///< spindle index pulses; wraps
  Ticks index_time = 0;                              ///< when the capture unit saw the last one
  /// One bit per axis: its drive reports a lost step or a fault of its own. In Status also those
  /// that have begun to since faults were cleared.
  std::uint8_t alarm = 0;

  [[nodiscard]] bool estop() const { return estop1 || estop2; }
};

[[nodiscard]] constexpr std::uint8_t axis_bit(std::size_t axis) {
  return static_cast<std::uint8_t>(1U << axis);
}

/// Why the board stopped by itself; bits of a FaultBits.
using FaultBits = std::uint16_t;
inline constexpr FaultBits kFifoUnderrun = 1 << 0;  ///< ran dry while moving
inline constexpr FaultBits kEstop = 1 << 1;         ///< estop input active
inline constexpr FaultBits kBadSegment = 1 << 2;    ///< order, duration, range or step frequency
inline constexpr FaultBits kLinkLost = 1 << 3;      ///< host silent for longer than the time-out
inline constexpr FaultBits kIndexMissing = 1 << 4;  ///< no spindle index within the time-out
inline constexpr FaultBits kStepLoss = 1 << 5;      ///< a drive has begun to raise its alarm
inline constexpr FaultBits kGuardStop = 1 << 6;     ///< a rule of an I/O card wants a quick stop

enum class Edge : std::uint8_t { activate, release };

/// Catches an axis's step count at the step at which its home input changes.
struct HomeLatch {
  bool armed = false;
  bool caught = false;
  Edge edge = Edge::activate;
  std::int64_t count = 0;
  Ticks time = 0;
};

/// Where the board stands with a stop along the path (core.h).
enum class PathStop : std::uint8_t { none, stopping, stopped };

/// Catches the step counts of all axes at the step at which the probe input becomes active.
struct ProbeLatch {
  bool armed = false;
  bool caught = false;
  bool active_at_arming = false;
  PerAxis<std::int64_t> counts{};
  Ticks time = 0;
};

/// Always armed: catches the step counts of all axes, which stop there, when an estop input becomes
/// active and none was.
struct EstopLatch {
  std::uint32_t count = 0;  ///< how often since power-up; wraps
  PerAxis<std::int64_t> counts{};
  Ticks time = 0;
};

inline constexpr std::uint16_t kMaxDirectionTicks = 400;

/// What the host decides once, before anything moves.
struct Setup {
  StepVelocity max_velocity = 0;  ///< faster segments are refused; 1 … kTopVelocity
  Ticks host_timeout = 0;         ///< silence after which the link counts as lost; 0 = never
  Ticks index_timeout =
      0;  ///< without the spindle's index pulses, when they are waited for; 0 = never
  bool drives_off_on_fault = true;
  // The drives' pulses (pulse_shaper.h). A pulse and its pause take twice the width, which has to
  // fit into the period at max_velocity; direction times 0 … kMaxDirectionTicks.
  std::uint16_t pulse_width = 10;       ///< ticks, at least 1
  std::uint16_t direction_setup = 0;    ///< ticks from a change of direction to the pulse
  std::uint16_t direction_hold = 0;     ///< ticks from a pulse's beginning to a change of direction
  std::uint8_t step_inverted = 0;       ///< one bit per axis: the pulse is low
  std::uint8_t direction_inverted = 0;  ///< one bit per axis: upwards is low
  /// That a stop along the path keeps to; 1 … kTopAcceleration, 0 = the axis sets no limit.
  PerAxis<StepAcceleration> max_acceleration{};
  PerGuardRule<GuardRule> guards{};
};

struct Status {
  Ticks time = 0;
  FaultBits faults = 0;
  std::uint32_t executing_id = 0;  ///< in execution, or the last executed; 0 = none yet
  Ticks executing_elapsed = 0;
  Ticks executing_duration = 0;
  std::uint32_t fifo_count = 0;  ///< waiting, the executing one not counted
  std::uint32_t fifo_free = 0;
  Ticks queued_time = 0;  ///< path time still to be made, the executing segment's rest included
  bool moving = false;
  PerAxis<std::int64_t> counts{};  ///< steps since power-up; nothing ever sets them
  Inputs inputs{};
  Ticks spindle_period = 0;  ///< per revolution (spindle_meter.h); 0 = standing
  PerAxis<HomeLatch> home_latch{};
  ProbeLatch probe_latch{};
  EstopLatch estop_latch{};
  PerAxis<std::int64_t> index_counts{};  ///< steps at inputs.index_time
  PathStop path_stop = PathStop::none;
  bool cut_late = false;  ///< the last cut was; segments are dropped until the next
  TimeScale time_scale = kFullScale;
  Outputs outputs{};
  PerGuardRule<std::uint8_t> guard_counts{};  ///< how often each has acted since setup; wraps
};

}  // namespace cnc::hal::cpu5::firmware
