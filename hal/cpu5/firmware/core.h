// The board's motion core: a FIFO of segments in, step pulses out; it latches, watches and stops by
// itself. Portable to any processor with 64-bit integers: no heap, no operating system, no
// exceptions, no floating point. The virtual machine runs this very code.
//
// Its two halves share the work. Planning (plan(), this class) turns segments into slices of at
// most 100 us: the steps in them, each with its tick. Playing (run_until(), slice_player.h) lets
// them out when their time comes. Planning is ahead by the slice that is being played and the next
// two, so what the host asks for, a probe that touches or a spindle that slows down shows in the
// motion within 0.3 ms. An estop does not wait: the slice in which it is seen makes no further
// step.
//
// On a board the step timer's interrupt calls run_until(now) at the moment that next_due() told,
// and an interrupt of lower priority calls plan() when run_until() said so. The host's calls belong
// to the main program: a plan() that comes into the middle of one is put off to its end. Planning
// that comes too late is the same fault as a host that does: kFifoUnderrun. Elsewhere advance()
// plays and plans in turn. The steps and their ticks do not depend on how time is cut into calls.
//
// Rules for segments: id one above the last accepted (any but 0 after start, any stop, a cut or
// cleared faults; 0 is skipped when the number wraps), duration 1 … kMaxSegmentTicks, position
// within kMaxPosition, and the speed nowhere above Setup::max_velocity. A segment that breaks one
// is never executed: it is the fault kBadSegment.
//
// A stop along the path slows path time down until the machine stands (path_stop.h), then empties
// the FIFO: no fault, and the step counts are where every motor is. What the host had under way for
// the path before would now be wrong, so the board drops segments without a word until
// release_stop(). The host asks for such a stop, or the probe latch begins one when it catches.
//
// A cut replaces the end of the path: what waits behind a segment that is not finished yet is
// dropped, and what is pushed afterwards goes on from that segment's end. A cut behind a segment
// that is finished, and not the very last one, is late: the path goes on as it was, and what the
// host sends for its new path is dropped until the next cut, which the host will send when it has
// read that. While the board stops along the path every cut is late but one behind the very last
// segment, which drops nothing: with that a host whose cut was late goes on to feed the path that
// the board brakes along. Stopped: every cut is late, until the stop is released.
//
// A segment may wait for the spindle's index pulse and then counts its time from the very moment of
// the pulse, although the core sees it up to a slice later: threads cut in several passes meet.
// (What the axes, from a standstill, should have gone meanwhile they go at once: at 10^6 steps/s^2
// 0.02 step.)
//
// A segment that follows the spindle passes at the part that the measured speed is of the planned
// one, smoothed by kFollowSmoothing and changed no faster than the axes' acceleration allows, up to
// kTopScale. Its own speed, and that of what comes after it up to the next standstill, leaves that
// room below Setup::max_velocity.
//
// A host that has not been heard for Setup::host_timeout is lost: the board stops along the path,
// and then it is the fault kLinkLost, also when the host is heard again meanwhile. The FIFO has to
// hold what braking takes, or it runs dry before.
//
// A segment may change outputs: at the tick at which it begins, as it is played. One that is
// dropped by a cut, a stop or a fault has not begun and switches nothing.
//
// Rules on the inputs of I/O cards (card_guards.h) are looked at in every slice: a smooth stop is
// one along the path, whether or not anything moves, a quick stop a fault.
//
// Every fault stops the pulses at once, empties the FIFO, makes the outputs safe, and holds until
// clear_faults(): meanwhile segments and outputs are refused. Where the pulses stopped is where the
// next segment starts.
#pragma once

#include "hal/cpu5/firmware/board_io.h"
#include "hal/cpu5/firmware/hermite.h"
#include "hal/cpu5/firmware/path_stop.h"
#include "hal/cpu5/firmware/segment_fifo.h"
#include "hal/cpu5/firmware/slice_player.h"
#include "hal/cpu5/firmware/spindle_meter.h"

namespace cnc::hal::cpu5::firmware {

class SliceSteps;

/// A quarter of a second even of the shortest segments, 0.25 ms, which tight corners are made of.
inline constexpr std::uint32_t kFifoCapacity = 1024;
/// In each slice the scale goes this part of its way to the measured ratio: 6.4 ms time constant.
inline constexpr TimeScale kFollowSmoothing = 64;

class Core {
 public:
  explicit Core(BoardIo& io);

  /// Until this has been called every segment is too fast. False, and nothing changed, while moving
  /// or for values out of range.
  bool set_up(const Setup& setup);

  /// The host was heard; it counts from the first call on.
  void host_alive();
  /// It has said that it goes: outputs become safe, a motion is stopped as for a silent host.
  void host_left();
  [[nodiscard]] Ticks time() const { return player_.time(); }
  [[nodiscard]] bool moving() const;

