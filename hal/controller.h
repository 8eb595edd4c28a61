// What a controller board can do, whatever the board and however it is connected.
//
// Positions at this interface are machine coordinates in mm and degrees; the driver knows the steps
// per unit and counts steps. All calls come from one thread, the link thread (or the simulation
// loop): real-time, so an implementation allocates nothing, takes no lock and does not block longer
// than one exchange on its transport.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "config/axis.h"
#include "config/error.h"
#include "config/guard_rule.h"
#include "hal/link_obstacle.h"
#include "hal/outputs.h"

namespace cnc::hal {

/// One piece of motion for the board's FIFO: a cubic from the end of the segment before it. `id`
/// counts up by one from segment to segment, never 0, which is left out when the numbers go round;
/// the first after a fault, any stop or a cut may have any. Segments shorter than
/// Capabilities::min_segment_duration are stretched to it, and later ones shortened until the total
/// time is right again.
struct Segment {
  std::uint32_t id = 0;
  double duration = 0.0;  ///< s
  Position position{};    ///< at the end, mm and degrees
  Position velocity{};    ///< at the end, per second
  /// Starts at the spindle's next index pulse, to the tick; the segment before it has to end at a
  /// standstill. No pulse within the driver's time-out is the fault index_missing.
  bool wait_for_index = false;
  /// Speed in rpm (1 … 1e6) that the segment was planned for: it passes as much faster or slower as
  /// the spindle is measured to turn, up to 1.25 times, changing no faster than the axes'
  /// configured acceleration allows. It and all that follows up to the next standstill must leave
  /// that room below the maximum step frequency. A standing spindle holds it, for no longer than
  /// the driver's time-out: then it is the fault index_missing. 0 = as written.
  double spindle_speed = 0.0;
  /// Takes effect at the very tick at which the segment begins, at its step; never, when the
  /// segment is dropped before it has begun.
  OutputChange change{};
};

/// Why the board stopped by itself. Bits; more than one may be set.
enum class Fault : std::uint16_t {
  none = 0,
  fifo_underrun = 1 << 0,  ///< ran dry while moving
  estop = 1 << 1,          ///< an estop input is active
  bad_segment = 1 << 2,    ///< a segment that cannot be executed (order, duration, step frequency)
  link_lost = 1 << 3,
  index_missing = 1 << 4,  ///< the spindle's index pulse did not come
  step_loss = 1 << 5,      ///< a drive has begun to raise its alarm: inputs.drive_alarm
  guard_stop = 1 << 6,     ///< a guard rule of an I/O card wanted a quick stop
};
using Faults = std::uint16_t;

/// Every input as it was at the exchange: true is active, whatever the wiring. M56's numbers in
/// brackets.
struct Inputs {
  AxisArray<bool> home{};         ///< [51 … 56]
  bool probe = false;             ///< [61]
  bool sync = false;              ///< [62] the spindle's index pulse
  bool hand_wheel_a = false;      ///< [63]
  bool hand_wheel_b = false;      ///< [64]
  bool estop1 = false;            ///< [65] either estop is a fault by itself
  bool estop2 = false;            ///< [66]
  AxisArray<bool> drive_alarm{};  ///< the axis' drive has lost steps or is in a fault, or was since
                                  ///< faults were cleared
  bool external_error = false;    ///< [67] what to do about it is the host's part
  Ports ports{};                  ///< AUX [1 … 16] and I/O cards [101 …]
  std::array<double, kAnalogCount> analog{};  ///< 0 … 1 of the input's range, [0] is input 1
  std::int32_t hand_wheel_count = 0;          ///< quarter steps of the wheel; wraps

  [[nodiscard]] bool estop() const { return estop1 || estop2; }
};

/// What the home latch of an axis caught: the position at the very step of the switch's edge.
struct Latch {
  bool armed = false;
  bool caught = false;
  double position = 0.0;  ///< mm or degrees, in the counting of that moment
  double time = 0.0;      ///< board time, s
};

/// What the probe latch caught: where all axes were at the very step at which the probe input
/// became active.
struct ProbeLatch {
  bool armed = false;
  bool caught = false;
  bool active_at_arming = false;  ///< the probe touched already: nothing was armed, nothing moves
  Position position{};            ///< mm and degrees, in the counting of that moment
  double time = 0.0;              ///< board time, s
};

/// A latch that is always armed: where all axes were when its input became active the last time.
struct EventLatch {
  std::uint32_t count = 0;  ///< how often it has, since power-up; wraps. 0: not yet
  Position position{};      ///< mm and degrees, in the counting of that moment
  double time = 0.0;        ///< board time, s
};

/// A stop along the path: from its beginning to release_stop().
enum class PathStop : std::uint8_t { none, stopping, stopped };

/// Who answers at the other end of the link.
struct BoardIdentity {
  std::array<char, 16> name{};  ///< ASCII, filled up with 0
  std::uint64_t serial = 0;

