// The fast half of the core: plays planned slices. Each step leaves at its tick and is counted; an
// armed latch looks at the inputs at each step, an estop is seen at the beginning of each slice.
// The spindle's index is timed by the board's capture unit: where the axes were at that tick is
// found when it is seen.
// The outputs are here too: a slice may change some of them as it begins.
//
// Who may interrupt whom, on a processor with one core: run_until() belongs to the step timer's
// interrupt and may come in the middle of any other call; every other call belongs to the planning
// side (core.h), of which one call never interrupts another. Between the two sides stand the ring
// of slices, each index written by one side only, and flags of one byte. The outputs are switched
// by both: a slice that begins while the planning side is at them leaves its change to that side.
#pragma once

#include <atomic>

#include "hal/cpu5/firmware/board_io.h"
#include "hal/cpu5/firmware/slice.h"
#include "hal/cpu5/firmware/step_history.h"

namespace cnc::hal::cpu5::firmware {

/// What playing has led to.
struct Played {
  Ticks time = 0;
  PathPlace place{};
  PerAxis<std::int64_t> counts{};
  Inputs inputs{};
  PerAxis<HomeLatch> home_latch{};
  ProbeLatch probe_latch{};
  EstopLatch estop_latch{};
  PerAxis<std::int64_t> index_counts{};  ///< at the last index pulse
};

class SlicePlayer {
 public:
  explicit SlicePlayer(BoardIo& io);

  // --- the step interrupt ---

  /// Plays all that is due up to `now`, which never goes back. True: there is something to plan.
  bool run_until(Ticks now);
  /// When run_until() has something to do next.
  [[nodiscard]] Ticks next_due() const;

  /// Stops the pulses, and tells take_alarms().
  void raise(FaultBits alarm);

  /// End of the slice that is being played, or is next; without one, no time comes before it.
  [[nodiscard]] Ticks slice_end() const;

  // --- the planning side ---

  /// Slices are there until that moment; without one, the present.
  [[nodiscard]] Ticks planned_until() const;
  /// More than two slices' time is planned from the beginning of the present one on, or no slice is
  /// free. A slice more makes three at most.
  [[nodiscard]] bool full() const;
  /// Nothing left to be played.
  [[nodiscard]] bool idle() const { return read_ == written_; }
  /// To be filled in; not when full(). commit() hands it over.
  Slice& next_slice() { return ring_[written_ % kSlices]; }
  void commit();
  /// From now on no step leaves; what was planned is dropped.
  void drop();

  /// Faults seen since the last call. They have stopped the pulses already.
  FaultBits take_alarms() { return alarms_.exchange(0); }
  /// Bits of the axes whose drives have begun to raise their alarm since forget_alarms(): the fault
  /// may switch the drives off, and their alarms with them.
  [[nodiscard]] std::uint8_t alarmed_axes() const { return alarmed_axes_; }
  void forget_alarms() {
    alarms_ = 0;
    alarmed_axes_ = 0;
  }
  void arm_latch(std::size_t axis, Edge edge);
  void disarm_latch(std::size_t axis) { played_.home_latch[axis].armed = false; }
  /// Not, if the probe is active already.
  void arm_probe();
  void disarm_probe() { played_.probe_latch.armed = false; }

  /// At once. What slices change while it is being done comes behind it.
  void set_outputs(const Outputs& outputs);
  void change_outputs(const OutputChange& change);
  [[nodiscard]] Outputs outputs() const;

  /// The inputs as they are at this moment.
  [[nodiscard]] Inputs inputs_now() const { return io_.inputs(time()); }

  /// As of the last run_until(), all of the same moment.
  [[nodiscard]] Played played() const;
  [[nodiscard]] Ticks time() const;

 private:
  static constexpr std::uint32_t kSlices = 8;

  template <typename Read>
  [[nodiscard]] auto undisturbed(Read read) const;

  [[nodiscard]] const Slice& front() const { return ring_[read_ % kSlices]; }
  template <typename Change>
  void switch_outputs(Change change);
  void switch_begun();
  void enter_slice();
  void make_steps(Ticks now);
  void leave_slice();
  [[nodiscard]] bool may_play() const { return !idle() && !halted_; }
  [[nodiscard]] PathPlace place_now() const;
  void sample_inputs(Ticks now);
  void watch_latch(std::size_t axis, Ticks now);
  void watch_probe(Ticks now);
  void watch_estop(Ticks now);
  void watch_alarms();

  BoardIo& io_;
  std::array<Slice, kSlices> ring_;
  std::atomic<std::uint32_t> written_ = 0;
  std::atomic<std::uint32_t> read_ = 0;
  std::atomic<std::uint32_t> runs_ = 0;
  std::atomic<bool> halted_ = false;
  std::atomic<FaultBits> alarms_ = 0;
  std::atomic<std::uint8_t> alarmed_axes_ = 0;

  Outputs outputs_;
  std::atomic<bool> outputs_held_ = false;   // by the planning side
  std::atomic<std::uint32_t> begun_ = 0;     // slices of the ring that have begun,
  std::atomic<std::uint32_t> switched_ = 0;  // and those of them whose change has been made

  bool entered_ = false;  // the front slice is being played
  std::uint32_t next_step_ = 0;
  Played played_;  // its place: at the beginning of the front slice, or where the last one ended
  StepHistory history_;
  PerAxis<bool> home_before_{};
  bool estop_before_ = false;
  std::uint8_t alarm_before_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