  /// False when the segment was not taken: FIFO full, fault pending, stopped along the path, or bad
  /// (which is a fault then).
  bool push(const Segment& segment);
  /// Drops what waits behind segment `id`, or is late (above).
  void cut_behind(std::uint32_t id);
  void quick_stop();
  /// At a standstill: stopped at once.
  void stop_along_path();
  /// Segments are taken again. Without effect while still stopping.
  void release_stop();
  /// Stops as quick_stop() does, and forgets all faults; an estop that is still pressed is one
  /// again.
  void clear_faults();
  /// Refused while a fault is pending.
  bool set_outputs(const Outputs& outputs);
  bool change_outputs(const OutputChange& change);
  void arm_latch(std::size_t axis, Edge edge);
  void disarm_latch(std::size_t axis);
  /// A probe that is active already is not waited for: the machine is stopped along its path
  /// instead, so that no probing move starts with a probe that touches or is broken.
  void arm_probe();
  void disarm_probe();

  /// Plans ahead and carries out what playing found: faults, a probe that touched.
  void plan();
  /// True: plan() has something to do.
  bool run_until(Ticks now) { return player_.run_until(now); }
  [[nodiscard]] Ticks next_due() const { return player_.next_due(); }
  /// From the step interrupt: the board itself cannot go on. Stops the pulses at once.
  void report(FaultBits fault) { player_.raise(fault); }

  /// Plays and plans through the next `ticks` >= 0.
  void advance(Ticks ticks);

  [[nodiscard]] Status status();

 private:
  /// Keeps plan() out of one of the host's calls, and makes up for it.
  class HostCall;

  void plan_now();
  [[nodiscard]] bool acceptable(const Segment& segment) const;
  [[nodiscard]] bool may_be_scaled(const Segment& segment) const;
  [[nodiscard]] bool host_silent() const;
  [[nodiscard]] bool under_way() const;  // not counting what waits in the FIFO
  [[nodiscard]] bool cut_fifo_behind(std::uint32_t id);
  void keep_waiting(std::uint32_t count);

  [[nodiscard]] bool has_path();
  void start_next_segment();
  void finish_segment();
  void plan_slice();
  void watch_spindle(Ticks now);
  void wait_for_index();
  [[nodiscard]] bool next_follows() const;
  [[nodiscard]] Ticks slice_length() const;
  [[nodiscard]] PathPlace place() const;
  PathTime path_time_passing(Ticks length);
  [[nodiscard]] TimeScale wanted_scale() const;
  [[nodiscard]] TimeScale scale_from_standstill() const;
  [[nodiscard]] TimeScale spindle_ratio() const;
  using Allowance = TimeScale (*)(const PathDerivatives&, StepAcceleration, TimeScale, Ticks);
  [[nodiscard]] TimeScale least_allowed(Allowance allowance, TimeScale change, Ticks length) const;
  PathTime plan_steps(Slice& slice, PathTime way);
  void shorten(Slice& slice, PathTime made, PathTime way, TimeScale scale_before);
  void plan_piece(Slice& slice, PathTime made, PathTime piece);
  void add_axes(SliceSteps& steps, PathTime piece);

  void watch_guards(PortBits ports);
  void begin_stop();
  void complete_stop();
  void stop_pulses();
  void fail(FaultBits fault);
  [[nodiscard]] Outputs safe_outputs() const;

  BoardIo& io_;
  SlicePlayer player_;
  Setup setup_;
  FaultBits faults_ = 0;
  std::atomic<bool> host_inside_ = false;  // one of its calls is under way
  std::atomic<bool> plan_put_off_ = false;
  bool host_known_ = false;
  Ticks host_heard_ = 0;
  bool host_is_lost_ = false;  // it was silent for too long: a fault as soon as the machine stands
  static constexpr Ticks kHostGone = -1;  // of host_heard_: it has said so

  SegmentFifo<kFifoCapacity> fifo_;
  Ticks fifo_ticks_ = 0;
  PerAxis<StepPosition> tail_position_{};  // where the last accepted segment ends
  PerAxis<StepVelocity> tail_velocity_{};
  std::uint32_t tail_id_ = 0;
  bool tail_scaled_ = false;
  bool any_id_ = true;
  bool cut_late_ = false;

  // What is planned, up to player_.planned_until().
  bool executing_ = false;
  bool change_is_due_ = false;  // segment_'s, with its first slice
  std::uint8_t moving_axes_ = 0;
  Segment segment_;  // in execution, or the last executed
  PathTime elapsed_ = 0;
  TimeScale time_scale_ = kFullScale;
  PathStop path_stop_ = PathStop::none;
  bool stop_again_ = false;       // a guard asked for it during a stop
  bool stop_is_planned_ = false;  // to its end
  bool probe_awaited_ = false;
  bool waiting_for_index_ = false;
  std::uint32_t index_count_before_ = 0;  // the wait
  Ticks wait_begin_ = 0;
  PathTime owed_ = 0;      // path time that passed between the index pulse and the first slice
  PerAxis<Cubic> cubics_;  // of moving_axes_
  PerAxis<StepPosition> start_position_{};  // of the segment in execution
  PerAxis<StepVelocity> start_velocity_{};
  PerAxis<StepPosition> position_{};
  SpindleMeter spindle_;
  CardGuards guards_;
};

}  // namespace cnc::hal::cpu5::firmware