  friend bool operator==(const BoardIdentity&, const BoardIdentity&) = default;
};

/// Packets between host and board since the controller was made. All but `resent` are exclusive.
struct PacketCounts {
  std::uint64_t sent = 0;
  std::uint64_t resent = 0;       ///< of those sent: again, because no answer had come
  std::uint64_t answered = 0;     ///< have come, and brought something new
  std::uint64_t passed_over = 0;  ///< have come whole, of another session or behind a newer one
  std::uint64_t corrupted = 0;    ///< have come damaged
};

struct ControllerStatus {
  double time = 0.0;  ///< board time, s
  bool connected = false;
  LinkObstacle obstacle{};     ///< to a link, as long as there is none
  std::uint32_t sessions = 0;  ///< counts up whenever a link has been made, also after its loss
  /// The board was reset before this session: `position` is only where the axes were last seen.
  bool counts_lost = false;
  /// The newest frame of requests (Controller::next_frame) whose effect this status shows, or that
  /// was lost with the link.
  std::uint64_t frames_done = 0;
  Faults faults = 0;
  std::uint32_t executing_id = 0;  ///< segment in execution, or the last executed; 0 = none yet
  double executing_phase = 0.0;    ///< 0 … 1 within it
  std::uint32_t fifo_count = 0;    ///< segments waiting, the executing one not counted
  double fifo_time = 0.0;          ///< seconds of motion still in the board, at full speed
  PathStop path_stop = PathStop::none;
  bool cut_late = false;    ///< the last cut_behind() came too late
  double time_scale = 1.0;  ///< speed along the path against the segments' own, 0 … 1.25
  bool moving = false;      ///< or waiting for the spindle, with segments to execute
  Position position;        ///< from the step counters, mm and degrees
  Inputs inputs{};
  double spindle_speed = 0.0;  ///< rpm from the index pulses, unsigned; 0 below 20 rpm
  EventLatch index_latch{};    ///< of the spindle's index, to the tick
  AxisArray<Latch> home_latch{};
  ProbeLatch probe_latch{};
  EventLatch estop_latch{};  ///< of either estop, as the board saw it: where the pulses ended
  Outputs outputs{};
  /// How often each guard rule of the configuration has become true in this session; wraps. A
  /// smooth stop that it wanted shows as path_stop, whether or not anything moved.
  std::array<std::uint8_t, config::kGuardRules> guard_counts{};
  BoardIdentity board{};    ///< that it was last connected to
  double round_trip = 0.0;  ///< s from a request to its answer, the newest that has come
  PacketCounts packets{};
};

struct Capabilities {
  std::uint32_t fifo_capacity = 0;    ///< segments
  double max_step_frequency = 0.0;    ///< Hz
  double min_segment_duration = 0.0;  ///< s
};

enum class LatchEdge : std::uint8_t { activate, release };

class Controller {
 public:
  virtual ~Controller() = default;

  /// Allowed to take its time and to allocate: not part of the real-time loop. From then on the
  /// board takes segments; status comes with the first exchange.
  virtual Result<Capabilities> connect() = 0;
  virtual void disconnect() = 0;

  /// One exchange with the board: sends what was asked for since the last, brings the status, which
  /// may be from before that: frames_done tells. `now` is the caller's monotonic clock in seconds;
  /// it never goes back. Without a link it tries to make one.
  virtual const ControllerStatus& exchange(double now) = 0;
  /// Number of the frame in which what is asked for now will go out; from 1.
  [[nodiscard]] virtual std::uint64_t next_frame() const = 0;

  /// Segments that the FIFO still takes.
  [[nodiscard]] virtual std::size_t free_segments() const = 0;
  /// Appends; returns how many were taken (fewer when the FIFO is full; none while a fault is
  /// pending or a stop along the path waits for its release).
  virtual std::size_t push(std::span<const Segment> segments) = 0;

  /// Replaces the end of the path: drops every segment behind `id`. What is pushed from now on goes
  /// on from the end of `id` and has to be there before the board comes to it, best in the same
  /// exchange. If the board is past `id` already with segments behind it, or stopping along the
  /// path with segments behind `id`, or stopped along it, the cut is late: status.cut_late says so,
  /// the board goes on with the segments that it has, and drops those pushed since the cut, until
  /// the next one. One cut in an exchange.
  virtual void cut_behind(std::uint32_t id) = 0;

  /// While a fault is pending the board keeps its outputs in the safe state, and it does not bring
  /// back what was on before: call again after clear_faults().
  virtual void set_outputs(const Outputs& outputs) = 0;
  /// Some of them, at once. Under the same conditions. With others of the same exchange where
  /// nothing is lost by that but values of PWM that would be there for a moment; false: it cannot
  /// join them, try again behind the next exchange.
  virtual bool change_outputs(const OutputChange& change) = 0;
  /// Stops step pulses at once and empties the FIFO. Steps may be lost by a real motor.
  virtual void quick_stop() = 0;
  /// Slows down along the path to a standstill, no axis beyond its configured acceleration, then
  /// empties the FIFO: path_stop goes from none to stopping to stopped (at a standstill at once),
  /// and status.position is then exact. No fault. Segments are taken while stopping, because the
  /// path may need them, and dropped by the board once it has stopped: what was pushed for the path
  /// before is void. If the FIFO runs dry before the standstill that is an underrun.
  virtual void stop_along_path() = 0;
  /// Segments are taken again, from where the machine stands. Only when stopped; else nothing.
  /// quick_stop() and clear_faults() release too.
  virtual void release_stop() = 0;
  /// Clears all faults; an estop that is still pressed is one again. The FIFO is empty afterwards.
  virtual void clear_faults() = 0;
  /// Gives the present step count of an axis a new machine position, exactly. False, and nothing
  /// changed, while moving.
  virtual bool set_position(Axis axis, double position) = 0;

  virtual void arm_home_latch(Axis axis, LatchEdge edge) = 0;
  virtual void disarm_home_latch(Axis axis) = 0;

  /// When the probe input becomes active the board latches and stops along the path by itself. If
  /// the input is active already, probe_latch.active_at_arming says so and the same stop follows,
  /// so that segments already under way are not executed. Either way release_stop() goes on. One
  /// catch per arming; a latch that stays armed would stop a later move.
  virtual void arm_probe_latch() = 0;
  virtual void disarm_probe_latch() = 0;
};

}  // namespace cnc::hal
