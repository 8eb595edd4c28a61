// How the link to the board has been since the last reset(): kept always, because the moment at
// which somebody wants to know is the one that is over.
//
// The link thread writes, any thread reads and resets; nobody waits. Packets are counted by the
// controller from its beginning; what they were at the last reset is taken off.
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

  /// Link thread: what an exchange has brought.
  void note(const hal::ControllerStatus& board) {
    if (board.packets.answered != packets_.answered.load(std::memory_order_relaxed)) {
      round_trip.record(board.round_trip);
      last_round_trip.store(board.round_trip, std::memory_order_relaxed);
    }
    packets_.set(board.packets);
    if (!board.moving || board.fifo_count == 0) return;
    fifo_time.record(board.fifo_time);
    if (board.fifo_time < lowest_fifo_time.load(std::memory_order_relaxed))
      lowest_fifo_time.store(board.fifo_time, std::memory_order_relaxed);
  }

  /// Since the last reset.
  [[nodiscard]] hal::PacketCounts packets() const {
    const hal::PacketCounts now = packets_.get();
    const hal::PacketCounts before = packets_at_reset_.get();
    return {.sent = now.sent - before.sent,
            .resent = now.resent - before.resent,
            .answered = now.answered - before.answered,
            .passed_over = now.passed_over - before.passed_over,
            .corrupted = now.corrupted - before.corrupted};
  }

  void reset() {
    cycles.store(0, std::memory_order_relaxed);
    lateness.reset();
    work.reset();
    round_trip.reset();
    fifo_time.reset();
    lowest_fifo_time.store(kNeverMoved, std::memory_order_relaxed);
    packets_at_reset_.set(packets_.get());
  }

 private:
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

  AtomicPacketCounts packets_;
  AtomicPacketCounts packets_at_reset_;
};

}  // namespace cnc::server
