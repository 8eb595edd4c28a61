// How the link to the board has been since the last reset: kept always, because the moment at which
// somebody wants to know is the one that is over.
//
// The link thread writes, any thread reads and asks for a reset; nobody waits. The link thread
// makes the reset itself, in its next cycle: two writers would lose each other's counts. Packets
// are counted by the controller from its beginning; what they were at the last reset is taken off.
#pragma once

#include <algorithm>
#include <atomic>

#include "hal/controller.h"
#include "server/link/histogram.h"

namespace cnc::server {

struct LinkStatistics {
  static constexpr double kNeverMoved = 1e9;

  std::atomic<std::uint64_t> cycles{0};
  TimeHistogram lateness;    ///< start of a cycle after its due time
  TimeHistogram work;        ///< duration of a cycle
  TimeHistogram round_trip;  ///< of the newest answer in each exchange that brought one
  FifoHistogram fifo_time;   ///< in each exchange while moving with more to come
  std::atomic<double> lowest_fifo_time{kNeverMoved};
  std::atomic<double> last_round_trip{0.0};

  /// Any thread.
  void ask_for_reset() { reset_wanted_.store(true, std::memory_order_relaxed); }
  /// Since the last reset.
  [[nodiscard]] hal::PacketCounts packets() const { return packets_.get(); }

  /// Link thread: what an exchange has brought. Makes the reset that somebody has asked for.
  void note(const hal::ControllerStatus& board) {
    if (reset_wanted_.load(std::memory_order_relaxed) &&
        reset_wanted_.exchange(false, std::memory_order_relaxed))
      reset();
    if (board.packets.answered != last_.answered) {
      round_trip.record(board.round_trip);
      last_round_trip.store(board.round_trip, std::memory_order_relaxed);
    }
    last_ = board.packets;
    packets_.set({.sent = last_.sent - at_reset_.sent,
                  .resent = last_.resent - at_reset_.resent,
                  .answered = last_.answered - at_reset_.answered,
                  .passed_over = last_.passed_over - at_reset_.passed_over,
                  .corrupted = last_.corrupted - at_reset_.corrupted});
    if (!board.moving || board.fifo_count == 0) return;
    fifo_time.record(board.fifo_time);
    if (board.fifo_time < lowest_fifo_time.load(std::memory_order_relaxed))
      lowest_fifo_time.store(board.fifo_time, std::memory_order_relaxed);
  }

 private:
  void reset() {
    cycles.store(0, std::memory_order_relaxed);
    lateness.reset();
    work.reset();
    round_trip.reset();
    fifo_time.reset();
    lowest_fifo_time.store(kNeverMoved, std::memory_order_relaxed);
    at_reset_ = last_;
  }

  struct AtomicPacketCounts {
    std::atomic<std::uint64_t> sent{0};
    std::atomic<std::uint64_t> resent{0};
    std::atomic<std::uint64_t> answered{0};
    std::atomic<std::uint64_t> passed_over{0};
    std::atomic<std::uint64_t> corrupted{0};

    void set(const hal::PacketCounts& counts) {
      sent.store(counts.sent, std::memory_order_relaxed);
      resent.store(counts.resent, std::memory_order_relaxed);
      answered.store(counts.answered, std::memory_order_relaxed);
      passed_over.store(counts.passed_over, std::memory_order_relaxed);
      corrupted.store(counts.corrupted, std::memory_order_relaxed);
    }
    [[nodiscard]] hal::PacketCounts get() const {
      return {.sent = sent.load(std::memory_order_relaxed),
              .resent = resent.load(std::memory_order_relaxed),
              .answered = answered.load(std::memory_order_relaxed),
              .passed_over = passed_over.load(std::memory_order_relaxed),
              .corrupted = corrupted.load(std::memory_order_relaxed)};
    }
  };

  std::atomic<bool> reset_wanted_{false};
  AtomicPacketCounts packets_;  // since the last reset
  hal::PacketCounts last_;      // link thread's: as the controller counts them
  hal::PacketCounts at_reset_;  // link thread's
};

}  // namespace cnc::server
