// A histogram that a real-time thread can fill and any thread can read.
//
// Recording is a few relaxed operations, so the reader may see a value half counted, between two
// bins or between bin and sum, which no statistic minds. One thread records and resets.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>

namespace cnc::server {

/// `Edges` has kCount upper edges, rising; a last bin takes what is not below the last of them.
template <typename Edges>
class Histogram {
 public:
  static constexpr std::size_t kBins = Edges::kCount + 1;

  /// Upper edge of a bin; infinity for the last.
  [[nodiscard]] static double upper_edge(std::size_t bin) {
    return bin < Edges::kCount ? Edges::upper(bin) : std::numeric_limits<double>::infinity();
  }

  void record(double value) {
    std::size_t bin = 0;
    while (bin + 1 < kBins && value >= upper_edge(bin)) ++bin;
    counts_[bin].fetch_add(1, std::memory_order_relaxed);
    sum_.store(sum_.load(std::memory_order_relaxed) + value, std::memory_order_relaxed);
    if (value > max_.load(std::memory_order_relaxed)) max_.store(value, std::memory_order_relaxed);
  }

  void reset() {
    for (auto& count : counts_) count.store(0, std::memory_order_relaxed);
    sum_.store(0.0, std::memory_order_relaxed);
    max_.store(0.0, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count(std::size_t bin) const {
    return counts_[bin].load(std::memory_order_relaxed);
  }
  /// The highest value; 0 if there was none.
  [[nodiscard]] double max() const { return max_.load(std::memory_order_relaxed); }
  /// 0 if there was none.
  [[nodiscard]] double mean() const {
    std::uint64_t all = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) all += count(bin);
    return all == 0 ? 0.0 : sum_.load(std::memory_order_relaxed) / static_cast<double>(all);
  }

 private:
  std::array<std::atomic<std::uint64_t>, kBins> counts_{};
  std::atomic<double> sum_{0.0};
  std::atomic<double> max_{0.0};
};

/// Durations: from 1 µs to 1 s, each edge twice the one before.
struct DoublingEdges {
  static constexpr std::size_t kCount = 21;
  [[nodiscard]] static double upper(std::size_t bin) {
    return 1e-6 * static_cast<double>(1U << bin);
  }
};
using TimeHistogram = Histogram<DoublingEdges>;

/// Seconds of motion in the FIFO: fine near 0, where an underrun is near, and around the usual
/// FifoTime of 0.25 s.
struct FifoEdges {
  static constexpr std::array kMilliseconds{1,   2,   5,   10,  20,  30,  50,  75,  100,  125, 150,
                                            175, 200, 225, 250, 275, 300, 400, 500, 1000, 2000};
  static constexpr std::size_t kCount = kMilliseconds.size();
  [[nodiscard]] static double upper(std::size_t bin) { return 1e-3 * kMilliseconds[bin]; }
};
using FifoHistogram = Histogram<FifoEdges>;

}  // namespace cnc::server
